#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/foxglove/scene.hpp"
#include "logs/foxglove/stream.hpp"
#include "logs/foxglove/values.hpp"
#include "test/logs/foxglove_notebook.hpp"

namespace vantage::logs::foxglove {
namespace {

models::TargetBelief known(int id, double x_m, double y_m, double sigma_m) {
  models::TargetBelief belief;
  belief.target_id = id;
  belief.information.matrix = Eigen::Matrix2d::Identity() / (sigma_m * sigma_m);
  belief.information.vector = belief.information.matrix * Eigen::Vector2d(x_m, y_m);
  return belief;
}

models::RobotBelief belief_of(const std::string& robot, std::int64_t step,
                              std::vector<models::TargetBelief> targets) {
  models::RobotBelief belief;
  belief.robot = robot;
  belief.step = step;
  belief.stamp.time = from_utime(1'000'000 + 500'000 * step);
  belief.targets = std::move(targets);
  return belief;
}

TEST(Stream, PublishesOnlySubscribedTopics) {
  Notebook notebook;
  notebook.refused = {"/transforms", "/world"};
  Stream stream(notebook);
  stream.on(lab_notice(), Time{});
  stream.on(models::MocapFrame{}, Time{});
  EXPECT_TRUE(notebook.of("/transforms").empty());
  EXPECT_TRUE(notebook.of("/world").empty());
  EXPECT_EQ(notebook.of("/robots").size(), 1U);
  EXPECT_TRUE(notebook.schemas.contains("/transforms")) << "but the topic is advertised";
}

TEST(Stream, ColoursAJammedSensorRed) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), Time{});
  stream.on(models::AttackNotice{{}, {"Q2"}}, Time{});
  stream.on(models::AttackNotice{{}, {"Q2"}}, Time{});
  stream.on(models::AttackNotice{{}, {}}, Time{});
  const std::vector<Json> scenes = notebook.of("/robots");
  ASSERT_EQ(scenes.size(), 3U);
  const auto colour = [](const Json& scene, std::size_t robot) {
    return scene["entities"][robot]["cylinders"][0]["color"];
  };
  const Json red = colour(scenes[1], 1);
  EXPECT_GT(red["r"].get<double>(), 3.0 * red["g"].get<double>());
  EXPECT_EQ(colour(scenes[0], 1), to_json(*robot_colour(lab(), "Q2")));
  EXPECT_EQ(colour(scenes[1], 0), to_json(*robot_colour(lab(), "Q1")));
  EXPECT_EQ(colour(scenes[2], 1), colour(scenes[0], 1));
}

TEST(RobotColour, IsUniqueForEightRobotsAndConsistent) {
  scenario::Scenario eight = lab();
  eight.robots.resize(8);
  std::set<std::string> met;
  for (std::size_t i = 0; i < 8; ++i) {
    eight.robots[i].name = "Q" + std::to_string(8 - i);
  }
  for (const scenario::RobotSpec& robot : eight.robots) {
    met.insert(to_json(*robot_colour(eight, robot.name)).dump());
  }
  EXPECT_EQ(met.size(), 8U);
  EXPECT_FALSE(robot_colour(eight, "R1"));

  const scenario::Scenario scenario = lab();
  const Json colour = to_json(*robot_colour(scenario, "Q3"));
  EXPECT_EQ(scenario_json(lab_notice(), scenario)["robots"][2]["color"], colour);
  EXPECT_EQ(robots_scene(scenario, {}, Time{})["entities"][2]["cylinders"][0]["color"], colour);
  const auto opaque = [](Json drawn) {
    drawn["a"] = 1.0;
    return drawn;
  };
  Notebook notebook;
  Stream stream(notebook);
  models::RobotPlan plan;
  plan.robot = "Q3";
  plan.source = models::PlanSource::kSearched;
  stream.on(plan, Time{});
  EXPECT_EQ(notebook.of("/plan/Q3").size(), 1U) << "drawn before its colour is known";
  stream.on(lab_notice(), Time{});
  stream.on(plan, Time{});
  models::MocapFrame frame;
  frame.bodies = {{"Q3", {{1, 2, 3}, Eigen::Quaterniond::Identity()}, false}};
  stream.on(frame, Time{});
  for (const char* topic : {"/plan/Q3", "/tracks"}) {
    const Json line = notebook.of(topic).back()["entities"][0]["lines"][0];
    EXPECT_EQ(opaque(line["color"]), colour) << topic;
  }
  const Json view = notebook.of("/views").at(0)["entities"][2]["lines"][0];
  EXPECT_EQ(opaque(view["color"]), colour);
}

