#include "planner/robot/plan_ladder.hpp"

#include <limits>
#include <tuple>
#include <utility>

#include "core/infinity.hpp"
#include "planner/robot/closing_check.hpp"
#include "planner/robot/trajectory_tools.hpp"

namespace vantage::planner {
namespace {

// Returns references to the certificate fields of a SearchResult or a RobotPlan.
template <class Found>
auto certificate_of(Found& found) {
  return std::tie(found.cost, found.lower_bound, found.epsilon, found.delta_m, found.passes);
}

}  // namespace

models::RobotPlan blank_plan(const scenario::PlannerSpec& planner, const std::string& robot,
                             const RoundSchedule::Slot& slot) {
  models::RobotPlan plan;
  plan.stamp.time = slot.activation;
  plan.robot = robot;
  plan.round = slot.round;
  plan.horizon_steps = planner.horizon_steps;
  plan.step_s = planner.step_s;
  plan.cost = std::numeric_limits<double>::quiet_NaN();
  plan.lower_bound = -kInfinity;
  plan.epsilon = kInfinity;
  plan.delta_m = kInfinity;
  plan.slot_start = slot.begin;
  plan.deadline = slot.end;
  return plan;
}

models::RobotPlan PlanLadder::plan_of(models::Trajectory motion, models::PlanSource source) const {
  models::RobotPlan plan = plan_;
  plan.source = source;
  plan.trajectory = std::move(motion);
  return plan;
}

models::Trajectory PlanLadder::stop() const {
  return stop_from(committed_, committed_.start_time, problem_.brake_mps2);
}

std::optional<models::RobotPlan> PlanLadder::searched(const SearchResult& result) {
  if (!result.found) {
    return std::nullopt;
  }
  auto plan = chosen(to_trajectory(problem_, result));
  if (plan) {
    certificate_of(*plan) = certificate_of(result);
  }
  return plan;
}

std::optional<models::RobotPlan> PlanLadder::chosen(const models::Trajectory& motion) {
  if (!is_safe(problem_, motion)) {
    ++counts_.checks_failed;
    return std::nullopt;
  }
  return plan_of(motion, models::PlanSource::kSearched);
}

std::optional<models::RobotPlan> PlanLadder::proposed(const models::RobotPlan& proposal) const {
  if (proposal.source != models::PlanSource::kSearched || !is_safe(problem_, proposal.trajectory)) {
    return std::nullopt;
  }
  models::RobotPlan plan = plan_of(proposal.trajectory, proposal.source);
  certificate_of(plan) = certificate_of(proposal);
  return plan;
}

std::optional<models::RobotPlan> PlanLadder::hovering() {
  ++counts_.rest_rounds;
  models::Trajectory motion = stop();
  if (!is_safe(problem_, motion)) {
    return std::nullopt;
  }
  return plan_of(std::move(motion), models::PlanSource::kSearched);
}

models::RobotPlan PlanLadder::turned(models::Trajectory turning) {
  ++counts_.turns_away;
  return plan_of(std::move(turning), models::PlanSource::kBraking);
}

models::RobotPlan PlanLadder::stopped() {
  models::Trajectory motion = stop();
  if (!is_safe(problem_, motion)) {
    return fall_back();
  }
  ++counts_.fallbacks_braking;
  return plan_of(std::move(motion), models::PlanSource::kBraking);
}

models::RobotPlan PlanLadder::fall_back() {
  if (is_safe(problem_, committed_)) {
    ++counts_.fallbacks_shifted;
    return plan_of(committed_, models::PlanSource::kShifted);
  }
  ++counts_.fallbacks_braking;
  return plan_of(stop(), models::PlanSource::kBraking);
}

}  // namespace vantage::planner
