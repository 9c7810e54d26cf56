#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/scenario_yaml.hpp"
#include "logs/foxglove/scene.hpp"
#include "logs/foxglove/schema.hpp"
#include "logs/foxglove/stream.hpp"
#include "logs/foxglove/values.hpp"
#include "test/bus/sample_messages.hpp"

namespace vantage::logs::foxglove {
namespace {

/// Keeps all that it wants, which is everything unless told otherwise.
class Notebook : public Sink {
 public:
  struct Record {
    std::string topic;
    Time time;
    Json content;
  };
  bool wants(const std::string& topic, Schema schema, bool /*is_state*/) override {
    const auto [entry, is_new] = schemas.try_emplace(topic, schema);
    EXPECT_EQ(entry->second, schema) << topic << " has two schemas";
    return !refused.contains(topic);
  }
  void write(const std::string& topic, Time time, const Json& content) override {
    records.push_back({topic, time, content});
  }
  [[nodiscard]] std::vector<Json> of(const std::string& topic) const {
    std::vector<Json> out;
    for (const Record& record : records) {
      if (record.topic == topic) {
        out.push_back(record.content);
      }
    }
    return out;
  }

  std::map<std::string, Schema> schemas;
  std::set<std::string> refused;
  std::vector<Record> records;
};

/// What is wrong with `value` as an instance of `schema`; empty when nothing is.
std::string nonconformity(const Json& schema, const Json& value, const std::string& at) {
  const std::string type = schema.at("type");
  if (type == "object") {
    if (!value.is_object()) {
      return at + " is no object";
    }
    for (const auto& [key, member] : value.items()) {
      if (!schema.at("properties").contains(key)) {
        return at + "." + key + " is not in the schema";
      }
      const std::string wrong =
          nonconformity(schema.at("properties").at(key), member, at + "." + key);
      if (!wrong.empty()) {
        return wrong;
      }
    }
    return "";
  }
  if (type == "array") {
    if (!value.is_array()) {
      return at + " is no array";
    }
    for (const Json& element : value) {
      const std::string wrong = nonconformity(schema.at("items"), element, at + "[]");
      if (!wrong.empty()) {
        return wrong;
      }
    }
    return "";
  }
  const bool is_good =
      (type == "number" && value.is_number() && std::isfinite(value.get<double>())) ||
      (type == "integer" && value.is_number_integer()) || (type == "string" && value.is_string()) ||
      (type == "boolean" && value.is_boolean());
  return is_good ? "" : at + " is no " + type + ": " + value.dump();
}

models::Scenario lab() {
  return bus::load_scenario(std::string(VANTAGE_SOURCE_DIR) + "/config/lab.yaml");
}

models::ScenarioNotice lab_notice() {
  models::ScenarioNotice notice;
  notice.stamp.time = from_utime(1'000'000);
  notice.yaml = lab().source_text;
  notice.version = "test";
  notice.process = "trial";
  return notice;
}

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

template <class Message>
void feed_samples(Stream& stream, test::Sampler& sampler, int count) {
  for (int i = 0; i < count; ++i) {
    stream.on(test::sample<Message>(sampler), sampler.time());
  }
}

TEST(JsonSchema, DescribesEverythingThatAnyMessageBecomes) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), from_utime(1'000'000));
  test::Sampler sampler(7);
  feed_samples<models::MocapFrame>(stream, sampler, 20);
  feed_samples<models::TruthFrame>(stream, sampler, 20);
  feed_samples<models::DetectionSet>(stream, sampler, 20);
  feed_samples<models::RobotBelief>(stream, sampler, 20);
  feed_samples<models::RobotPlan>(stream, sampler, 20);
  feed_samples<models::TeamProposal>(stream, sampler, 20);
  feed_samples<models::VehicleStatus>(stream, sampler, 20);
  feed_samples<models::ProcessHealth>(stream, sampler, 20);
  feed_samples<models::ContactReport>(stream, sampler, 20);
  feed_samples<models::AttackNotice>(stream, sampler, 20);
  feed_samples<models::OperatorCommand>(stream, sampler, 20);
  models::DetectionSet looked = test::sample<models::DetectionSet>(sampler);
  looked.robot = "Q1";
  looked.detections.resize(1);
  looked.detections[0].measurement.z = Eigen::Vector2d(0.5, 0.1);
  stream.on(looked, sampler.time());

  std::set<Schema> met;
  for (const Notebook::Record& record : notebook.records) {
    const Schema schema = notebook.schemas.at(record.topic);
    met.insert(schema);
    ASSERT_EQ(nonconformity(Json::parse(json_schema(schema)), record.content, record.topic), "");
  }
  EXPECT_EQ(met.size(), std::size(kSchemas));
}