models::TeamProposal proposal_of(const std::string& robot, Time end_of_round) {
  models::TeamProposal proposal;
  proposal.robot = robot;
  proposal.stamp.time = end_of_round;
  for (const char* mover : {"Q1", "Q2"}) {
    models::Trajectory way{end_of_round, {0.5, 0.0, 0.3}, 1.5, {{{1.0, 0.4}, 3.0, 0.0}}};
    proposal.choices.push_back({mover, way, 1.0, 0.1});
  }
  return proposal;
}

TEST(ProposalScene, FollowsTrajectoriesUntilTheEndOfTheRound) {
  const Time received_at = from_utime(5'000'000);
  const models::TeamProposal proposal = proposal_of("Q2", from_utime(5'400'000));
  const scenario::Scenario scenario = lab();
  const Json made = proposal_scene(proposal, scenario, received_at)["entities"][0];
  EXPECT_EQ(made["id"], "proposal/Q2");
  EXPECT_EQ(made["timestamp"], to_json(received_at));
  EXPECT_EQ(made["lifetime"], to_json(from_seconds(0.4)));
  ASSERT_EQ(made["lines"].size(), 2U);
  const Json& lines = made["lines"][0];
  EXPECT_EQ(lines["color"]["r"], robot_colour(scenario, "Q2")->r);
  ASSERT_EQ(lines["type"], 2);
  // The path is an arc about (0.5 − 2.5 sin 0.3, 2.5 cos 0.3) with the radius v / ω = 2.5 m.
  const Eigen::Vector2d centre(0.5 - 2.5 * std::sin(0.3), 2.5 * std::cos(0.3));
  double drawn_m = 0.0;
  for (std::size_t i = 0; i < lines["points"].size(); i += 2) {
    const auto at = [&](std::size_t k) {
      return Eigen::Vector2d(lines["points"][k]["x"].get<double>(),
                             lines["points"][k]["y"].get<double>());
    };
    EXPECT_NEAR((at(i) - centre).norm(), 2.5, 1e-6);
    drawn_m += (at(i + 1) - at(i)).norm();
  }
  EXPECT_NEAR(drawn_m, 1.5, 0.25) << "half of its 3 m, within one dash";
}

TEST(ProposalScene, DrawsEqualProposalsWithComplementaryDashes) {
  const scenario::Scenario scenario = lab();
  std::set<std::string> begins;
  std::size_t dashes = 0;
  for (const char* robot : {"Q1", "Q2"}) {
    const models::TeamProposal proposal = proposal_of(robot, from_utime(1));
    const Json scene = proposal_scene(proposal, scenario, Time{});
    const Json points = scene["entities"][0]["lines"][0]["points"];
    for (std::size_t i = 0; i < points.size(); i += 2, ++dashes) {
      begins.insert(points[i].dump());
    }
  }
  EXPECT_EQ(begins.size(), dashes);
  EXPECT_EQ(dashes, 15U);
}

