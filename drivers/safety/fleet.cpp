#include "drivers/safety/fleet.hpp"

#include <algorithm>
#include <string_view>

namespace vantage::drivers {
namespace {

constexpr double kPredictOthersS = 0.5;
constexpr double kTeammateSpare = 1.1;  // factor on a teammate's limits in the check of its plan
constexpr double kForgottenS = 10.0;    // s; an unknown body unseen for longer is deleted
constexpr std::size_t kNameMax = 64;    // bytes; maximum length of an unknown body's name
// Number of consecutive rejected poses after which the track of a body restarts at the new
// position.
constexpr int kMovedAfter = 50;

PoseVerdict judge(PoseMonitor& pose, const models::MocapBody* body, const SafetyLimits& limits,
                  Time now) {
  const bool is_lost = pose.rejected_in_row() >= kMovedAfter;
  return pose.judge(body, {!is_lost, false, true, 0.0}, limits, now);
}

models::VehicleLimits with_spare(const models::VehicleLimits& can) {
  return {can.speed_max_mps * kTeammateSpare, can.yaw_rate_max_radps * kTeammateSpare,
          can.brake_mps2 * kTeammateSpare, can.radius_m};
}

// Returns the body, extrapolated from its last pose. A robot unseen for long is assumed to have
// stopped, as it must without a pose. Another body may move on within its uncertainty radius.
OtherBody body_of(const PoseMonitor& pose, const SafetyLimits& limits, Time now) {
  OtherBody body;
  body.position_world_m = pose.predict_m(now, limits.pose_age_hold_s);
  body.age_s = pose.age_s(now);
  body.last_speed_mps = pose.velocity_world_mps().norm();
  if (body.age_s <= limits.pose_age_hold_s) {
    body.velocity_world_mps = pose.velocity_world_mps();
    body.planned_world_mps = body.velocity_world_mps;
  }
  return body;
}

// Returns the straight course of a body; stationary if its last pose is older than the longest
// extrapolation.
OtherCourse course_of(const PoseMonitor& pose, const SafetyLimits& limits, Time now) {
  OtherCourse course;
  course.position_world_m = pose.predict_m(now, kPredictOthersS);
  course.reaches_ground = true;
  if (pose.age_s(now) <= kPredictOthersS) {
    course.velocity_world_mps = pose.velocity_world_mps();
    course.prediction_s = limits.other_prediction_s;
  }
  return course;
}

std::string_view kept_name(const models::MocapBody& body) {
  return std::string_view(body.name).substr(0, kNameMax);
}

}  // namespace

NamedBody find_unique(const models::MocapFrame& frame, const std::string& name) {
  NamedBody out;
  for (const models::MocapBody& body : frame.bodies) {
    if (body.name == name) {
      out.is_unique = out.body == nullptr;
      out.body = &body;
    }
  }
  return out;
}

Fleet::Fleet(const scenario::Scenario& scenario, const std::string& own_name)
    : own_name_(own_name) {
  int index = 0;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (robot.name != own_name) {
      Member& member = members_.emplace_back();
      member.name = robot.name;
      member.is_robot = true;
      member.has_priority = robot.name < own_name;
      member.robot = index;
      member.can = robot.limits;
    }
    ++index;
  }
  for (const scenario::TargetSpec& target : scenario.targets) {
    Member& member = members_.emplace_back();
    member.name = target.name;
    member.can.radius_m = target.radius_m;
  }
  nearest_unknown_.resize(kUnknownBodiesMax);
  for (UnknownBody& unknown : nearest_unknown_) {
    unknown.name.reserve(kNameMax);
  }
  bodies_.reserve(members_.size() + nearest_unknown_.size());
  courses_.reserve(members_.size() + nearest_unknown_.size());
}

void Fleet::on_mocap(const models::MocapFrame& frame, const SafetyLimits& limits, Time now) {
  for (Member& member : members_) {
    const NamedBody found = find_unique(frame, member.name);
    const PoseVerdict verdict =
        judge(member.pose, found.is_unique ? found.body : nullptr, limits, now);
    poses_refused_ += verdict == PoseVerdict::kAccepted || verdict == PoseVerdict::kAbsent ? 0 : 1;
  }
  const models::MocapBody* const own = find_unique(frame, own_name_).body;
  for (const models::MocapBody& body : frame.bodies) {
    const bool is_known = body.name == own_name_ ||
                          std::any_of(members_.begin(), members_.end(), [&](const Member& member) {
                            return member.name == body.name;
                          });
    if (!is_known) {
      ++unknown_bodies_;
      on_unknown_body(body, own, limits, now);
    }
  }
}

void Fleet::on_unknown_body(const models::MocapBody& body, const models::MocapBody* own,
                            const SafetyLimits& limits, Time now) {
  const Eigen::Vector3d& there_m = body.world_from_body.translation_m;
  const Eigen::Vector3d here_m =
      own != nullptr ? own->world_from_body.translation_m : Eigen::Vector3d::Zero();
  const auto known = std::find_if(
      nearest_unknown_.begin(), nearest_unknown_.end(),
      [&](const UnknownBody& each) { return !each.name.empty() && each.name == kept_name(body); });
  UnknownBody* kept = known != nearest_unknown_.end() ? &*known : nullptr;
  if (own != nullptr && !own->occluded && !body.occluded &&
      (there_m - here_m).norm() < limits.vehicle.radius_m) {
    if (kept != nullptr) {
      kept->name.clear();
    }
    return;
  }
  if (kept == nullptr && !body.occluded && !body.name.empty()) {
    kept = entry_for(there_m, here_m, now);
    if (kept == nullptr) {
      ++bodies_dropped_;
    } else {
      kept->name.assign(kept_name(body));
      kept->pose = {};
    }
  }
  if (kept != nullptr) {
    const PoseVerdict verdict = judge(kept->pose, &body, limits, now);
    poses_refused_ += verdict == PoseVerdict::kAccepted || verdict == PoseVerdict::kAbsent ? 0 : 1;
  }
}

