#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "models/exchange/messages.hpp"

namespace vantage::test {

/// Base class of benches that connect a driver and its vehicle, with virtual time, commands and
/// plans.
class SteppedBench {
 public:
  static constexpr Time kStart = from_utime(1'700'000'000'000'000);

  void run(double seconds) {
    const Time end = now + from_seconds(seconds);
    while (now < end) {
      step();
    }
  }
  /// Runs until `done` is true or `seconds` have passed; returns whether it became true.
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

  /// Returns the operator's next command.
  models::OperatorCommand next_command(models::OperatorAction action) {
    models::OperatorCommand out;
    out.stamp = {now, 77, command_sequence_++};
    out.action = action;
    return out;
  }
  /// Returns the planner's next plan, which begins at `start`.
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