TEST(Stream, ShowsProposalsOfTheCurrentRound) {
  Notebook notebook;
  Stream stream(notebook);
  const Time end = from_utime(2'000'000);
  stream.on(proposal_of("Q1", end), from_utime(1'000'000));  // before the scenario notice
  stream.on(lab_notice(), from_utime(1'000'000));
  stream.on(proposal_of("stranger", end), from_utime(1'000'000));
  stream.on(proposal_of("Q1", end), end);
  EXPECT_TRUE(notebook.of("/proposal/Q1").empty());
  stream.on(proposal_of("Q1", end), from_utime(1'999'999));
  EXPECT_EQ(notebook.of("/proposal/Q1").size(), 1U);
}

TEST(Stream, ShowsTheBestBeliefAndRemovesForgottenTargets) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), Time{});
  stream.on(belief_of("Q1", 0, {known(0, 1.0, 0.0, 0.5), known(3, 0.0, 0.0, 0.5)}), Time{});
  stream.on(belief_of("Q2", 0, {known(0, 2.0, 0.0, 0.2)}), Time{});
  stream.on(models::TruthFrame{}, Time{});
  stream.on(belief_of("Q1", 1, {known(0, 1.0, 0.0, 0.5)}), Time{});
  stream.on(models::TruthFrame{}, Time{});
  const std::vector<Json> scenes = notebook.of("/estimates");
  ASSERT_EQ(scenes.size(), 2U);
  const Json& best = scenes[0]["entities"][0];
  EXPECT_EQ(best["id"], "estimate/R1");
  EXPECT_EQ(best["metadata"][1]["value"], "Q2");
  EXPECT_EQ(scenes[0]["entities"].size(), 2U);
  EXPECT_EQ(scenes[1]["entities"].size(), 1U);
  std::set<std::string> deleted;
  for (const Json& deletion : scenes[1]["deletions"]) {
    deleted.insert(deletion["id"].get<std::string>());
  }
  EXPECT_EQ(deleted,
            (std::set<std::string>{"estimate/R2", "estimate/R3", "estimate/R4", "estimate/R5"}));
}

// Removed labels cannot be listed, so a track that is not published again expires after one and a
// half steps.
TEST(Stream, ShowsATrackWhileItIsPublished) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), Time{});
  stream.on(belief_of("Q1", 0,
                      {known(0, 1.0, 0.0, 0.5), known(models::kTrackLabelMin + 31, 1.0, 0.0, 0.5)}),
            Time{});
  stream.on(models::TruthFrame{}, Time{});
  const Json entities = notebook.of("/estimates").at(0)["entities"];
  ASSERT_EQ(entities.size(), 2U);
  EXPECT_EQ(entities[0]["lifetime"], to_json(Duration{0}));
  EXPECT_EQ(entities[1]["id"], "estimate/track 1f");
  EXPECT_EQ(entities[1]["lifetime"], to_json(from_seconds(0.75)));
}

TEST(Stream, MovesBodiesByTruthWithoutMocap) {
  Notebook notebook;
  Stream stream(notebook);
  models::TruthFrame truth;
  truth.bodies.push_back({"Q1", -1, {}, Eigen::Vector3d::Zero()});
  stream.on(truth, Time{});
  ASSERT_EQ(notebook.of("/transforms").size(), 1U);
  EXPECT_EQ(notebook.of("/transforms")[0]["transforms"][0]["child_frame_id"], "Q1");
  EXPECT_EQ(notebook.of("/truth/transforms")[0]["transforms"][0]["child_frame_id"], "truth/Q1");
  stream.on(models::MocapFrame{}, Time{});
  stream.on(truth, Time{});
  EXPECT_EQ(notebook.of("/transforms").size(), 2U) << "from mocap, not from the truth";
  EXPECT_EQ(notebook.of("/truth/transforms").size(), 2U);
}