TEST(JsonSchema, HasAllMembersOfASceneEntityThatWeMake) {
  const Json made = entity("a", kWorldFrame, Time{}, false);
  const Json schema = Json::parse(json_schema(Schema::kSceneUpdate));
  const Json& entity_schema = schema["properties"]["entities"]["items"]["properties"];
  for (const auto& [key, unused] : entity_schema.items()) {
    EXPECT_TRUE(made.contains(key)) << key;
  }
  EXPECT_EQ(schema["title"], "foxglove.SceneUpdate");
}

TEST(ToJson, SplitsTimeIntoSecondsAndAPositiveRest) {
  EXPECT_EQ(to_json(from_utime(1'700'000'000'123'456)),
            Json({{"sec", 1'700'000'000}, {"nsec", 123'456'000}}));
  EXPECT_EQ(to_json(from_utime(-1)), Json({{"sec", -1}, {"nsec", 999'999'000}}));
}

TEST(Base64, IsThatOfTheRfc) {
  const std::pair<const char*, const char*> cases[] = {{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : cases) {
    const std::string text = plain;
    EXPECT_EQ(base64(std::vector<std::uint8_t>(text.begin(), text.end())), coded);
  }
}

TEST(Ellipse, HasEveryPointAtTheSameMahalanobisDistance) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Matrix2d g;
    g << uniform(rng), uniform(rng), uniform(rng), uniform(rng);
    PositionEstimate estimate;
    estimate.mean_m = Eigen::Vector2d(uniform(rng), uniform(rng));
    estimate.covariance_m2 = g * g.transpose() + 0.01 * Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d inverse = Eigen::Matrix2d(estimate.covariance_m2).inverse();
    for (const Eigen::Vector3d& point : ellipse(estimate, 12)) {
      const Eigen::Vector2d d = point.head<2>() - Eigen::Vector2d(estimate.mean_m);
      EXPECT_NEAR(d.dot(inverse * d), -2.0 * std::log(0.05), 1e-6);
    }
  }
}

TEST(PlanScene, BeginsAndEndsWhereTheTrajectoryDoes) {
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.trajectory.start = {1.0, 2.0, 0.5};
  plan.trajectory.height_m = 1.5;
  plan.trajectory.segments = {
      {{1.0, 1.0}, 0.7, 0.0}, {{1.0, -3.0}, 0.5, 0.0}, {{1.0, 0.0}, 0.5, 2.0}};
  const Json points = plan_scene(plan, std::nullopt)["entities"][0]["lines"][0]["points"];
  const Pose2 end = models::at(plan.trajectory, models::end_time(plan.trajectory)).world_from_body;
  EXPECT_EQ(points.front(), to_json(Eigen::Vector3d(1.0, 2.0, 1.5)));
  EXPECT_NEAR(points.back()["x"].get<double>(), end.x_m, 1e-6);
  EXPECT_NEAR(points.back()["y"].get<double>(), end.y_m, 1e-6);
}

TEST(MeasurementScene, DrawsToWhereTheTargetIsAndIgnoresAnotherSensorsNumbers) {
  const models::SensorModel sensor;  // range and bearing
  models::DetectionSet looked;
  looked.robot = "Q1";
  looked.viewpoint = {{1.0, 2.0, 0.3}, 1.5};
  models::PositionVector target(2);
  target << 3.0, 2.5;
  looked.detections.resize(2);
  looked.detections[0].measurement.z = models::observe(sensor, looked.viewpoint, target);
  looked.detections[1].measurement.z = models::MeasurementVector::Ones(1);
  const Json points = measurement_scene(looked, sensor, 2)["entities"][0]["lines"][0]["points"];
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0], to_json(Eigen::Vector3d(1.0, 2.0, 1.5)));
  EXPECT_NEAR(points[1]["x"].get<double>(), 3.0, 1e-9);
  EXPECT_NEAR(points[1]["y"].get<double>(), 2.5, 1e-9);
}

TEST(FrameTransforms, LeavesOutWhatIsNotSeen) {
  models::MocapFrame frame;
  frame.bodies = {{"Q1", {{1, 2, 3}, Eigen::Quaterniond::Identity()}, false}, {"Q2", {}, true}};
  const Json transforms = frame_transforms(frame)["transforms"];
  ASSERT_EQ(transforms.size(), 1U);
  EXPECT_EQ(transforms[0]["child_frame_id"], "Q1");
  EXPECT_EQ(transforms[0]["parent_frame_id"], "world");
  EXPECT_EQ(transforms[0]["translation"]["z"], 3.0);
}

TEST(VisibilityGrid, IsLittleEndianFloatsOfAge) {
  models::GridGeometry grid{{-1.0, -2.0}, 0.5, 2, 1};
  const Json made = visibility_grid(grid, {0, 1'000'000}, from_utime(3'500'000));
  // −1.0f = 00 00 80 BF, 2.5f = 00 00 20 40
  EXPECT_EQ(made["data"], base64(std::vector<std::uint8_t>{0, 0, 0x80, 0xBF, 0, 0, 0x20, 0x40}));
  EXPECT_EQ(made["row_stride"], 8);
  EXPECT_EQ(made["pose"]["position"]["y"], -2.0);
}

TEST(OccupancyGrid, SaysWhatTheTeamsLooksMake) {
  models::RobotMap map;
  map.grid = {{-1.0, -2.0}, 0.5, 3, 1};
  map.own_looks = {0, 0, 0};
  map.team_looks = {0, 9, -9};
  const Json made = occupancy_grid(map, {});
  // 0.5f, 1.0f and 0.0f
  EXPECT_EQ(made["data"],
            base64(std::vector<std::uint8_t>{0, 0, 0, 0x3F, 0, 0, 0x80, 0x3F, 0, 0, 0, 0}));
  EXPECT_EQ(made["fields"][0]["name"], "occupancy");
}

TEST(PlanJson, LeavesOutWhatIsNotFinite) {
  models::RobotPlan plan;
  plan.cost = std::nan("");
  plan.lower_bound = -std::numeric_limits<double>::infinity();
  plan.deadline = from_utime(2'000'000);
  plan.finish = from_utime(1'750'000);
  const Json made = plan_json(plan);
  EXPECT_FALSE(made.contains("cost_nat"));
  EXPECT_FALSE(made.contains("gap_nat"));
  EXPECT_DOUBLE_EQ(made["margin_s"].get<double>(), 0.25);
  plan.cost = 5.0;
  plan.lower_bound = 4.0;
  EXPECT_EQ(plan_json(plan)["gap_nat"], 1.0);
}

TEST(EventOf, SpeaksOfChangesOnly) {
  models::VehicleStatus calm;
  calm.robot = "Q1";
  calm.state = models::FlightState::kFollow;
  EXPECT_FALSE(event_of(nullptr, calm));
  models::VehicleStatus held = calm;
  held.state = models::FlightState::kHold;
  held.reasons = {"pose too old"};
  const auto event = event_of(&calm, held);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, "safety");
  EXPECT_EQ(event->text, "Q1: hold: pose too old");
  EXPECT_FALSE(event_of(&held, held));
  EXPECT_EQ(event_of(&held, calm)->level, LogLevel::kInfo);

  models::AttackNotice none;
  models::AttackNotice two{{}, {"Q2", "Q1"}};
  models::AttackNotice same{{}, {"Q1", "Q2"}};
  EXPECT_FALSE(event_of(nullptr, none));
  EXPECT_EQ(event_of(&none, two)->text, "jammed: Q1, Q2");
  EXPECT_FALSE(event_of(&two, same));
}

TEST(EventOf, TellsLateAndFallbackPlansFromGoodOnes) {
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.source = models::PlanSource::kSearched;
  EXPECT_FALSE(event_of(plan));
  plan.source = models::PlanSource::kBraking;
  EXPECT_EQ(event_of(plan)->kind, "fallback");
  plan.late = true;
  EXPECT_EQ(event_of(plan)->kind, "late");
}

TEST(Stream, MakesNothingThatNobodyWants) {
  Notebook notebook;
  notebook.refused = {"/transforms", "/world"};
  Stream stream(notebook);
  stream.on(lab_notice(), Time{});
  stream.on(models::MocapFrame{}, Time{});
  EXPECT_TRUE(notebook.of("/transforms").empty());
  EXPECT_TRUE(notebook.of("/world").empty());
  EXPECT_EQ(notebook.of("/robots").size(), 1U);
  EXPECT_TRUE(notebook.schemas.contains("/transforms")) << "but the topic is known";
}

TEST(Stream, PaintsAJammedSensorRedUntilItIsFree) {
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
  EXPECT_GT(red["r"].get<double>(), 4.0 * red["g"].get<double>());
  EXPECT_EQ(colour(scenes[0], 1), to_json(*robot_colour(lab(), "Q2")));
  EXPECT_EQ(colour(scenes[1], 0), to_json(*robot_colour(lab(), "Q1")));
  EXPECT_EQ(colour(scenes[2], 1), colour(scenes[0], 1));
}

TEST(RobotColour, IsOneForEachOfEightAndTheSameWhereverTheRobotIsDrawn) {
  models::Scenario eight = lab();
  eight.robots.resize(8);
  std::set<std::string> met;
  for (std::size_t i = 0; i < 8; ++i) {
    eight.robots[i].name = "Q" + std::to_string(8 - i);
  }
  for (const models::RobotSpec& robot : eight.robots) {
    met.insert(to_json(*robot_colour(eight, robot.name)).dump());
  }
  EXPECT_EQ(met.size(), 8U);
  EXPECT_FALSE(robot_colour(eight, "R1"));

  const models::Scenario scenario = lab();
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
  EXPECT_EQ(notebook.of("/plan/Q3").size(), 1U) << "drawn, though nobody knows its colour yet";
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

TEST(ProposalScene, LiesOnItsTrajectoriesAndLastsToTheEndOfTheRound) {
  const Time heard = from_utime(5'000'000);
  const models::TeamProposal proposal = proposal_of("Q2", from_utime(5'400'000));
  const models::Scenario scenario = lab();
  const Json made = proposal_scene(proposal, scenario, heard)["entities"][0];
  EXPECT_EQ(made["id"], "proposal/Q2");
  EXPECT_EQ(made["timestamp"], to_json(heard));
  EXPECT_EQ(made["lifetime"], to_json(from_seconds(0.4)));
  ASSERT_EQ(made["lines"].size(), 2U);
  const Json& lines = made["lines"][0];
  EXPECT_EQ(lines["color"]["r"], robot_colour(scenario, "Q2")->r);
  ASSERT_EQ(lines["type"], 2);
  // On the circle about (0.5 − 2.5 sin 0.3, 2.5 cos 0.3), v / ω = 2.5 m.
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
  EXPECT_NEAR(drawn_m, 1.5, 0.25) << "half of its 3 m, to a dash";
}

TEST(ProposalScene, FillsTheGapsOfTheNextRobotsWhereTheyAgree) {
  const models::Scenario scenario = lab();
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

TEST(Stream, ShowsProposalsThatComeBeforeTheEndOfTheirRound) {
  Notebook notebook;
  Stream stream(notebook);
  const Time end = from_utime(2'000'000);
  stream.on(proposal_of("Q1", end), from_utime(1'000'000));  // of a team that nobody knows yet
  stream.on(lab_notice(), from_utime(1'000'000));
  stream.on(proposal_of("stranger", end), from_utime(1'000'000));
  stream.on(proposal_of("Q1", end), end);
  EXPECT_TRUE(notebook.of("/proposal/Q1").empty());
  stream.on(proposal_of("Q1", end), from_utime(1'999'999));
  EXPECT_EQ(notebook.of("/proposal/Q1").size(), 1U);
}

TEST(Stream, ShowsTheBestInformedRobotAndTakesAwayWhatIsForgotten) {
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

TEST(Stream, MovesBodiesByTheTruthWhereNoMocapIsHeard) {
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
  EXPECT_EQ(notebook.of("/transforms").size(), 2U) << "the mocap's, not the truth's";
  EXPECT_EQ(notebook.of("/truth/transforms").size(), 2U);
}

TEST(Stream, CountsAScenarioThatItCannotRead) {
  Notebook notebook;
  Stream stream(notebook);
  models::ScenarioNotice notice;
  notice.yaml = "name: [";
  stream.on(notice, Time{});
  EXPECT_EQ(stream.scenarios_refused(), 1);
  EXPECT_EQ(notebook.of("/events").size(), 1U);
  EXPECT_TRUE(notebook.of("/scenario").empty());
}

}  // namespace
}  // namespace vantage::logs::foxglove
