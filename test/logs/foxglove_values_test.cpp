#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/foxglove/scene.hpp"
#include "logs/foxglove/values.hpp"
#include "test/logs/foxglove_notebook.hpp"

namespace vantage::logs::foxglove {
namespace {

constexpr Time kTime = from_utime(1'700'000'000'250'000);

TEST(FrameTransforms, ContainBodyPosesInTheWorldFrame) {
  const Quaternion turn(0.5, -0.1, 0.2, 0.3);
  models::MocapFrame frame;
  frame.stamp.time = kTime;
  frame.bodies = {{"Q1", {{1.0, 2.0, 3.0}, turn}, false}};
  const Json wanted{{"timestamp", to_json(kTime)},
                    {"parent_frame_id", "world"},
                    {"child_frame_id", "Q1"},
                    {"translation", {{"x", 1.0}, {"y", 2.0}, {"z", 3.0}}},
                    {"rotation", {{"w", 0.5}, {"x", -0.1}, {"y", 0.2}, {"z", 0.3}}}};
  EXPECT_EQ(frame_transforms(frame), (Json{{"transforms", Json::array({wanted})}}));
  models::TruthFrame truth;
  truth.stamp.time = kTime;
  truth.bodies = {{"Q1", -1, {{1.0, 2.0, 3.0}, turn}, Eigen::Vector3d::Zero()}};
  EXPECT_EQ(frame_transforms(truth, ""), (Json{{"transforms", Json::array({wanted})}}));
}

TEST(VisibilityGrid, IsAlignedWithItsCells) {
  const models::GridGeometry grid{{-1.5, 2.25}, 0.5, 3, 2};
  const Json made = visibility_grid(grid, {0, 1, 2, 3, 4, 5}, kTime);
  EXPECT_EQ(made.at("timestamp"), to_json(kTime));
  EXPECT_EQ(made.at("frame_id"), "world");
  EXPECT_EQ(made.at("pose").at("position"), (Json{{"x", -1.5}, {"y", 2.25}, {"z", 0.0}}));
  EXPECT_EQ(made.at("cell_size"), (Json{{"x", 0.5}, {"y", 0.5}}));
  EXPECT_EQ(made.at("column_count"), 3);
  EXPECT_EQ(made.at("cell_stride"), 4) << "a float";
  EXPECT_EQ(made.at("row_stride"), 3 * 4);
  // 7 is FLOAT32 of foxglove.PackedElementField.
  EXPECT_EQ(made.at("fields"), Json::array({{{"name", "age_s"}, {"offset", 0}, {"type", 7}}}));
  EXPECT_EQ(made.at("data").get<std::string>().size(), 4U * 6U * 4U / 3U);
}

TEST(ScenarioJson, ContainsWorldRobotsAndTargets) {
  scenario::Scenario scenario = lab();
  scenario.name = "a name";
  scenario.duration_s = 123.5;
  scenario.world.bounds = {{-4.5, -2.0}, {5.0, 3.5}};
  scenario.world.ceiling_m = 2.75;
  scenario.estimator.grid_memory_s = 17.0;
  scenario.robots.resize(2);
  scenario.robots[1].name = "Z9";
  scenario.robots[1].height_m = 1.25;
  scenario.robots[1].limits.radius_m = 0.375;
  scenario.robots[1].sensor.range_max_m = 6.5;
  scenario.robots[1].sensor.fov_rad = 1.5;
  scenario.targets.resize(2);
  scenario.targets[1].name = "T9";
  scenario.targets[1].id = 9;
  scenario.targets[1].radius_m = 0.625;
  models::ScenarioNotice notice;
  notice.stamp.time = kTime;
  notice.yaml = "the file";
  notice.version = "1.2.3";
  notice.process = "SIM";
  const Json made = scenario_json(notice, scenario);
  EXPECT_EQ(made.at("timestamp"), to_json(kTime));
  EXPECT_EQ(made.at("name"), "a name");
  EXPECT_EQ(made.at("version"), "1.2.3");
  EXPECT_EQ(made.at("process"), "SIM");
  EXPECT_EQ(made.at("yaml"), "the file");
  EXPECT_EQ(made.at("objective"), "tracking");
  EXPECT_EQ(made.at("grid_memory_s"), 17.0);
  EXPECT_EQ(made.at("duration_s"), 123.5);
  EXPECT_EQ(made.at("ceiling_m"), 2.75);
  EXPECT_EQ(made.at("bounds"), (Json{{"min_m", {-4.5, -2.0}}, {"max_m", {5.0, 3.5}}}));
  EXPECT_EQ(made.at("robots").at(1), (Json{{"name", "Z9"},
                                           {"color", to_json(*robot_colour(scenario, "Z9"))},
                                           {"height_m", 1.25},
                                           {"radius_m", 0.375},
                                           {"sensor_range_m", 6.5},
                                           {"fov_rad", 1.5}}));
  EXPECT_EQ(made.at("targets").at(1), (Json{{"name", "T9"}, {"id", 9}, {"radius_m", 0.625}}));
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  EXPECT_EQ(scenario_json(notice, scenario).at("objective"), "mapping");
}

TEST(PlanJson, ContainsEveryNumber) {
  models::RobotPlan plan;
  plan.stamp.time = kTime;
  plan.robot = "Q2";
  plan.round = 41;
  plan.source = models::PlanSource::kShifted;
  plan.passes = 3;
  plan.nodes = 5;
  plan.cost = 7.5;
  plan.lower_bound = 7.0;
  plan.epsilon = 0.25;
  plan.delta_m = 0.125;
  plan.late = true;
  plan.deadline = kTime;
  plan.finish = kTime + from_seconds(0.5);
  EXPECT_EQ(plan_json(plan), (Json{{"timestamp", to_json(kTime)},
                                   {"robot", "Q2"},
                                   {"round", 41},
                                   {"source", "shifted"},
                                   {"passes", 3},
                                   {"nodes", 5},
                                   {"cost_nat", 7.5},
                                   {"lower_bound_nat", 7.0},
                                   {"gap_nat", 0.5},
                                   {"epsilon", 0.25},
                                   {"delta_m", 0.125},
                                   {"margin_s", -0.5},
                                   {"late", true}}));
}

TEST(VehicleJson, ContainsEveryNumber) {
  models::VehicleStatus status;
  status.stamp.time = kTime;
  status.robot = "Q2";
  status.state = models::FlightState::kHold;
  status.battery_share = 0.75;
  status.plan_round = 41;
  status.setpoint = {1.0, 2.0, 0.5};
  status.setpoint_height_m = 3.0;
  status.reasons = {"pose too old"};
  Json wanted{{"timestamp", to_json(kTime)},
              {"robot", "Q2"},
              {"state", "hold"},
              {"battery_share", 0.75},
              {"plan_round", 41},
              {"setpoint", {{"x_m", 1.0}, {"y_m", 2.0}, {"yaw_rad", 0.5}, {"height_m", 3.0}}},
              {"reasons", {"pose too old"}}};
  EXPECT_EQ(vehicle_json(status), wanted);
  wanted["capture_to_setpoint_s"] = 1.5;
  EXPECT_EQ(vehicle_json(status, from_seconds(1.5)), wanted);
}

TEST(HealthJson, SumsLossAndNamesTheState) {
  models::ProcessHealth health;
  health.stamp.time = kTime;
  health.process = "PLANNER_Q1";
  health.loops = 11;
  health.loop_worst_s = 0.25;
  health.deadlines_missed = 2;
  health.counters = {{"VICON.lost", 3}, {"VICON.duplicates", 50}, {"BELIEF_Q2.lost", 4}};
  const std::vector<std::string> names = {"starting", "running", "degraded", "stopping"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    health.state = static_cast<models::ProcessState>(i);
    const Json made = health_json(health);
    EXPECT_EQ(made.at("state"), names[i]);
    EXPECT_EQ(made.at("messages_lost"), 7);
    EXPECT_EQ(made.at("loops"), 11);
    EXPECT_EQ(made.at("loop_worst_s"), 0.25);
    EXPECT_EQ(made.at("deadlines_missed"), 2);
    EXPECT_EQ(made.at("process"), "PLANNER_Q1");
    EXPECT_EQ(made.at("timestamp"), to_json(kTime));
    EXPECT_EQ(made.at("counters").at(2), (Json{{"name", "BELIEF_Q2.lost"}, {"count", 4}}));
    EXPECT_EQ(made.at("counters").size(), 3U);
  }
}

TEST(AttackJson, NamesJammedRobots) {
  models::AttackNotice attack{{kTime, 1, 2}, {"Q2", "Q1"}};
  EXPECT_EQ(attack_json(attack), (Json{{"timestamp", to_json(kTime)}, {"jammed", {"Q2", "Q1"}}}));
}

models::TargetBelief known(int id, double x_m, double y_m, double sigma_m, Time seen) {
  models::TargetBelief out;
  out.target_id = id;
  out.information.matrix = Eigen::Matrix2d::Identity() / (sigma_m * sigma_m);
  out.information.vector = out.information.matrix * Eigen::Vector2d(x_m, y_m);
  out.last_seen = seen;
  return out;
}

models::RobotBelief belief(const std::string& robot, Time time,
                           std::vector<models::TargetBelief> targets) {
  models::RobotBelief out;
  out.robot = robot;
  out.stamp.time = time;
  out.targets = std::move(targets);
  return out;
}

// Three of five targets are tracked; the truth is received for two of these three.
TEST(TeamJson, DescribesTheNewestEvaluatedStep) {
  const scenario::Scenario scenario = lab();
  ASSERT_EQ(scenario.targets.size(), 5U);
  TrialMetrics metrics(scenario, kTime);
  const Json before = team_json(metrics, kTime);
  EXPECT_EQ(before.at("known"), 0);
  for (const char* absent : {"rmse_m", "robot_rmse_m", "robot_entropy_nats", "nees_by_age",
                             "nees_expected", "map_entropy_nats"}) {
    EXPECT_FALSE(before.contains(absent)) << absent;
  }
  for (const double at_s : {0.0, 2.0}) {
    models::TruthFrame truth;
    truth.stamp.time = kTime + from_seconds(at_s);
    truth.bodies = {{"R1", 0, {{1.0, 0.0, 0.0}, Quaternion::Identity()}, {}},
                    {"R2", 1, {{0.0, 2.0, 0.0}, Quaternion::Identity()}, {}}};
    metrics.on_truth(truth);
  }
  const Time step = kTime + from_seconds(0.5);
  metrics.on_belief(belief("Q1", step,
                           {known(0, 1.0, 3.0, 1.0, step), known(1, 0.0, 6.0, 2.0, step),
                            known(2, 0.0, 0.0, 1.0, step)}));
  metrics.on_belief(belief("Q2", step, {}));
  metrics.on_belief(belief("Q1", step + from_seconds(0.5), {}));
  metrics.on_belief(belief("Q1", step + from_seconds(1.0), {}));
  models::CollisionReport contact;
  contact.kind = models::CollisionKind::kCollision;
  metrics.on_contact(contact);
  contact.kind = models::CollisionKind::kNearMiss;
  metrics.on_contact(contact);
  metrics.on_contact(contact);
  models::RobotPlan plan;
  plan.robot = "Q1";
  for (plan.round = 1; plan.round <= 4; ++plan.round) {
    plan.late = plan.round == 3;
    metrics.on_plan(plan);
  }
  models::ProcessHealth health;
  health.counters = {{"VICON.lost", 5}};
  metrics.on_health(health);
  models::RobotMap map;
  for (const auto& [robot, nats] : {std::pair{"Q1", 10.0}, {"Q2", 30.0}}) {
    map.robot = robot;
    map.entropy_nats = nats;
    metrics.on_map(map);
  }
  const Json made = team_json(metrics, kTime);
  EXPECT_EQ(made.at("timestamp"), to_json(kTime));
  EXPECT_EQ(made.at("known"), 3);
  EXPECT_EQ(made.at("targets"), 5);
  EXPECT_EQ(made.at("collisions"), 1);
  EXPECT_EQ(made.at("separation_violations"), 2);
  EXPECT_EQ(made.at("rounds"), 4);
  EXPECT_EQ(made.at("rounds_late"), 1);
  EXPECT_EQ(made.at("messages_lost"), 5);
  EXPECT_EQ(made.at("map_entropy_nats"), 20.0);
  EXPECT_NEAR(made.at("rmse_m").get<double>(), std::sqrt((9.0 + 16.0) / 2.0), 1e-9);
  EXPECT_NEAR(made.at("robot_rmse_m").get<double>(), std::sqrt((9.0 + 16.0) / 2.0), 1e-9);
  const double prior_nats =
      isotropic_entropy_nats(scenario.estimator.undiscovered_position_sigma_m, 2);
  const double team_nats =
      (2.0 * isotropic_entropy_nats(1.0, 2) + isotropic_entropy_nats(2.0, 2) + 2.0 * prior_nats) /
      5.0;
  EXPECT_NEAR(made.at("entropy_nats").get<double>(), team_nats, 1e-9);
  EXPECT_NEAR(made.at("robot_entropy_nats").get<double>(), 0.5 * (team_nats + prior_nats), 1e-9);
  // The errors are 3 σ and 2 σ; both targets were observed less than 1 s ago.
  ASSERT_EQ(made.at("nees_by_age").size(), 1U);
  EXPECT_EQ(made.at("nees_by_age")[0].at("age_s"), "0-1");
  EXPECT_EQ(made.at("nees_by_age")[0].at("samples"), 2);
  EXPECT_NEAR(made.at("nees_by_age")[0].at("mean").get<double>(), (9.0 + 4.0) / 2.0, 1e-9);
  EXPECT_EQ(made.at("nees_expected"), 2);
}

TEST(LogJson, ContainsTheEventAndItsLevel) {
  const int levels[] = {1, 2, 3, 4, 5};  // levels of foxglove.Log
  const LogLevel named[] = {LogLevel::kDebug, LogLevel::kInfo, LogLevel::kWarning, LogLevel::kError,
                            LogLevel::kFatal};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(log_json({kTime, named[i], "the kind", "the text"}),
              (Json{{"timestamp", to_json(kTime)},
                    {"level", levels[i]},
                    {"message", "the text"},
                    {"name", "the kind"},
                    {"file", ""},
                    {"line", 0}}));
  }
}

void expect_event(const std::optional<Event>& event, LogLevel level, const std::string& kind,
                  const std::string& text) {
  ASSERT_TRUE(event) << text;
  EXPECT_EQ(event->time, kTime);
  EXPECT_EQ(event->level, level) << text;
  EXPECT_EQ(event->kind, kind);
  EXPECT_EQ(event->text, text);
}

TEST(EventOf, ReportsBodiesAndDistanceOfAContact) {
  models::CollisionReport contact{
      {kTime, 0, 0}, models::CollisionKind::kNearMiss, "Q1", "Q2", 0.123};
  expect_event(event_of(contact), LogLevel::kWarning, "near_miss",
               "Q1 and Q2 came too close (0.12 m)");
  contact.kind = models::CollisionKind::kCollision;
  contact.distance_m = -0.02;
  expect_event(event_of(contact), LogLevel::kFatal, "collision", "Q1 and Q2 collided (-0.02 m)");
}

TEST(EventOf, ReportsLatePlansAndFallbacks) {
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.round = 1'795'300'099;
  plan.finish = kTime;
  plan.deadline = kTime - from_seconds(0.0125);
  plan.source = models::PlanSource::kShifted;
  expect_event(event_of(plan), LogLevel::kWarning, "fallback", "Q1: plan of round 99 is shifted");
  plan.late = true;
  expect_event(event_of(plan), LogLevel::kWarning, "late", "Q1: plan of round 99 was 12.5 ms late");
}

TEST(EventOf, ReportsVehicleStateAndReasons) {
  using models::FlightState;
  models::VehicleStatus status;
  status.robot = "Q1";
  status.stamp.time = kTime;
  // A first status is an event, except in the states idle and follow.
  for (const FlightState calm : {FlightState::kIdle, FlightState::kFollow}) {
    status.state = calm;
    EXPECT_FALSE(event_of(nullptr, status));
  }
  status.reasons = {"a", "b"};
  expect_event(event_of(nullptr, status), LogLevel::kWarning, "safety", "Q1: follow: a, b");
  models::VehicleStatus before = status;
  EXPECT_FALSE(event_of(&before, status));
  before.reasons = {"a"};
  expect_event(event_of(&before, status), LogLevel::kWarning, "safety", "Q1: follow: a, b");
  before = status;
  status.state = FlightState::kLand;
  expect_event(event_of(&before, status), LogLevel::kWarning, "safety", "Q1: land: a, b");
  status.reasons.clear();
  expect_event(event_of(nullptr, status), LogLevel::kWarning, "safety", "Q1: land");
  before = status;
  status.state = FlightState::kKilled;
  expect_event(event_of(&before, status), LogLevel::kError, "safety", "Q1: killed");
  status.state = FlightState::kIdle;
  expect_event(event_of(&before, status), LogLevel::kInfo, "safety", "Q1: idle");
}

TEST(EventOf, ReportsTheEndOfJamming) {
  const models::AttackNotice none{{kTime, 0, 0}, {}};
  const models::AttackNotice one{{kTime, 0, 0}, {"Q2"}};
  expect_event(event_of(nullptr, one), LogLevel::kWarning, "attack", "jammed: Q2");
  expect_event(event_of(&one, none), LogLevel::kInfo, "attack", "no sensor is jammed anymore");
  const models::AttackNotice two{{kTime, 0, 0}, {"Q2", "Q1"}};
  expect_event(event_of(&one, two), LogLevel::kWarning, "attack", "jammed: Q1, Q2");
  const models::AttackNotice two_again{{kTime, 0, 0}, {"Q1", "Q2"}};
  EXPECT_FALSE(event_of(&two, two_again));
  EXPECT_FALSE(event_of(&two_again, two));
}

TEST(EventOf, ReportsAnAbandonedProcessOnce) {
  using models::SupervisedPhase;
  models::HostReport report;
  report.stamp.time = kTime;
  report.host = "AIR";
  report.processes.resize(3);
  report.processes[0].name = "sim";
  report.processes[1].name = "planner Q1";
  report.processes[1].last_end = "signal 9";
  report.processes[2].name = "planner Q2";
  report.processes[2].last_end = "exit 1";
  EXPECT_FALSE(event_of(nullptr, report));
  models::HostReport before = report;
  report.processes[1].phase = SupervisedPhase::kGivenUp;
  const std::string first = "planner Q1 on AIR is no longer restarted (signal 9)";
  expect_event(event_of(nullptr, report), LogLevel::kError, "health", first);
  expect_event(event_of(&before, report), LogLevel::kError, "health", first);
  before = report;
  EXPECT_FALSE(event_of(&before, report));
  report.processes[2].phase = SupervisedPhase::kGivenUp;
  expect_event(event_of(&before, report), LogLevel::kError, "health",
               "planner Q2 on AIR is no longer restarted (exit 1)");
}

TEST(HealthStory, ReportsOneBadSecondWithoutDuration) {
  HealthStory story;
  models::ProcessHealth health;
  health.process = "SIM";
  health.stamp.time = kTime - HealthStory::kWell;
  health.state = models::ProcessState::kDegraded;
  const auto begun = story.on(health);
  ASSERT_TRUE(begun);
  EXPECT_EQ(begun->time, kTime - HealthStory::kWell);
  EXPECT_EQ(begun->text, "SIM: degraded: drops, missed deadlines or other errors");
  health.state = models::ProcessState::kRunning;
  health.stamp.time = kTime - Duration{1};
  EXPECT_FALSE(story.on(health));
  health.stamp.time = kTime;
  expect_event(story.on(health), LogLevel::kInfo, "health", "SIM: recovered");
  EXPECT_FALSE(story.on(health)) << "reported only once";
  health.state = models::ProcessState::kStopping;
  expect_event(story.on(health), LogLevel::kInfo, "health", "SIM: is stopping");
  health.state = models::ProcessState::kRunning;
  EXPECT_FALSE(story.on(health)) << "the process was healthy when it stopped";
  HealthStory another;
  health.state = models::ProcessState::kStopping;
  expect_event(another.on(health), LogLevel::kInfo, "health", "SIM: is stopping");
}

TEST(HealthStory, ForgetsTroubleOfAnEndedRun) {
  for (const bool is_started_anew : {false, true}) {
    HealthStory story;
    models::ProcessHealth health;
    health.process = "SIM";
    health.stamp.time = kTime;
    health.state = models::ProcessState::kDegraded;
    EXPECT_TRUE(story.on(health));
    if (is_started_anew) {
      health.stamp.run_id = 9;
      health.state = models::ProcessState::kRunning;
      expect_event(story.on(health), LogLevel::kWarning, "health", "SIM: was restarted");
    } else {
      health.state = models::ProcessState::kStopping;
      EXPECT_TRUE(story.on(health));
    }
    health.state = models::ProcessState::kRunning;
    health.stamp.time += std::chrono::seconds(60);
    EXPECT_FALSE(story.on(health));
    health.state = models::ProcessState::kDegraded;
    EXPECT_TRUE(story.on(health)) << "another period begins";
  }
}

}  // namespace
}  // namespace vantage::logs::foxglove