// A measurement at 1.0 s enters a belief, which enters the plan of round 7, which the vehicle
// follows at 2.5 s.
TEST(Stream, PublishesTheAgeOfTheMeasurementBehindEachAction) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), Time{});
  models::RobotMeasurement look;
  look.robot = "Q1";
  look.stamp = {from_utime(1'000'000), 11, 3};
  stream.on(look, Time{});
  models::RobotBelief belief = belief_of("Q2", 0, {});  // Q2 received the measurement
  belief.stamp.run_id = 12;
  belief.stamp.sequence = 5;
  belief.inputs = {{"MEASUREMENT_Q1", 11, 2}, {"MEASUREMENT_Q1", 11, 3}};
  stream.on(belief, Time{});
  models::RobotPlan plan;
  plan.robot = "Q2";
  plan.round = 7;
  plan.inputs = {{"BELIEF_Q2", 12, 5}};
  stream.on(plan, Time{});
  const auto latency_s = [&](double time_s, std::int64_t round) {
    models::VehicleStatus status;
    status.robot = "Q2";
    status.stamp.time = from_utime(0) + from_seconds(time_s);
    status.plan_round = round;
    stream.on(status, Time{});
    const Json values = notebook.of("/vehicle/Q2").back();
    return values.value("capture_to_setpoint_s", -1.0);
  };
  EXPECT_EQ(latency_s(2.4, 6), -1.0) << "the start of the plan is unknown";
  EXPECT_NEAR(latency_s(2.5, 7), 1.5, 1e-9);
  EXPECT_NEAR(latency_s(2.6, 7), 1.5, 1e-9) << "while it follows the plan";
  EXPECT_EQ(latency_s(3.5, 8), -1.0) << "the inputs of the plan are unknown";
}

TEST(Stream, ReportsUnreadableScenarios) {
  Notebook notebook;
  Stream stream(notebook);
  models::ScenarioNotice notice;
  notice.yaml = "name: [";
  stream.on(notice, Time{});
  EXPECT_EQ(notebook.of("/events").size(), 1U);
  EXPECT_TRUE(notebook.of("/scenario").empty());
}

TEST(Stream, PublishesAScenarioOnceAndRestartsWithAnother) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), from_utime(7));
  stream.on(belief_of("Q1", 100, {known(0, 1.0, 0.0, 0.5)}), from_utime(8));
  stream.on(models::CollisionReport{}, from_utime(8));
  stream.on(lab_notice(), from_utime(9));
  for (const char* topic : {"/scenario", "/world", "/targets", "/robots", "/views"}) {
    EXPECT_EQ(notebook.of(topic).size(), 1U) << topic;
  }
  models::ScenarioNotice other = lab_notice();
  other.yaml += "\n";
  stream.on(other, from_utime(10));
  for (const char* topic : {"/scenario", "/world", "/targets", "/robots", "/views"}) {
    ASSERT_EQ(notebook.of(topic).size(), 2U) << topic;
  }
  EXPECT_EQ(notebook.of("/world").at(0).at("entities")[0].at("timestamp"),
            to_json(lab_notice().stamp.time));
  EXPECT_EQ(notebook.records.front().time, from_utime(7)) << "reception time";
  // After the new scenario the step count restarts and the metrics are reset.
  const std::size_t count_before = notebook.of("/team").size();
  stream.on(belief_of("Q1", 95, {}), from_utime(11));
  ASSERT_EQ(notebook.of("/team").size(), count_before + 1);
  EXPECT_EQ(notebook.of("/team").back().at("separation_violations"), 0);
  stream.on(models::TruthFrame{}, from_utime(12));
  for (const Json& scene : notebook.of("/estimates")) {
    EXPECT_TRUE(scene.at("entities").empty()) << "bodies of the other scenario";
  }
}

