#include "test/drivers/safety/fault_catalogue.hpp"

#include <algorithm>

#include "test/drivers/safety/fault_parts.hpp"

namespace vantage::test {

using models::FlightState;

namespace {

// Faults with Fault::needs_quiet.
constexpr const char* kNeedQuiet[] = {"head-on at 2 m/s",
                                      "planner that keeps flying at a teammate",
                                      "pushed aside by a hand",
                                      "driven at the fence",
                                      "driven through the fence",
                                      "estimate 0.5 m off",
                                      "estimate 1.5 m off",
                                      "stuck while moving",
                                      "stuck while hovering",
                                      "a still body bears its name",
                                      "the autopilot feels another motion"};

}  // namespace

const std::vector<Fault>& fault_catalogue() {
  static const std::vector<Fault> kAll = [] {
    std::vector<Fault> all;
    std::vector<Fault> of_plans = faults::of_plans();
    for (Fault& fault : of_plans) {
      fault.strikes_by_plans = true;
    }
    for (const auto& part :
         {faults::of_mocap(), of_plans, faults::of_vehicles(), faults::of_operators()}) {
      all.insert(all.end(), part.begin(), part.end());
    }
    for (Fault& fault : all) {
      for (const char* name : kNeedQuiet) {
        fault.needs_quiet = fault.needs_quiet || std::string(fault.name) == name;
      }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Fault& a, const Fault& b) { return a.number < b.number; });
    return all;
  }();
  return kAll;
}

int severity_of(FlightState state) {
  switch (state) {
    case FlightState::kFollow:
      return 0;
    case FlightState::kHold:
      return 1;
    case FlightState::kLand:
    case FlightState::kIdle:
      return 2;
    case FlightState::kKilled:
      return 3;
  }
  return 0;
}

}  // namespace vantage::test
