#pragma once

#include <cstdint>

#include "planner/app/plan_mode.hpp"

namespace vantage::planner {

/// Mode for planner.algorithm `external`: when the slot begins, requests the plan of an external
/// process in EXTERNAL_REQUEST_R, and waits for EXTERNAL_PLAN_R until shortly before the slot ends.
class ExternalMode : public PlanMode {
 public:
  explicit ExternalMode(NodeState& state);
  [[nodiscard]] Time next_tick() const override;
  SlotStage advance(Time now) override;

 private:
  /// Requests the slot's plan; false if no request can be made.
  bool request(Time now);
  void take(const models::RobotPlan& answer);

  bool is_pending_ = false;
  Time answer_due_{};  ///< deadline for the answer; the robot then plans without one
  std::int64_t requested_round_ = -1;
};

}  // namespace vantage::planner