TEST(Stream, PublishesTeamMetricsAtEachStep) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), Time{});
  const auto published_after = [&](const std::string& robot, std::int64_t step) {
    const std::size_t before = notebook.of("/team").size();
    stream.on(belief_of(robot, step, {}), Time{});
    return notebook.of("/team").size() - before;
  };
  EXPECT_EQ(published_after("Q1", 20), 1U);
  EXPECT_EQ(published_after("Q2", 20), 0U);
  EXPECT_EQ(published_after("Q1", 21), 1U);
  EXPECT_EQ(published_after("Q2", 20), 0U) << "late message";
  EXPECT_EQ(published_after("Q2", 11), 0U) << "later message";
  EXPECT_EQ(published_after("Q2", 10), 1U) << "restarted";
  EXPECT_EQ(published_after("Q1", 11), 1U);
  EXPECT_EQ(notebook.of("/team").back().at("timestamp"), to_json(from_utime(6'500'000)));
}

// The published error is that of the newest evaluated step, two steps before the current one.
TEST(Stream, PublishesEstimationErrors) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), from_utime(1'000'000));
  for (std::int64_t step = 0; step <= 2; ++step) {
    models::TruthFrame truth;
    truth.stamp.time = from_utime(1'000'000 + 500'000 * step);
    truth.bodies = {{"R2", 1, {{1.0, 2.0, 0.0}, Quaternion::Identity()}, Eigen::Vector3d::Zero()}};
    stream.on(truth, Time{});
    stream.on(belief_of("Q1", step, {known(1, 4.0, 6.0, 0.5), known(3, 0.0, 0.0, 0.5)}), Time{});
  }
  stream.on(models::MocapFrame{}, Time{});
  const Json entities = notebook.of("/estimates").back().at("entities");
  ASSERT_EQ(entities.size(), 2U);
  const auto error_of = [&](std::size_t i) -> std::string {
    for (const Json& each : entities[i].at("metadata")) {
      if (each.at("key") == "error_m") {
        return each.at("value");
      }
    }
    return "unknown";
  };
  EXPECT_EQ(error_of(0), "5.000");
  EXPECT_EQ(error_of(1), "unknown");
  const Json own = notebook.of("/belief/Q1").back().at("entities");
  ASSERT_EQ(own.size(), 2U);
  EXPECT_EQ(own[1].at("id"), "belief/Q1/R4");
}

TEST(Stream, NamesTargetsAndTracks) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), Time{});
  stream.on(belief_of("Q1", 0,
                      {known(4, 1.0, 0.0, 0.5), known(77, 1.0, 0.0, 0.5),
                       known(models::kTrackLabelMin, 1.0, 0.0, 0.5)}),
            Time{});
  const Json scene = notebook.of("/belief/Q1").at(0);
  std::set<std::string> ids;
  for (const Json& entity : scene.at("entities")) {
    ids.insert(entity.at("id").get<std::string>());
  }
  EXPECT_EQ(ids,
            (std::set<std::string>{"belief/Q1/R5", "belief/Q1/target 77", "belief/Q1/track 0"}));
  EXPECT_EQ(scene.at("deletions").size(), 4U);
}

TEST(Stream, PublishesNoAgeWithoutAMeasurement) {
  Notebook notebook;
  Stream stream(notebook);
  models::RobotMeasurement look;
  look.robot = "Q1";
  look.stamp = {from_utime(1'000'000), 1, 3};
  stream.on(look, Time{});
  models::RobotBelief belief = belief_of("Q1", 0, {});
  belief.stamp.run_id = 2;
  belief.stamp.sequence = 5;
  belief.inputs = {{"MEASUREMENT_Q1", 1, 3}};
  stream.on(belief, Time{});
  models::RobotPlan plan;
  plan.robot = "Q1";
  for (plan.round = 7; plan.round <= 8; ++plan.round) {
    plan.inputs = {{"BELIEF_Q1", 2, plan.round == 7 ? 5 : 6}};  // message 6 is missing
    stream.on(plan, Time{});
  }
  const auto is_told = [&](const std::string& robot, std::int64_t round) {
    models::VehicleStatus status;
    status.robot = robot;
    status.stamp.time = from_utime(2'000'000);
    status.plan_round = round;
    stream.on(status, Time{});
    return notebook.of("/vehicle/" + robot).back().contains("capture_to_setpoint_s");
  };
  EXPECT_FALSE(is_told("Q1", 7)) << "the vehicle may have followed this plan for long";
  EXPECT_FALSE(is_told("Q1", 8));
  EXPECT_TRUE(is_told("Q1", 7));
  EXPECT_FALSE(is_told("Q2", 6));
  EXPECT_FALSE(is_told("Q2", 7)) << "its plans were not received";
}

