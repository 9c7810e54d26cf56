#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/safety/authority.hpp"
#include "drivers/safety/course.hpp"
#include "drivers/safety/inputs.hpp"
#include "drivers/safety/limits.hpp"
#include "drivers/safety/plan_check.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// State of the vehicle that a plan must match.
struct PlanSituation {
  bool may_take = false;  ///< the vehicle accepts plans now
  const Course& course;   ///< commanded positions
  double height_m = 0.0;  ///< m; commanded height
  std::span<const OtherCourse> others;
};

/// Checks of the plans of one vehicle, in this order: vehicle, age, feasibility, lease, continuity
/// with the course, and clear path.
class PlanGate {
 public:
  explicit PlanGate(std::string robot) : robot_(std::move(robot)) {}

  /// Checks `plan`. Returns kAccepted and copies the plan to `out`, or returns the first reason for
  /// refusal. Allocates no memory.
  PlanVerdict judge(const models::RobotPlan& plan, const PlanSituation& situation,
                    const SafetyLimits& limits, Time now, HeldPlan& out);
  /// Fills the fields of `inputs` that describe the newest plan and its planners.
  void report(Time now, const SafetyLimits& limits, SafetyInputs& inputs) const;

  /// Returns the round of the last accepted plan; −1 before the first.
  [[nodiscard]] std::int64_t round() const { return round_; }
  [[nodiscard]] const PlannerLease& lease() const { return lease_; }
  /// Appends the number of refused plans per reason.
  void count(std::vector<models::NamedCount>& out) const;

 private:
  PlanVerdict check(const models::RobotPlan& plan, const PlanSituation& situation,
                    const SafetyLimits& limits, Time now, HeldPlan& out);

  std::string robot_;
  PlannerLease lease_;
  bool has_accepted_ = false;
  Time newest_start_{};
  Time accepted_at_{};
  std::int64_t run_ = 0;
  std::int64_t sequence_ = -1;
  std::int64_t round_ = -1;
  int late_ = 0;     ///< number of consecutive late plans
  int refused_ = 0;  ///< number of consecutive refused plans
  std::array<std::int64_t, kPlanVerdicts> counts_{};
};

}  // namespace vantage::drivers
