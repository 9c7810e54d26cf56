#include "sim/world/world_simulation.hpp"

#include <algorithm>
#include <utility>

namespace vantage::sim {
namespace {

constexpr Duration kDecision{static_cast<std::int64_t>(RoverFleet::kDecisionPeriodS * 1e6)};

Time next_multiple(Time time, Duration period) {
  return from_utime((to_utime(time) / period.count() + 1) * period.count());
}

Vehicle* find(const std::vector<Vehicle*>& vehicles, const std::string& name) {
  const auto found = std::find_if(vehicles.begin(), vehicles.end(),
                                  [&](const Vehicle* vehicle) { return vehicle->name() == name; });
  return found == vehicles.end() ? nullptr : *found;
}

std::vector<Quadrotor> quadrotors_of(const scenario::Scenario& scenario, std::uint64_t seed,
                                     Time start, const std::vector<Vehicle*>& given) {
  std::vector<Quadrotor> quadrotors;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (robot.device != scenario::DeviceSource::kReal && find(given, robot.name) == nullptr) {
      quadrotors.emplace_back(robot, scenario.planner.tracking_tolerance_m, seed, start,
                              parameters_in(scenario.wind));
    }
  }
  return quadrotors;
}

std::vector<Vehicle*> vehicles_of(const scenario::Scenario& scenario,
                                  std::vector<Quadrotor>& quadrotors, std::vector<Vehicle*> given) {
  for (Quadrotor& quadrotor : quadrotors) {
    given.push_back(&quadrotor);
  }
  std::vector<Vehicle*> vehicles;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (Vehicle* const vehicle = find(given, robot.name)) {
      vehicles.push_back(vehicle);
    }
  }
  return vehicles;
}

std::vector<models::CollisionMonitor::Body> bodies_of(
    const std::vector<Vehicle*>& vehicles, const std::vector<scenario::TargetSpec>& targets) {
  std::vector<models::CollisionMonitor::Body> bodies;
  for (const Vehicle* vehicle : vehicles) {
    bodies.push_back({vehicle->name(), vehicle->radius_m(), true});
  }
  for (const scenario::TargetSpec& target : targets) {
    bodies.push_back({target.name, target.radius_m, false});
  }
  return bodies;
}

}  // namespace

WorldSimulation::WorldSimulation(const scenario::Scenario& scenario, std::uint64_t seed, Time start,
                                 const std::vector<Vehicle*>& vehicles)
    : targets_(scenario.targets),
      time_(start),
      decided_(start),
      quadrotors_(quadrotors_of(scenario, seed, start, vehicles)),
      external_vehicles_(vehicles),
      vehicles_(vehicles_of(scenario, quadrotors_, vehicles)),
      ground_(scenario, seed),
      camera_(scenario.mocap, seed),
      collisions_(scenario.world, bodies_of(vehicles_, targets_), scenario.planner.separation_m) {
  watch();
}

void WorldSimulation::advance_to(Time time) {
  while (time_ < time) {
    if (to_utime(time_) % kDecision.count() == 0) {
      keep_ground_free();
      ground_.decide(to_seconds(time_ - decided_));
      decided_ = time_;
    }
    step(std::min(time, next_multiple(time_, kStep)));
  }
}

void WorldSimulation::keep_ground_free() {
  std::vector<Eigen::Vector2d> low_m;
  for (const Vehicle* vehicle : external_vehicles_) {
    const Eigen::Vector3d centre_m = vehicle->world_from_body().translation_m;
    if (centre_m.z() < kLowM) {
      low_m.emplace_back(centre_m.head<2>());
    }
  }
  ground_.keep_out(std::move(low_m), kKeepOutM);
}

void WorldSimulation::step(Time to) {
  const double dt_s = to_seconds(to - time_);
  for (Vehicle* vehicle : vehicles_) {
    vehicle->step(time_, dt_s);
  }
  ground_.step(dt_s);
  time_ = to;
  watch();
}

void WorldSimulation::watch() {
  centres_m_.clear();
  for (const Vehicle* vehicle : vehicles_) {
    centres_m_.push_back(vehicle->world_from_body().translation_m);
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

void WorldSimulation::fly_by(const std::string& robot,
                             const std::optional<Pose2>& assumed_from_true) {
  for (Quadrotor& quadrotor : quadrotors_) {
    if (quadrotor.name() == robot) {
      quadrotor.fly_by(assumed_from_true);
    }
  }
}

models::TruthFrame WorldSimulation::truth() const {
  models::TruthFrame frame;
  frame.stamp.time = time_;
  frame.bodies.reserve(vehicles_.size() + targets_.size());
  for (const Vehicle* vehicle : vehicles_) {
    frame.bodies.push_back(
        {vehicle->name(), -1, vehicle->world_from_body(), vehicle->velocity_world_mps()});
  }
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const Eigen::Vector2d velocity_mps = ground_.velocity_mps(i);
    frame.bodies.push_back({targets_[i].name, targets_[i].id, lift(ground_.world_from_body(i), 0.0),
                            Eigen::Vector3d(velocity_mps.x(), velocity_mps.y(), 0.0)});
  }
  return frame;
}

std::vector<models::CollisionReport> WorldSimulation::take_contacts() {
  return std::exchange(contacts_, {});
}

}  // namespace vantage::sim
