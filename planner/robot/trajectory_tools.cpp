#include "planner/robot/trajectory_tools.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::planner {
namespace {

double longest_stop_s(const std::vector<scenario::RobotSpec>& robots) {
  double stop_s = 0.0;
  for (const scenario::RobotSpec& robot : robots) {
    stop_s = std::max(stop_s, robot.limits.speed_max_mps / robot.limits.brake_mps2);
  }
  return stop_s;
}

}  // namespace

models::Trajectory remainder_of(const models::Trajectory& trajectory, Time start) {
  models::Trajectory rest;
  rest.start_time = start;
  rest.start = models::at(trajectory, start).world_from_body;
  rest.height_m = trajectory.height_m;
  double skip_s = to_seconds(start - trajectory.start_time);
  for (const models::PlanSegment& segment : trajectory.segments) {
    if (skip_s >= segment.duration_s) {
      skip_s -= segment.duration_s;
      continue;
    }
    models::PlanSegment left = segment;
    left.duration_s -= skip_s;
    left.control.speed_mps -= segment.brake_mps2 * skip_s;
    rest.segments.push_back(left);
    skip_s = 0.0;
  }
  return rest;
}

models::Trajectory stop_from(const models::Trajectory& trajectory, Time start, double brake_mps2) {
  const models::TrajectoryPoint now = models::at(trajectory, start);
  models::Trajectory stop = hover_at(now.world_from_body, trajectory.height_m, start);
  if (now.control.speed_mps > 0.0) {
    stop.segments = models::brake(now.control.speed_mps, brake_mps2);
  }
  return stop;
}

models::Trajectory hover_at(const Pose2& pose, double height_m, Time start) {
  models::Trajectory hover;
  hover.start_time = start;
  hover.start = pose;
  hover.height_m = height_m;
  return hover;
}

bool is_stationary(const models::Trajectory& motion) {
  return std::all_of(motion.segments.begin(), motion.segments.end(),
                     [](const auto& each) { return each.control.speed_mps == 0.0; });
}

int motion_steps_max(const scenario::PlannerSpec& planner,
                     const std::vector<scenario::RobotSpec>& robots) {
  // MotionTable rounds the end of the motion and the robot's own stop up to whole steps, and adds
  // one step.
  const double stops = 2.0 * std::ceil(longest_stop_s(robots) / planner.step_s);
  return 2 * kPlanHorizonsMax * planner.horizon_steps + static_cast<int>(stops) + 2;
}

bool is_of_plan_length(const models::Trajectory& motion, const scenario::PlannerSpec& planner,
                       const std::vector<scenario::RobotSpec>& robots) {
  const int steps_max = kPlanHorizonsMax * planner.horizon_steps;
  const double stop_s = longest_stop_s(robots);
  double motion_s = 0.0;
  for (const models::PlanSegment& segment : motion.segments) {
    motion_s += segment.duration_s;
  }
  return motion.segments.size() <= static_cast<std::size_t>(steps_max) &&
         motion_s <= steps_max * planner.step_s + stop_s;
}

}  // namespace vantage::planner