Fleet::UnknownBody* Fleet::entry_for(const Eigen::Vector3d& there_m, const Eigen::Vector3d& here_m,
                                     Time now) {
  UnknownBody* farthest = nullptr;
  double farthest_m = (there_m - here_m).norm();
  for (UnknownBody& each : nearest_unknown_) {
    if (each.name.empty() || !each.pose.has_pose() || each.pose.age_s(now) > kForgottenS) {
      return &each;
    }
    const double away_m = (each.pose.world_from_body().translation_m - here_m).norm();
    if (away_m > farthest_m) {
      farthest_m = away_m;
      farthest = &each;
    }
  }
  return farthest;
}

void Fleet::on_status(const std::string& robot, Time now) {
  for (Member& member : members_) {
    if (member.is_robot && member.name == robot) {
      member.reported_at = now;
    }
  }
}

bool Fleet::on_plan(const models::RobotPlan& plan, const SafetyLimits& limits, Time now) {
  const bool is_taken = take(plan, limits, now);
  plans_refused_ += is_taken ? 0 : 1;
  return is_taken;
}

bool Fleet::take(const models::RobotPlan& plan, const SafetyLimits& limits, Time now) {
  const auto member = std::find_if(members_.begin(), members_.end(), [&](const Member& each) {
    return each.is_robot && each.name == plan.robot;
  });
  const Time start = plan.trajectory.start_time;
  const bool is_current = start >= now - from_seconds(limits.plan_past_max_s) &&
                          start <= now + from_seconds(limits.plan_future_max_s);
  if (member == members_.end() || !is_current) {
    return false;
  }
  const bool is_repeated =
      plan.stamp.run_id == member->plan_run && plan.stamp.sequence <= member->plan_sequence;
  HeldPlan held;
  if (is_repeated || (member->has_plan && start < member->plan.start_time) ||
      !hold_plan(plan.trajectory, held) ||
      check_shape(held, with_spare(member->can), limits.lateral_max_mps2 * kTeammateSpare) !=
          PlanVerdict::kAccepted ||
      !member->lease.admit(plan.stamp.run_id, now, limits.planner_lease_s)) {
    return false;
  }
  member->plan = held;
  member->has_plan = true;
  member->plan_run = plan.stamp.run_id;
  member->plan_sequence = plan.stamp.sequence;
  return true;
}

bool Fleet::is_on_plan(const Member& member, Time now, const SafetyLimits& limits) {
  if (!member.pose.has_pose()) {
    return true;
  }
  const Setpoint planned = point_at(member.plan, to_seconds(now - member.plan.start_time));
  return (planned.position_world_m - member.pose.predict_m(now, kPredictOthersS)).norm() <=
         2.0 * limits.tracking_hold_m;
}

std::span<const OtherBody> Fleet::bodies(Time now, const SafetyLimits& limits) {
  bodies_.clear();
  for (const Member& member : members_) {
    if (member.pose.has_pose()) {
      OtherBody body = body_of(member.pose, limits, now);
      body.has_priority = member.has_priority;
      body.robot = member.robot;
      body.brake_mps2 = member.is_robot ? member.can.brake_mps2 : 0.0;
      body.excess_radius_m = std::max(0.0, member.can.radius_m - limits.vehicle.radius_m);
      body.last_speed_mps = member.is_robot ? 0.0 : body.last_speed_mps;
      if (member.is_robot && body.age_s <= limits.pose_age_hold_s) {
        // The measured velocity of a robot that starts to move lags; its plan gives the velocity
        // immediately.
        const double ahead_s = to_seconds(now - member.plan.start_time) + limits.reaction_s;
        const Eigen::Vector3d planned_mps = point_at(member.plan, ahead_s).velocity_world_mps;
        if (member.has_plan && is_on_plan(member, now, limits) &&
            planned_mps.norm() > body.velocity_world_mps.norm()) {
          body.planned_world_mps = planned_mps;
        }
      }
      bodies_.push_back(body);
    }
  }
  for (const UnknownBody& unknown : nearest_unknown_) {
    if (!unknown.name.empty() && unknown.pose.age_s(now) <= kForgottenS) {
      bodies_.push_back(body_of(unknown.pose, limits, now));
    }
  }
  return bodies_;
}

std::span<const OtherCourse> Fleet::courses(Time now, const SafetyLimits& limits) {
  courses_.clear();
  for (const Member& member : members_) {
    const bool is_seen = member.pose.has_pose();
    if (!member.is_robot) {
      if (is_seen) {
        courses_.push_back(course_of(member.pose, limits, now));
      }
      continue;
    }
    if (!member.has_plan && !is_seen) {
      continue;
    }
    // The autopilot of a vehicle without a driver lands vertically.
    const bool is_silent =
        is_seen && member.reported_at && to_seconds(now - *member.reported_at) > kSilentS;
    OtherCourse course;
    course.position_world_m = member.pose.predict_m(now, kPredictOthersS);
    course.reaches_ground = is_silent;
    if (member.has_plan && !is_silent && is_on_plan(member, now, limits)) {
      course.plan = &member.plan;
    }
    courses_.push_back(course);
  }
  for (const UnknownBody& unknown : nearest_unknown_) {
    if (!unknown.name.empty() && unknown.pose.age_s(now) <= kForgottenS) {
      courses_.push_back(course_of(unknown.pose, limits, now));
    }
  }
  return courses_;
}

}  // namespace vantage::drivers
