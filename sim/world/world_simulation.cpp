#include "sim/world/world_simulation.hpp"

#include <algorithm>
#include <utility>

namespace vantage::sim {
namespace {

constexpr Duration kDecision{static_cast<std::int64_t>(RoverFleet::kDecisionPeriodS * 1e6)};

Time next_multiple(Time time, Duration period) {
  return from_utime((to_utime(time) / period.count() + 1) * period.count());
}

std::vector<Quadrotor> quadrotors_of(const models::Scenario& scenario, std::uint64_t seed,
                                     Time start) {
  std::vector<Quadrotor> quadrotors;
  for (const models::RobotSpec& robot : scenario.robots) {
    if (robot.device != models::DeviceSource::kReal) {
      quadrotors.emplace_back(robot, scenario.planner.tracking_tolerance_m, seed, start);
    }
  }
  return quadrotors;
}

std::vector<CollisionMonitor::Body> bodies_of(const std::vector<Quadrotor>& quadrotors,
                                              const std::vector<models::TargetSpec>& targets) {
  std::vector<CollisionMonitor::Body> bodies;
  for (const Quadrotor& quadrotor : quadrotors) {
    bodies.push_back({quadrotor.name(), quadrotor.radius_m(), true});
  }
  for (const models::TargetSpec& target : targets) {
    bodies.push_back({target.name, target.radius_m, false});
  }
  return bodies;
}

}  // namespace

WorldSimulation::WorldSimulation(const models::Scenario& scenario, std::uint64_t seed, Time start)
    : targets_(scenario.targets),
      time_(start),
      decided_(start),
      quadrotors_(quadrotors_of(scenario, seed, start)),
      ground_(scenario, seed),
      camera_(scenario.mocap, seed),
      collisions_(scenario.world, bodies_of(quadrotors_, targets_), scenario.planner.separation_m) {
  watch();
}

void WorldSimulation::advance_to(Time time) {
  while (time_ < time) {
    if (to_utime(time_) % kDecision.count() == 0) {
      ground_.decide(to_seconds(time_ - decided_));
      decided_ = time_;
    }
    step(std::min(time, next_multiple(time_, kStep)));
  }
}

void WorldSimulation::step(Time to) {
  const double dt_s = to_seconds(to - time_);
  for (Quadrotor& quadrotor : quadrotors_) {
    quadrotor.step(time_, dt_s);
  }
  ground_.step(dt_s);
  time_ = to;
  watch();
}

void WorldSimulation::watch() {
  centres_m_.clear();
  for (const Quadrotor& quadrotor : quadrotors_) {
    centres_m_.push_back(quadrotor.position_world_m());
  }
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const Pose2 pose = ground_.world_from_body(i);
    centres_m_.emplace_back(pose.x_m, pose.y_m, 0.0);
  }
  collisions_.update(time_, centres_m_, contacts_);
}

std::optional<PlanVerdict> WorldSimulation::offer(const models::RobotPlan& plan) {
  for (Quadrotor& quadrotor : quadrotors_) {
    if (quadrotor.name() == plan.robot) {
      return quadrotor.offer(plan, time_);
    }
  }
  return std::nullopt;
}

void WorldSimulation::command(const models::OperatorCommand& command) {
  for (Quadrotor& quadrotor : quadrotors_) {
    if (command.robot.empty() || command.robot == quadrotor.name()) {
      quadrotor.command(command.action, time_);
    }
  }
}

models::TruthFrame WorldSimulation::truth() const {
  models::TruthFrame frame;
  frame.stamp.time = time_;
  frame.bodies.reserve(quadrotors_.size() + targets_.size());
  for (const Quadrotor& quadrotor : quadrotors_) {
    frame.bodies.push_back(
        {quadrotor.name(), -1, quadrotor.world_from_body(), quadrotor.velocity_world_mps()});
  }
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const Eigen::Vector2d velocity_mps = ground_.velocity_mps(i);
    frame.bodies.push_back({targets_[i].name, targets_[i].id, lift(ground_.world_from_body(i), 0.0),
                            Eigen::Vector3d(velocity_mps.x(), velocity_mps.y(), 0.0)});
  }
  return frame;
}

std::vector<models::ContactReport> WorldSimulation::take_contacts() {
  return std::exchange(contacts_, {});
}

}  // namespace vantage::sim
