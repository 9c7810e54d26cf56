#include "trial/observe/observer.hpp"

#include "core/index.hpp"

namespace vantage::trial {

TrialObserver::TrialObserver(bus::Bus& bus, const scenario::Scenario& scenario, Time start)
    : metrics_(scenario, start), recorder_(scenario) {
  for (const scenario::RobotSpec& robot : scenario.robots) {
    robots_.insert(robot.name);
  }
  bus.subscribe<models::TruthFrame>(bus::kTruth, [this](const models::TruthFrame& truth) {
    metrics_.on_truth(truth);
    recorder_.on_truth(truth);
    truth_ = truth;
  });
  bus.subscribe<models::RobotBelief>(bus::belief_channel("*"),
                                     [this](const models::RobotBelief& belief) {
                                       if (!robots_.contains(belief.robot)) {
                                         return;
                                       }
                                       metrics_.on_belief(belief);
                                       recorder_.on_belief(belief);
                                       beliefs_[belief.robot] = belief;
                                     });
  bus.subscribe<models::PoseEstimate>(bus::pose_channel("*"),
                                      [this](const models::PoseEstimate& estimate) {
                                        if (robots_.contains(estimate.robot)) {
                                          metrics_.on_pose(estimate);
                                        }
                                      });
  bus.subscribe<models::RobotPlan>(bus::plan_channel("*"), [this](const models::RobotPlan& plan) {
    if (robots_.contains(plan.robot)) {
      metrics_.on_plan(plan);
      recorder_.on_plan(plan);
    }
  });
  if (scenario.planner.objective == scenario::PlanObjective::kMapping) {
    bus.subscribe<models::RobotMap>(bus::map_channel("*"), [this](const models::RobotMap& map) {
      if (robots_.contains(map.robot)) {
        metrics_.on_map(map);
        recorder_.on_map(map);
        maps_[map.robot] = map;
      }
    });
  }
  bus.subscribe<models::AttackNotice>(
      bus::kAttack, [this](const models::AttackNotice& attack) { recorder_.on_attack(attack); });
  bus.subscribe<models::CollisionReport>(
      bus::kCollision,
      [this](const models::CollisionReport& contact) { metrics_.on_contact(contact); });
  bus.subscribe<models::VehicleStatus>(bus::vehicle_channel("*"),
                                       [this](const models::VehicleStatus& status) {
                                         if (robots_.contains(status.robot)) {
                                           metrics_.on_vehicle(status);
                                         }
                                       });
  bus.subscribe<models::ProcessHealth>(
      bus::health_channel("*"),
      [this](const models::ProcessHealth& health) { metrics_.on_health(health); });
}

logs::Scene TrialObserver::scene() const {
  logs::Scene scene = recorder_.scene();
  for (auto& [id, target] : scene.targets) {
    if (id >= 0 && id < std::ssize(metrics_.targets())) {
      target.estimate = metrics_.targets()[index(id)].estimate;
    }
  }
  return scene;
}

}  // namespace vantage::trial
