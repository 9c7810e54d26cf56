#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/foxglove/scene.hpp"
#include "logs/foxglove/schema.hpp"
#include "logs/foxglove/stream.hpp"
#include "logs/foxglove/values.hpp"
#include "test/bus/convert/sample_messages.hpp"
#include "test/logs/foxglove_notebook.hpp"

namespace vantage::logs::foxglove {
namespace {

/// Returns how `value` violates `schema`; empty if it conforms.
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

template <class Message>
void feed_samples(Stream& stream, test::Sampler& sampler, int count) {
  for (int i = 0; i < count; ++i) {
    stream.on(test::sample<Message>(sampler), sampler.time());
  }
}

TEST(JsonSchema, DescribesEveryMessage) {
  Notebook notebook;
  Stream stream(notebook);
  stream.on(lab_notice(), from_utime(1'000'000));
  test::Sampler sampler(7);
  feed_samples<models::MocapFrame>(stream, sampler, 20);
  feed_samples<models::TruthFrame>(stream, sampler, 20);
  feed_samples<models::RobotMeasurement>(stream, sampler, 20);
  feed_samples<models::RobotBelief>(stream, sampler, 20);
  feed_samples<models::RobotPlan>(stream, sampler, 20);
  feed_samples<models::TeamProposal>(stream, sampler, 20);
  feed_samples<models::VehicleStatus>(stream, sampler, 20);
  feed_samples<models::ProcessHealth>(stream, sampler, 20);
  feed_samples<models::CollisionReport>(stream, sampler, 20);
  feed_samples<models::AttackNotice>(stream, sampler, 20);
  feed_samples<models::OperatorCommand>(stream, sampler, 20);
  models::RobotMeasurement looked = test::sample<models::RobotMeasurement>(sampler);
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
  EXPECT_EQ(met.size(), std::size(kSchemas) - 1)
      << "all but raw messages, which have a separate publisher";
}

TEST(JsonSchema, ContainsAllUsedSceneEntityMembers) {
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

TEST(Base64, MatchesTheRfc) {
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

TEST(Ellipse, HasConstantMahalanobisDistance) {
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

TEST(PlanScene, HasTheTrajectorysEnds) {
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

TEST(MeasurementScene, DrawsALineToTheTargetAndIgnoresOtherSensors) {
  const models::SensorModel sensor;  // range and bearing
  models::RobotMeasurement looked;
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

TEST(FrameTransforms, OmitsUnseenBodies) {
  models::MocapFrame frame;
  frame.bodies = {{"Q1", {{1, 2, 3}, Eigen::Quaterniond::Identity()}, false}, {"Q2", {}, true}};
  const Json transforms = frame_transforms(frame)["transforms"];
  ASSERT_EQ(transforms.size(), 1U);
  EXPECT_EQ(transforms[0]["child_frame_id"], "Q1");
  EXPECT_EQ(transforms[0]["parent_frame_id"], "world");
  EXPECT_EQ(transforms[0]["translation"]["z"], 3.0);
}

TEST(VisibilityGrid, ContainsLittleEndianAges) {
  models::GridGeometry grid{{-1.0, -2.0}, 0.5, 2, 1};
  const Json made = visibility_grid(grid, {0, 1'000'000}, from_utime(3'500'000));
  // −1.0f = 00 00 80 BF, 2.5f = 00 00 20 40
  EXPECT_EQ(made["data"], base64(std::vector<std::uint8_t>{0, 0, 0x80, 0xBF, 0, 0, 0x20, 0x40}));
  EXPECT_EQ(made["row_stride"], 8);
  EXPECT_EQ(made["pose"]["position"]["y"], -2.0);
}

TEST(OccupancyGrid, ShowsTheTeamsMap) {
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

TEST(PlanJson, OmitsNonFiniteValues) {
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

TEST(EventOf, ReportsChangesOnly) {
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

models::ProcessHealth health_at(int at_s, models::ProcessState state) {
  models::ProcessHealth health;
  health.process = "PLANNER_Q1";
  health.stamp.time = from_utime(std::int64_t{1'000'000} * at_s);
  health.state = state;
  return health;
}

TEST(HealthStory, ReportsStartAndEndOfTrouble) {
  using models::ProcessState;
  HealthStory story;
  EXPECT_FALSE(story.on(health_at(9, ProcessState::kRunning)));
  const auto begun = story.on(health_at(10, ProcessState::kDegraded));
  ASSERT_TRUE(begun);
  EXPECT_EQ(begun->level, LogLevel::kWarning);
  for (int at_s = 11; at_s <= 40; ++at_s) {  // alternately, once per second
    EXPECT_FALSE(story.on(
        health_at(at_s, at_s % 2 == 0 ? ProcessState::kDegraded : ProcessState::kRunning)));
  }
  for (int at_s = 41; at_s <= 44; ++at_s) {
    EXPECT_FALSE(story.on(health_at(at_s, ProcessState::kRunning)));
  }
  const auto over = story.on(health_at(45, ProcessState::kRunning));
  ASSERT_TRUE(over);
  EXPECT_EQ(over->level, LogLevel::kInfo);
  EXPECT_EQ(over->text, "PLANNER_Q1: recovered after 30 s");
  EXPECT_FALSE(story.on(health_at(46, ProcessState::kRunning)));
  EXPECT_TRUE(story.on(health_at(47, ProcessState::kDegraded))) << "another period of trouble";
}

TEST(HealthStory, ReportsAStopAndARestartOnce) {
  using models::ProcessState;
  HealthStory story;
  EXPECT_TRUE(story.on(health_at(10, ProcessState::kDegraded)));
  EXPECT_EQ(story.on(health_at(11, ProcessState::kStopping))->text, "PLANNER_Q1: is stopping");
  EXPECT_FALSE(story.on(health_at(12, ProcessState::kStopping)));
  models::ProcessHealth anew = health_at(13, ProcessState::kRunning);
  anew.stamp.run_id = 7;
  EXPECT_EQ(story.on(anew)->text, "PLANNER_Q1: was restarted");
  anew.stamp.time += std::chrono::seconds(20);
  EXPECT_FALSE(story.on(anew)) << "the trouble belongs to another run";
}

TEST(EventOf, DistinguishesLateAndFallbackPlans) {
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.source = models::PlanSource::kSearched;
  EXPECT_FALSE(event_of(plan));
  plan.source = models::PlanSource::kBraking;
  EXPECT_EQ(event_of(plan)->kind, "fallback");
  plan.late = true;
  plan.round = 1'795'370'327;
  EXPECT_EQ(event_of(plan)->kind, "late");
  EXPECT_NE(event_of(plan)->text.find("round 70327 "), std::string::npos)
      << "the same text as in the terminal";
}

}  // namespace
}  // namespace vantage::logs::foxglove
