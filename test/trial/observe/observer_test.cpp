#include "trial/observe/observer.hpp"

#include <gtest/gtest.h>

#include "scenario/reader/overrides.hpp"
#include "trial/trial.hpp"

namespace vantage::trial {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

scenario::Scenario scenario_of(const std::string& name, double duration_s) {
  scenario::Overrides overrides;
  overrides.seed = 3;
  overrides.duration_s = duration_s;
  overrides.node_budget = 50;
  return scenario::load_scenario_with(VANTAGE_SOURCE_DIR "/config/" + name + ".yaml", overrides);
}

/// An observer and a bus on which the test publishes.
class Observer : public ::testing::Test {
 protected:
  template <class Message>
  void publish_next(const bus::Channel<Message>& channel, Message message) {
    message.stamp.time = kStart + std::chrono::milliseconds(20 * ++messages_sent_);
    sending_bus_.publish(channel, message);
    while (observing_bus_.handle(std::chrono::microseconds(0)) > 0) {
    }
  }
  static models::TruthFrame truth_of(const std::string& name, int id, double x_m, double y_m) {
    models::TruthFrame frame;
    models::TruthBody& body = frame.bodies.emplace_back();
    body.name = name;
    body.target_id = id;
    body.world_from_body.translation_m = {x_m, y_m, 0.5};
    return frame;
  }

