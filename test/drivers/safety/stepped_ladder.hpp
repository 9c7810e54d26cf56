#pragma once

#include <optional>

#include "drivers/safety/ladder.hpp"
#include "drivers/safety/limits.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {

inline drivers::SafetyLimits limits() { return drivers::limits_for(FlightBench::scenario(), "Q1"); }

/// Safety ladder stepped tick by tick; its inputs keep their values until the test changes them.
class SteppedLadder {
 public:
  SteppedLadder() { in.autopilot_armed = true; }
  models::FlightState step(double seconds = 0.01,
                           std::optional<models::OperatorAction> request = {}) {
    in.now += from_seconds(seconds);
    in.request = request;
    ladder = drivers::step_ladder(ladder, in, lim);
    return ladder.state;
  }
  models::FlightState wait(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 100.0); ++i) {
      step();
    }
    return ladder.state;
  }
  SteppedLadder& airborne(bool follows = true) {
    in.autopilot_armed = false;
    step(0.01, models::OperatorAction::kArm);
    in.autopilot_armed = true;
    step(0.01, models::OperatorAction::kTakeOff);
    in.height_m = 1.0;
    in.flight_s = 5.0;
    if (follows) {
      step(0.01, models::OperatorAction::kFollow);
    }
    return *this;
  }

  drivers::SafetyLimits lim = limits();
  drivers::SafetyInputs in;
  drivers::LadderState ladder;
};

}  // namespace vantage::test
