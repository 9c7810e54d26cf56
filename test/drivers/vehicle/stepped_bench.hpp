#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "models/exchange/messages.hpp"

namespace vantage::test {

/// Base of benches with a driver and its vehicle: virtual time, commands and plans.
class SteppedBench {
 public:
  static constexpr Time kStart = from_utime(1'700'000'000'000'000);

  void run(double seconds) {
    const Time end = now + from_seconds(seconds);
    while (now < end) {
      step();
    }
  }
  /// Runs until `done` is true, at most `seconds`; returns whether it is.
  bool run_until(const std::function<bool()>& done, double seconds) {
    const Time end = now + from_seconds(seconds);
    while (now < end && !done()) {
      step();
    }
    return done();
  }
  virtual void step() = 0;
  virtual ~SteppedBench() = default;

  Time now = kStart;

 protected:
  SteppedBench() = default;
  SteppedBench(const SteppedBench&) = default;
  SteppedBench& operator=(const SteppedBench&) = default;
  SteppedBench(SteppedBench&&) = default;
  SteppedBench& operator=(SteppedBench&&) = default;

  /// Returns the next command of the operator.
  models::OperatorCommand next_command(models::OperatorAction action) {
    models::OperatorCommand out;
    out.stamp = {now, 77, command_sequence_++};
    out.action = action;
    return out;
  }
  /// Returns the next plan of the planner, beginning at `start`.
  models::RobotPlan next_plan(std::string robot, Time start, const Pose2& from, double height_m,
                              std::vector<models::PlanSegment> segments) {
    models::RobotPlan out;
    out.stamp = {start, 55, plan_sequence_++};
    out.robot = std::move(robot);
    out.round = plan_sequence_;
    out.trajectory = {start, from, height_m, std::move(segments)};
    return out;
  }

 private:
  std::int64_t command_sequence_ = 0;
  std::int64_t plan_sequence_ = 0;
};

}  // namespace vantage::test
