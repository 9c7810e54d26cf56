#include "planner/robot/commitment.hpp"

#include <algorithm>
#include <cmath>

#include "planner/robot/trajectory_tools.hpp"

namespace vantage::planner {
namespace {

const models::VehicleStatus* own_status(const scenario::RobotSpec& robot,
                                        const PlanInputs& inputs) {
  const auto own = inputs.team_statuses.find(robot.name);
  return own == inputs.team_statuses.end() ? nullptr : &own->second;
}

// Returns the vehicle's hold set-point if the vehicle holds at a position off its plan. A vehicle
// on hold stays where its driver stopped it and does not return to its plan by itself. The next
// plan must begin at this position, otherwise the driver would always refuse it.
std::optional<Pose2> hover_off_plan(const scenario::PlannerSpec& planner,
                                    const scenario::RobotSpec& robot, const PlanInputs& inputs) {
  constexpr double kTurnMaxRad = 0.4;
  const models::VehicleStatus* own = own_status(robot, inputs);
  if (!inputs.own_plan || own == nullptr || own->state != models::FlightState::kHold) {
    return std::nullopt;
  }
  const models::Trajectory& last = inputs.own_plan->trajectory;
  const Pose2& hover = own->setpoint;
  const Time when = std::max(own->stamp.time, last.start_time);
  const Pose2 planned = models::at(last, when).world_from_body;
  const bool is_off =
      (planned.position_m() - hover.position_m()).norm() > planner.tracking_tolerance_m ||
      std::abs(wrap_to_pi(planned.yaw_rad - hover.yaw_rad)) > kTurnMaxRad;
  return is_off ? std::optional(hover) : std::nullopt;
}

// True if the vehicle reports that it follows a plan whose motion may not have ended when the slot
// begins.
bool flies_unknown_plan(const scenario::PlannerSpec& planner, const scenario::RobotSpec& robot,
                        const PlanInputs& inputs) {
  const models::VehicleStatus* own = own_status(robot, inputs);
  if (own == nullptr || own->state != models::FlightState::kFollow || own->plan_round < 0) {
    return false;
  }
  const std::int64_t rounds = inputs.slot.round - own->plan_round;
  if (rounds < 0) {
    return false;  // the plan is from another schedule
  }
  // Time from the start of the reported plan to the start of this slot, at which the vehicle must
  // be stationary.
  const double since_s = static_cast<double>(rounds * planner.execute_steps) * planner.step_s -
                         to_seconds(inputs.slot.activation - inputs.slot.begin);
  return since_s < planner.horizon_steps * planner.step_s +
                       robot.limits.speed_max_mps / robot.limits.brake_mps2;
}

}  // namespace

Commitment commitment_of(const scenario::Scenario& scenario, std::size_t robot,
                         const PlanInputs& inputs) {
  const scenario::PlannerSpec& planner = scenario.planner;
  const scenario::RobotSpec& spec = scenario.robots[robot];
  const models::MocapBody* body = inputs.mocap ? inputs.mocap->find(spec.name, robot) : nullptr;
  const bool has_pose = body != nullptr && !body->occluded;
  Commitment commitment;
  if (const auto hover = hover_off_plan(planner, spec, inputs)) {
    commitment.is_off_plan = true;
    commitment.motion = hover_at(*hover, spec.height_m, inputs.slot.activation);
    return commitment;
  }
  if (inputs.own_plan) {
    const models::Trajectory& last = inputs.own_plan->trajectory;
    bool on_plan = true;
    if (has_pose && inputs.mocap->stamp.time >= last.start_time) {
      const Pose2 expected = models::at(last, inputs.mocap->stamp.time).world_from_body;
      const double off_m =
          (expected.position_m() - flatten(body->world_from_body).position_m()).norm();
      if (off_m > planner.tracking_tolerance_m) {
        commitment.is_off_plan = true;
        // A vehicle far off its plan did not follow the plan (for example, an operator held it):
        // plan from its position. At smaller errors the vehicle's controller returns it to the
        // plan.
        on_plan = off_m <= 3.0 * planner.tracking_tolerance_m;
      }
    }
    if (on_plan) {
      commitment.motion = remainder_of(last, inputs.slot.activation);
      return commitment;
    }
  }
  if (!has_pose) {
    commitment.known = Commitment::Known::kNoPose;
  } else if (!inputs.own_plan && flies_unknown_plan(planner, spec, inputs)) {
    commitment.known = Commitment::Known::kUnknownPlan;
  } else {
    commitment.motion =
        hover_at(flatten(body->world_from_body), spec.height_m, inputs.slot.activation);
  }
  return commitment;
}

}  // namespace vantage::planner
