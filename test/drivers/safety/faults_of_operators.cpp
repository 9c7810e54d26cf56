#include <algorithm>

#include "test/drivers/safety/fault_parts.hpp"

namespace vantage::test::faults {

std::vector<Fault> of_operators() {
  return {
      {17,
       "operator silent for 0.8 s",
       "no heartbeat",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) { bench.room().operator_silent |= since_s < 0.8; },
       {},
       nullptr,
       nullptr,
       kFollow},
      {17,
       "operator silent for 2 s",
       "no heartbeat",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) { bench.room().operator_silent |= since_s < 2.0; },
       {{kHold, 1.0 + kTicks}},
       "operator quiet",
       nullptr,
       kHold},
      {17,
       "operator station lost",
       "no heartbeat",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().operator_silent = true; },
       {{kHold, 1.0 + kTicks}, {kLand, 3.0 + kTicks}},
       "operator lost",
       nullptr,
       kIdle},
      {17,
       "first station lost, a second beats on",
       "it says follow, too",
       "all",
       0.0,
       [](FlightBench& bench, double) {
         bench.room().operator_silent = true;
         bench.room().second_station = true;
       },
       {{kHold, 1.0 + kTicks}},
       "operator quiet",
       nullptr,
       kFollow},
      {36,
       "emergency stop",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().says = OperatorAction::kEmergencyStop;
         }
       },
       {{kKilled, kTicks}},
       "emergency stop",
       nullptr,
       kKilled},
      {36,
       "emergency stop twice",
       "0.1 s apart",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0) || is_at(since_s, 0.1)) {
           bench.room().says = OperatorAction::kEmergencyStop;
         }
       },
       {{kKilled, kTicks}},
       "emergency stop",
       nullptr,
       kKilled},
      {36,
       "emergency stop while landing",
       "1 s after `land`",
       "all",
       1.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().says = OperatorAction::kLand;
         } else if (is_at(since_s, 1.0)) {
           bench.room().says = OperatorAction::kEmergencyStop;
         }
       },
       {{kKilled, kTicks}},
       "emergency stop",
       nullptr,
       kKilled},
      {36,
       "emergency stop from a second station",
       "not in charge",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().other_says = OperatorAction::kEmergencyStop;
         }
       },
       {{kKilled, kTicks}},
       "emergency stop",
       nullptr,
       kKilled},
      {36,
       "second station beats beside the first",
       "and says follow and arm",
       "all",
       0.0,
       [](FlightBench& bench, double) {
         bench.room().second_station = bench.room().second_arms = true;
       },
       {},
       nullptr,
       "command.refused",
       kFollow},
      {36,
       "operator says land",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().says = OperatorAction::kLand;
         }
       },
       {{kLand, kTicks}},
       nullptr,
       nullptr,
       kIdle},
  };
}

}  // namespace vantage::test::faults