TEST(Stream, KeepsTheInputsOfTheNewestSixteenPlans) {
  Notebook notebook;
  Stream stream(notebook);
  for (std::int64_t round = 0; round < 17; ++round) {
    models::RobotMeasurement look;
    look.robot = "Q1";
    look.stamp = {from_utime(1'000'000 * round), 1, round};
    stream.on(look, Time{});
    models::RobotBelief belief = belief_of("Q1", round, {});
    belief.stamp.run_id = 2;
    belief.stamp.sequence = round;
    belief.inputs = {{"MEASUREMENT_Q1", 1, round}};
    stream.on(belief, Time{});
    models::RobotPlan plan;
    plan.robot = "Q1";
    plan.round = round;
    plan.inputs = {{"BELIEF_Q1", 2, round}};
    stream.on(plan, Time{});
  }
  const auto latency_s = [&](std::int64_t round) {
    models::VehicleStatus status;
    status.robot = "Q1";
    status.stamp.time = from_utime(20'000'000);
    status.plan_round = round;
    stream.on(status, Time{});
    return notebook.of("/vehicle/Q1").back().value("capture_to_setpoint_s", -1.0);
  };
  EXPECT_EQ(latency_s(-1), -1.0);
  EXPECT_EQ(latency_s(1), 19.0);
  EXPECT_EQ(latency_s(16), 4.0);
  EXPECT_EQ(latency_s(0), -1.0) << "the seventeenth plan";
}

// The /team metrics cover all messages since the scenario notice.
TEST(Stream, PassesEveryMessageKindToTheMetrics) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), Time{});
  models::CollisionReport contact;
  contact.kind = models::CollisionKind::kCollision;
  stream.on(contact, Time{});
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.late = true;
  stream.on(plan, Time{});
  models::ProcessHealth health;
  health.counters = {{"VICON.lost", 5}};
  stream.on(health, Time{});
  models::RobotMap map;
  map.robot = "Q1";
  map.grid = {{0.0, 0.0}, 1.0, 1, 1};
  map.own_looks = map.team_looks = {3};
  map.entropy_nats = 7.5;
  stream.on(map, Time{});
  stream.on(belief_of("Q1", 1, {}), Time{});
  const Json team = notebook.of("/team").at(0);
  EXPECT_EQ(team.at("collisions"), 1);
  EXPECT_EQ(team.at("rounds_late"), 1);
  EXPECT_EQ(team.at("messages_lost"), 5);
  EXPECT_EQ(team.at("map_entropy_nats"), 7.5);
}

TEST(Stream, DrawsMeasurementsOfTheScenariosRobots) {
  Notebook notebook;
  Stream stream(notebook);
  models::RobotMeasurement look;
  look.robot = "Q1";
  stream.on(look, Time{});
  stream.on(lab_notice(), Time{});
  look.detections.resize(1);
  look.detections[0].measurement.z = Eigen::Vector2d(0.5, 0.1);
  stream.on(look, Time{});
  look.robot = "stranger";
  stream.on(look, Time{});
  ASSERT_EQ(notebook.of("/measurement/Q1").size(), 1U);
  EXPECT_EQ(notebook.of("/measurement/Q1")[0].at("entities")[0].at("lines")[0].at("points").size(),
            2U);
  EXPECT_FALSE(notebook.schemas.contains("/measurement/stranger"));
}

}  // namespace
}  // namespace vantage::logs::foxglove
