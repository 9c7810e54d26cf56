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

/// What a plan must fit to.
struct PlanSituation {
  bool may_take = false;  ///< the vehicle follows plans now
  const Course& course;   ///< where it is asked to be
  double height_m = 0.0;  ///< and how high
  std::span<const OtherCourse> others;
};

/// Judges the plans of one vehicle, one after the other: whose they are, whether they are news,
/// whether they can be driven, begin where the vehicle will be, and lead where nothing is.
class PlanGate {
 public:
  explicit PlanGate(std::string robot) : robot_(std::move(robot)) {}

  /// kAccepted, and the plan in `out`; else the first reason that applies. Allocates nothing.
  PlanVerdict judge(const models::RobotPlan& plan, const PlanSituation& situation,
                    const SafetyLimits& limits, Time now, HeldPlan& out);
  /// Fills what `inputs` says of the newest plan and its planners.
  void report(Time now, const SafetyLimits& limits, SafetyInputs& inputs) const;

  /// Of the newest plan accepted; −1 before any.
  [[nodiscard]] std::int64_t round() const { return round_; }
  [[nodiscard]] const PlannerLease& lease() const { return lease_; }
  /// Appends how many plans met each refusal.
  void count(std::vector<models::NamedCount>& out) const;

 private:
  PlanVerdict look_at(const models::RobotPlan& plan, const PlanSituation& situation,
                      const SafetyLimits& limits, Time now, HeldPlan& out);

  std::string robot_;
  PlannerLease lease_;
  bool has_accepted_ = false;
  Time newest_start_{};
  Time accepted_at_{};
  std::int64_t run_ = 0;
  std::int64_t sequence_ = -1;
  std::int64_t round_ = -1;
  int late_ = 0;     ///< in a row
  int refused_ = 0;  ///< in a row
  std::array<std::int64_t, kPlanVerdicts> counts_{};
};

}  // namespace vantage::drivers
