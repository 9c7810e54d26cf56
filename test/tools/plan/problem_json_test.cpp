#include "tools/plan/problem_json.hpp"

#include <fstream>
#include <functional>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"

namespace vantage::tools {
namespace {

using nlohmann::json;

json file(const std::string& name) {
  std::ifstream stream(VANTAGE_SOURCE_DIR "/test/tools/problems/" + name);
  return json::parse(stream);
}

PlanningProblem parse(const json& document) { return parse_problem(document.dump(), "p.json"); }

/// What the reader says of `text`; "" when it has nothing against it.
std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(parse_problem(text, "p.json"));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

TEST(ParseProblem, ReadsEveryFieldOfATrackingProblem) {
  const PlanningProblem read = parse(file("tracking.json"));
  const planner::SearchProblem& p = read.problem;
  EXPECT_EQ(read.name, "two rovers");
  EXPECT_EQ(read.world->bounds.min_m, Eigen::Vector2d(-20, -20));
  EXPECT_EQ(read.world->bounds.max_m, Eigen::Vector2d(20, 20));
  ASSERT_EQ(read.world->obstacles.size(), 1U);
  EXPECT_EQ(read.world->obstacles[0].footprint.min_m, Eigen::Vector2d(2, 1));
  EXPECT_EQ(read.world->obstacles[0].footprint.max_m, Eigen::Vector2d(3, 4));
  EXPECT_EQ(p.world, read.world.get());
  EXPECT_EQ(p.field, read.field.get());
  EXPECT_DOUBLE_EQ(p.field->geometry().resolution_m, 0.2);
  EXPECT_EQ(p.start, (Pose2{0.0, -0.5, 0.4}));
  EXPECT_DOUBLE_EQ(p.step_s, 0.5);
  EXPECT_EQ(p.controls, models::standard_primitives());
  EXPECT_EQ(p.horizon_steps, 8);
  EXPECT_EQ(p.cost, planner::CostKind::kLogDet);
  ASSERT_EQ(p.targets.size(), 3U);
  EXPECT_EQ(p.targets[1].model.kind, models::TargetKind::kDoubleIntegrator);
  EXPECT_DOUBLE_EQ(p.targets[1].model.q, 0.001);
  EXPECT_TRUE(p.targets[1].prior.mean.isApprox(Eigen::Vector4d(-4, 9, 0.1, -0.4)));
  const Eigen::Matrix4d covariance = Eigen::Vector4d(1, 0.5, 0.1, 0.2).asDiagonal();
  EXPECT_TRUE(p.targets[1].prior.covariance.isApprox(covariance));
  ASSERT_EQ(p.sensors.size(), 1U);
  EXPECT_EQ(p.sensors[0].kind, models::SensorKind::kRangeBearing);
  EXPECT_DOUBLE_EQ(p.sensors[0].range_max_m, 8.0);
  EXPECT_DOUBLE_EQ(p.sensors[0].range_sigma_m, 0.15);
  EXPECT_DOUBLE_EQ(p.sensors[0].bearing_sigma_rad, radians(5.0));
  EXPECT_FALSE(p.sensors[0].variance_grows_with_range);
  EXPECT_DOUBLE_EQ(p.clearance_m, 0.0);
  EXPECT_TRUE(p.teammates.empty());
}

TEST(ParseProblem, TakesTheFieldOfViewAsTheFullAngle) {
  const PlanningProblem read = parse(file("tracking.json"));
  const models::SensorModel& sensor = read.problem.sensors[0];
  EXPECT_DOUBLE_EQ(sensor.fov_rad, radians(94.0));
  const models::Viewpoint at{{0.0, 0.0, 0.0}, 0.0};
  const auto towards = [](double bearing_deg) {
    const double b = radians(bearing_deg);
    return models::PositionVector(Eigen::Vector2d(3.0 * std::cos(b), 3.0 * std::sin(b)));
  };
  EXPECT_TRUE(models::in_view(sensor, at, towards(46.9)));
  EXPECT_TRUE(models::in_view(sensor, at, towards(-46.9)));
  EXPECT_FALSE(models::in_view(sensor, at, towards(47.1)));
  EXPECT_FALSE(models::in_view(sensor, at, towards(-47.1)));
}

// A problem whose one target lies 70° off the heading: out of sight of 94°, in sight of 188°.
TEST(ParseProblem, CostsWhatTheFullAngleSees) {
  json document = file("tracking.json");
  document["map"].erase("obstacles");
  document["robot"] = {{"x", 0.0}, {"y", 0.0}, {"yaw", 0.0}};
  document["controls"] = json::parse("[[0.0, 0.0]]");
  document["T"] = 1;
  document["n_targets"] = 1;
  const double b = radians(70.0);
  document["targets"] = {{3.0 * std::cos(b), 3.0 * std::sin(b), 0.0, 0.0}};
  const auto cost_at = [&](double fov_deg) {
    document["sensor"]["fov_deg"] = fov_deg;
    return planner::score(parse(document).problem, {Pose2{}});
  };
  const double unseen = cost_at(1.0);
  EXPECT_EQ(cost_at(94.0), unseen);
  EXPECT_LT(cost_at(188.0), unseen - 1.0);
}

TEST(ParseProblem, SeesAllRoundFromAFullTurnAlone) {
  json document = file("tracking.json");
  const auto sees_behind = [&] {
    return models::in_view(parse(document).problem.sensors[0], {{0, 0, 0}, 0.0},
                           Eigen::Vector2d(-3.0, 0.0));
  };
  document["sensor"]["fov_deg"] = 180.0;
  EXPECT_FALSE(sees_behind());
  document["sensor"]["fov_deg"] = 360.0;
  EXPECT_TRUE(sees_behind());
  document["sensor"].erase("fov_deg");
  EXPECT_TRUE(sees_behind());
}

TEST(ParseProblem, HasDefaultsForWhatMayBeLeftOut) {
  const PlanningProblem read = parse(file("mapping.json"));
  const planner::SearchProblem& p = read.problem;
  EXPECT_EQ(read.name, "");
  EXPECT_DOUBLE_EQ(p.start.yaw_rad, 0.0);
  EXPECT_EQ(p.cost, planner::CostKind::kTrace);
  EXPECT_EQ(p.sensors[0].kind, models::SensorKind::kRange);
  EXPECT_DOUBLE_EQ(p.sensors[0].fov_rad, 2.0 * kPi);
  EXPECT_DOUBLE_EQ(p.sensors[0].range_min_m, 0.0);
  EXPECT_EQ(p.targets[0].model.kind, models::TargetKind::kStatic);
  EXPECT_EQ(p.targets[0].model.dim(), 2);
  json document = file("mapping.json");
  document.erase("cost");
  document["map"].erase("obstacles");
  document["q"] = 0.0;
  const PlanningProblem open = parse(document);
  EXPECT_EQ(open.problem.cost, planner::CostKind::kLogDet);
  EXPECT_TRUE(open.world->obstacles.empty());
}

TEST(ParseProblem, LetsAMovingTargetHaveNoNoise) {
  json document = file("tracking.json");
  document["q"] = 0;
  EXPECT_DOUBLE_EQ(parse(document).problem.targets[0].model.q, 0.0);
}

struct Refused {
  const char* patch;     ///< RFC 6902
  const char* expected;  ///< how the refusal goes on after "p.json: "
};

TEST(ParseProblem, RefusesWithThePathAndTheRule) {
  const std::vector<Refused> cases = {
      {R"({"op": "replace", "path": "/sensor/sigma_r", "value": -1})",
       "sensor.sigma_r: must be > 0"},
      {R"({"op": "replace", "path": "/sensor/sigma_r", "value": "0.1"})",
       "sensor.sigma_r: must be a number, got \"0.1\""},
      {R"({"op": "replace", "path": "/sensor/sigma_b_deg", "value": 0})",
       "sensor.sigma_b_deg: must be > 0"},
      {R"({"op": "remove", "path": "/sensor/sigma_b_deg"})",
       "sensor: missing required key sigma_b_deg"},
      {R"({"op": "replace", "path": "/sensor/range", "value": 0})", "sensor.range: must be > 0"},
      {R"({"op": "replace", "path": "/sensor/fov_deg", "value": 361})",
       "sensor.fov_deg: must be > 0 and ≤ 360, got 361"},
      {R"({"op": "replace", "path": "/sensor/type", "value": "sonar"})",
       "sensor.type: must be one of range, range_bearing, got \"sonar\""},
      {R"({"op": "add", "path": "/sensor/rnage", "value": 1})",
       "sensor: unknown key \"rnage\"; did you mean range?"},
      {R"({"op": "replace", "path": "/sensor", "value": []})", "sensor: must be an object, got []"},
      {R"({"op": "remove", "path": "/map"})", "missing required key map"},
      {R"({"op": "replace", "path": "/map/max", "value": [-20, 20]})",
       "map.max: must be above map.min [-20, -20] in both, got [-20,20]"},
      {R"({"op": "replace", "path": "/map/min", "value": [1]})",
       "map.min: must be [x, y], two numbers, got [1]"},
      {R"({"op": "replace", "path": "/map/res", "value": 0})", "map.res: must be > 0"},
      {R"({"op": "add", "path": "/map/obstacles/-", "value": [1, 2, 1, 3]})",
       "map.obstacles[1]: must be [xmin, ymin, xmax, ymax] with xmin < xmax and ymin < ymax"},
      {R"({"op": "add", "path": "/map/obstacles/-", "value": [1, 2, "x", 3]})",
       "map.obstacles[1][2]: must be a number, got \"x\""},
      {R"({"op": "replace", "path": "/robot/x", "value": 20})", "robot: must be inside the map"},
      {R"({"op": "replace", "path": "/robot", "value": {"x": 2.5, "y": 2.0}})",
       "robot: must be inside the map and outside every obstacle"},
      {R"({"op": "remove", "path": "/robot/y"})", "robot: missing required key y"},
      {R"({"op": "replace", "path": "/robot/yaw", "value": null})",
       "robot.yaw: must be a number, got null"},
      {R"({"op": "replace", "path": "/tau", "value": 0})", "tau: must be > 0"},
      {R"({"op": "replace", "path": "/controls", "value": []})",
       "controls: must be between 1 and 64 controls, got 0"},
      {R"({"op": "replace", "path": "/controls/3", "value": [1, 2, 3]})",
       "controls[3]: must be [speed in m/s, yaw rate in rad/s], two numbers, got [1,2,3]"},
      {R"({"op": "replace", "path": "/controls/3", "value": [-1, 2]})",
       "controls[3][0]: must be ≥ 0"},
      {R"({"op": "replace", "path": "/T", "value": 0})", "T: must be ≥ 1 and ≤ 255, got 0"},
      {R"({"op": "replace", "path": "/T", "value": 2.5})", "T: must be a whole number, got 2.5"},
      {R"({"op": "replace", "path": "/target_model", "value": "rover"})",
       "target_model: must be one of static_2d, double_integrator_2d, got \"rover\""},
      {R"({"op": "replace", "path": "/target_model", "value": "static_2d"})",
       "q: must be 0 for static_2d targets"},
      {R"({"op": "replace", "path": "/q", "value": -0.1})", "q: must be ≥ 0"},
      {R"({"op": "remove", "path": "/q"})", "missing required key q"},
      {R"({"op": "replace", "path": "/targets", "value": []})",
       "targets: must be between 1 and 65534 targets, got 0"},
      {R"({"op": "replace", "path": "/targets/2", "value": [1, 2, 3]})",
       "targets[2]: must be [x, y, vx, vy], four numbers, got [1,2,3]"},
      {R"({"op": "replace", "path": "/targets/2/1", "value": true})",
       "targets[2][1]: must be a number, got true"},
      {R"({"op": "replace", "path": "/prior_cov_diag/2", "value": 0})",
       "prior_cov_diag[2]: must be > 0"},
      {R"({"op": "replace", "path": "/prior_cov_diag", "value": [1, 1]})",
       "prior_cov_diag: must be 4 variances, one a state component, got [1,1]"},
      {R"({"op": "replace", "path": "/n_targets", "value": 4})",
       "n_targets: must be the number of targets, which is 3, got 4"},
      {R"({"op": "replace", "path": "/cost", "value": "entropy"})",
       "cost: must be one of logdet, trace, got \"entropy\""},
      {R"({"op": "replace", "path": "/name", "value": 3})", "name: must be a text, got 3"},
      {R"({"op": "replace", "path": "/seed", "value": "x"})", "seed: must be a number"},
      {R"({"op": "add", "path": "/horizon", "value": 3})", "unknown key \"horizon\"; known here"},
  };
  for (const Refused& refused : cases) {
    const json patched = file("tracking.json").patch(json::array({json::parse(refused.patch)}));
    const std::string refusal = refusal_of(patched.dump());
    EXPECT_TRUE(refusal.starts_with(std::string("p.json: ") + refused.expected))
        << refused.patch << "\nsays " << refusal;
  }
}

TEST(ParseProblem, RefusesWhatIsNoJsonWithLineAndColumn) {
  EXPECT_TRUE(refusal_of("{\n  \"T\": 1,\n  \"q\" 2\n}").starts_with("p.json:3:7: not JSON: "))
      << refusal_of("{\n  \"T\": 1,\n  \"q\" 2\n}");
  EXPECT_TRUE(refusal_of("").starts_with("p.json:1:1: not JSON: "));
  EXPECT_TRUE(refusal_of("{} x").starts_with("p.json:1:4: not JSON: "));
  EXPECT_NE(refusal_of("{\"T\": 1e999}").find("not JSON: number overflow"), std::string::npos);
  EXPECT_TRUE(refusal_of("{\"T\": NaN}").starts_with("p.json:1:7: not JSON: "));
  EXPECT_EQ(refusal_of("{\"T\": 1, \"T\": 2}"), "p.json: duplicate key \"T\"");
  EXPECT_EQ(refusal_of(std::string(100'000, '[')), "p.json: nested deeper than 32");
  EXPECT_EQ(refusal_of("[]"), "p.json: must be an object, got []");
}

TEST(ParseProblem, NeverFallsOverWhateverOneCharacterBecomes) {
  const std::string text = file("mapping.json").dump();
  int read = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const char c : {'0', '-', '9', '"', '[', '}', 'e', '\0', '\xff'}) {
      std::string changed = text;
      changed[i] = c;
      read += refusal_of(changed).empty() ? 1 : 0;
    }
  }
  EXPECT_GT(read, 0);
}

TEST(LoadProblem, NamesTheFileThatIsNotThere) {
  EXPECT_THROW(static_cast<void>(load_problem("/no/such/problem.json")), StartupError);
  EXPECT_THROW(static_cast<void>(load_problem("/")), StartupError);
}

}  // namespace
}  // namespace vantage::tools