  bus::InProcessHub hub_;
  std::unique_ptr<bus::Transport> sending_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> observing_end_ = hub_.connect();
  bus::Bus sending_bus_{*sending_end_, 1};
  bus::Bus observing_bus_{*observing_end_, 2};
  scenario::Scenario scenario_ = scenario_of("lab", 6.0);
  TrialObserver observer_{observing_bus_, scenario_, kStart};
  int messages_sent_ = 0;
};

TEST_F(Observer, IsEmptyBeforeTheFirstMessage) {
  EXPECT_FALSE(observer_.truth());
  EXPECT_TRUE(observer_.beliefs().empty());
  EXPECT_TRUE(observer_.maps().empty());
  EXPECT_EQ(observer_.metrics().collisions(), 0);
  EXPECT_EQ(observer_.metrics().messages_lost(), 0);
}

TEST_F(Observer, KeepsTheNewestTruthAndDrawsIt) {
  publish_next(bus::kTruth, truth_of("R2", 1, 1.0, 0.5));
  publish_next(bus::kTruth, truth_of("R2", 1, 2.0, 0.5));
  ASSERT_TRUE(observer_.truth());
  ASSERT_EQ(observer_.truth()->bodies.size(), 1U);
  EXPECT_EQ(observer_.truth()->bodies[0].world_from_body.translation_m.x(), 2.0);
  ASSERT_TRUE(observer_.scene().targets.contains(1));
  EXPECT_FALSE(observer_.scene().targets.at(1).track.empty());
}

TEST_F(Observer, ReportsContactsVehiclesLossesAndAttacks) {
  models::CollisionReport contact;
  contact.body_a = "Q1";
  contact.body_b = "bounds";
  publish_next(bus::kCollision, contact);
  contact.kind = models::CollisionKind::kCollision;
  contact.distance_m = -0.5;
  publish_next(bus::kCollision, contact);
  publish_next(bus::kCollision, contact);
  EXPECT_EQ(observer_.metrics().separation_violations(), 1);
  EXPECT_EQ(observer_.metrics().collisions(), 2);

  models::VehicleStatus status;
  status.robot = "Q2";
  status.state = models::FlightState::kLand;
  publish_next(bus::vehicle_channel("Q2"), status);
  EXPECT_EQ(observer_.metrics().robots().at("Q2").state, models::FlightState::kLand);
  EXPECT_FALSE(observer_.metrics().robots().at("Q1").state);

  models::ProcessHealth health;
  health.process = "PLANNER_Q1";
  health.counters = {{"BELIEF_Q2.lost", 5}};
  publish_next(bus::health_channel("PLANNER_Q1"), health);
  EXPECT_EQ(observer_.metrics().messages_lost(), 5);

  models::AttackNotice attack;
  attack.jammed = {"Q3"};
  publish_next(bus::kAttack, attack);
  EXPECT_EQ(observer_.scene().jammed, std::set<std::string>{"Q3"});
  attack.jammed.clear();
  publish_next(bus::kAttack, attack);
  EXPECT_TRUE(observer_.scene().jammed.empty());
}

// Without signatures, anyone on the network can send messages of robots that do not exist.
TEST_F(Observer, IgnoresRobotsOutsideTheScenario) {
  const std::size_t robots = scenario_.robots.size();
  for (int i = 0; i < 50; ++i) {
    const std::string name = "X" + std::to_string(i);
    models::VehicleStatus status;
    status.robot = name;
    publish_next(bus::vehicle_channel(name), status);
    models::RobotBelief belief;
    belief.robot = name;
    publish_next(bus::belief_channel(name), belief);
    models::RobotPlan plan;
    plan.robot = name;
    publish_next(bus::plan_channel(name), plan);
  }
  EXPECT_EQ(observer_.metrics().robots().size(), robots);
  EXPECT_EQ(observer_.scene().robots.size(), robots);
  EXPECT_TRUE(observer_.beliefs().empty());
  EXPECT_EQ(observer_.metrics().rounds(), 0);
}

// A body whose number is not a target of the scenario is drawn without an estimate.
TEST_F(Observer, IgnoresBodiesThatAreNotTargets) {
  const int targets = static_cast<int>(scenario_.targets.size());
  for (const int id : {0, targets - 1, targets, targets + 100}) {
    publish_next(bus::kTruth, truth_of("B" + std::to_string(id), id, 0.1 * id, 0.0));
  }
  const logs::Scene scene = observer_.scene();
  for (const auto& [id, target] : scene.targets) {
    EXPECT_FALSE(target.estimate) << id;
  }
}

// Tests every target number, including the first, 0, and the last.
TEST_F(Observer, HasTheTeamsEstimateOfEveryTarget) {
  const auto mean_of = [](int id) { return Eigen::Vector2d(0.5 * id - 1.0, 0.25 * id); };
  models::RobotBelief belief;
  belief.robot = "Q1";
  for (const scenario::TargetSpec& target : scenario_.targets) {
    models::TargetBelief& known = belief.targets.emplace_back();
    known.target_id = target.id;
    known.information.matrix = 4.0 * Eigen::Matrix2d::Identity();
    known.information.vector = known.information.matrix * mean_of(target.id);
    known.last_seen = kStart;
    publish_next(bus::kTruth, truth_of(target.name, target.id, 0.1, 0.2));
  }
  for (const int step : {1, 2, 3}) {
    belief.step = step;
    belief.stamp.time = kStart + std::chrono::milliseconds(500 * step);
    belief.stamp.sequence = step;
    sending_bus_.publish(bus::belief_channel("Q1"), belief);
    while (observing_bus_.handle(std::chrono::microseconds(0)) > 0) {
    }
  }
  const logs::Scene scene = observer_.scene();
  ASSERT_EQ(scene.targets.size(), scenario_.targets.size());
  for (const auto& [id, target] : scene.targets) {
    ASSERT_TRUE(target.estimate) << id;
    EXPECT_LT((target.estimate->mean_m - mean_of(id)).norm(), 1e-9) << id;
    const auto index = static_cast<std::size_t>(id);
    EXPECT_EQ(observer_.metrics().targets().at(index).name, scenario_.targets.at(index).name);
  }
}

TEST(TrialObserver, HasTheBeliefOfEachRobotAndTheTeamsEstimateOfEachTarget) {
  const scenario::Scenario scenario = scenario_of("lab", 6.0);
  Trial trial(scenario, trial_recipes(scenario), "");
  trial.advance_to(trial.planned_end());
  const TrialObserver& observer = trial.observer();
  ASSERT_EQ(observer.beliefs().size(), scenario.robots.size());
  for (const auto& [robot, belief] : observer.beliefs()) {
    EXPECT_EQ(belief.robot, robot);
    EXPECT_GT(belief.stamp.time, trial.planned_end() - std::chrono::seconds(1)) << "the newest";
  }
  EXPECT_TRUE(observer.maps().empty()) << "a tracking team has no maps";
  const logs::Scene scene = observer.scene();
  int known = 0;
  ASSERT_EQ(scene.targets.size(), scenario.targets.size());
  for (const auto& [id, target] : scene.targets) {
    const auto& estimate = observer.metrics().targets().at(static_cast<std::size_t>(id)).estimate;
    ASSERT_EQ(target.estimate.has_value(), estimate.has_value()) << id;
    if (estimate) {
      ++known;
      EXPECT_EQ(target.estimate->mean_m, estimate->mean_m) << id;
    }
  }
  EXPECT_GT(known, 0);
  for (const auto& [robot, seen] : scene.robots) {
    EXPECT_TRUE(seen.plan) << robot;
    EXPECT_TRUE(observer.metrics().robots().at(robot).plan) << robot;
  }
}

TEST(TrialObserver, HasTheNewestMapOfEachRobotInAMappingTrial) {
  const scenario::Scenario scenario = scenario_of("mapping", 3.0);
  Trial trial(scenario, trial_recipes(scenario), "");
  trial.advance_to(trial.planned_end());
  const TrialObserver& observer = trial.observer();
  ASSERT_EQ(observer.maps().size(), scenario.robots.size());
  double sum_nats = 0.0;
  for (const auto& [robot, map] : observer.maps()) {
    EXPECT_EQ(map.robot, robot);
    EXPECT_GT(map.stamp.time, trial.planned_end() - std::chrono::seconds(1));
    sum_nats += map.entropy_nats;
    EXPECT_EQ(observer.scene().map_entropies_nats.at(robot), map.entropy_nats);
  }
  ASSERT_TRUE(observer.metrics().map_entropy_nats());
  EXPECT_NEAR(*observer.metrics().map_entropy_nats(),
              sum_nats / static_cast<double>(observer.maps().size()), 1e-9 * sum_nats);
}

}  // namespace
}  // namespace vantage::trial
