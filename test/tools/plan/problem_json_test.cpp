#include "tools/plan/problem_json.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"
#include "models/sensor/law.hpp"

namespace vantage::tools {
namespace {

using nlohmann::json;

std::string text_of(const std::string& name) {
  std::ifstream stream(VANTAGE_SOURCE_DIR "/test/tools/problems/" + name);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

json file(const std::string& name) { return json::parse(text_of(name)); }

PlanningProblem parse(const json& document) { return parse_problem(document.dump(), "p.json"); }

/// Returns the reader's error for `text`; "" if it is accepted.
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

TEST(ParseProblem, ReadsTheFieldOfViewAsFullAngle) {
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

// The only target is 70° off the heading: outside a field of view of 94°, inside one of 188°.
TEST(ParseProblem, CostUsesTheFieldOfViewAsFullAngle) {
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

TEST(ParseProblem, SensorSeesBehindOnlyWith360DegreesFieldOfView) {
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

TEST(ParseProblem, HasDefaultsForOptionalKeys) {
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

TEST(ParseProblem, ReadsEverySensorKindWithItsParameters) {
  for (const models::SensorKind kind : models::all_sensor_kinds()) {
    json document = file("tracking.json");
    document["robot"]["height_m"] = 1.5;
    document["sensor"]["type"] = kind.name();
    for (const models::SensorParameter& each : kind.law().parameters) {
      document["sensor"][std::string(each.name)] = 0.5 * each.initial;
    }
    const PlanningProblem read = parse(document);
    const models::SensorModel& sensor = read.problem.sensors[0];
    EXPECT_EQ(sensor.kind, kind);
    EXPECT_EQ(read.problem.height_m, 1.5);
    for (std::size_t i = 0; i < kind.law().parameters.size(); ++i) {
      EXPECT_EQ(models::own_parameter(sensor, static_cast<int>(i)),
                0.5 * kind.law().parameters[i].initial);
    }
    const bool has_least_range = kind.law().measures_bearing || models::measures_velocity(sensor);
    EXPECT_EQ(sensor.range_min_m, has_least_range ? 1e-3 : 0.0) << kind.name();
  }
}

TEST(ParseProblem, RefusesAParameterOfAnotherSensorKind) {
  json document = file("tracking.json");
  document["sensor"]["range_rate_sigma_mps"] = 0.1;
  EXPECT_EQ(refusal_of(document.dump()),
            "p.json:1: sensor.range_rate_sigma_mps: is a parameter of sensor kind range_rate; kind "
            "range_bearing has its own parameters: none");
  document["sensor"]["type"] = "range_rate";
  document["sensor"]["range_rate_sigma_mps"] = 0.0;
  EXPECT_EQ(refusal_of(document.dump()),
            "p.json:1: sensor.range_rate_sigma_mps: must be above 0, is 0");
}

TEST(ParseProblem, AcceptsAMovingTargetWithoutNoise) {
  json document = file("tracking.json");
  document["q"] = 0;
  EXPECT_DOUBLE_EQ(parse(document).problem.targets[0].model.q, 0.0);
}

/// A change of tracking.json that must be refused. The '@' in `becomes` marks the line that the
/// message must name; it is removed before reading.
struct BadEdit {
  const char* was;
  const char* becomes;
  const char* words;  ///< beginning of the error after "p.json:line: "
};

// clang-format off
const BadEdit kBadEdits[] = {
    {R"("sigma_r": 0.15)", R"(@"sigma_r": -1)", "sensor.sigma_r: must be at least 1e-06 and at most 1000000, is -1"},
    {R"("sigma_r": 0.15)", R"(@"sigma_r": "0.1")", "sensor.sigma_r: must be a plain number, is the text '0.1'"},
    {R"("sigma_r": 0.15)", R"(@"sigma_r": true)", "sensor.sigma_r: must be a number, is 'true'"},
    {R"("sigma_r": 0.15)", "\n@\"sigma_r\":\n1e-9", "sensor.sigma_r: must be at least 1e-06"},
    {R"("sigma_b_deg": 5.0)", R"(@"sigma_b_deg": 0)", "sensor.sigma_b_deg: must be at least 1e-06"},
    {",\n             \"sigma_b_deg\": 5.0", "@", "sensor: missing required key sigma_b_deg"},
    {R"("range": 8.0)", R"(@"range": 0)", "sensor.range: must be above 0 and at most 1000000, is 0"},
    {R"("range": 8.0)", R"(@"range": 1e-400)", "sensor.range: must be a finite number that a double can hold, is '1e-400'"},
    {R"("fov_deg": 94.0)", "\n\n@\"fov_deg\": 361", "sensor.fov_deg: must be above 0 and at most 360, is 361"},
    {R"("fov_deg": 94.0)", R"(@"fov": 94)", "sensor.fov: unknown key, wrong unit; did you mean fov_deg?"},
    {R"("range_bearing")", R"(@"sonar")", "sensor.type: must be one of position, range, bearing, range_bearing, camera, range_rate; is 'sonar'"},
    {R"("range": 8.0)", R"(@"rnage": 8.0)", "sensor.rnage: unknown key; did you mean range?"},
    {R"("range": 8.0)", "\"range\": 8.0,\n@\"range\": 9", "sensor.range: duplicate key, first given on line 16"},
    {R"("robot": {"x": 0.0, "y": -0.5, "yaw": 0.4})", R"(@"robot": [])", "robot: must be a mapping of keys to values"},
    {R"("max": [20, 20])", R"(@"max": [-20, 20])", "map.max: must be above map.min ([-20, -20]) in x and in y, but is [-20, 20]"},
    {R"("min": [-20, -20])", R"(@"min": [1])", "map.min: must be a list of two numbers [x, y], is a list of 1"},
    {R"("min": [-20, -20])", "\"min\": [-20,\n@null]", "map.min[1]: must be a number, is nothing"},
    {R"("min": [-20, -20], )", "@", "map: missing required key min"},
    {R"("res": 0.2)", R"(@"res": 0)", "map.res: must be above 0"},
    {R"("obstacles": [[)", "\"obstacles\": [\n@[1, 2, 1, 3], [", "map.obstacles[0]: must be [xmin, ymin, xmax, ymax] with xmin < xmax and ymin < ymax, is [1, 2, 1, 3]"},
    {R"("obstacles": [[)", "\"obstacles\": [[1, 2,\n@\"x\", 3], [", "map.obstacles[0][2]: must be a plain number, is the text 'x'"},
    {R"("x": 0.0)", R"(@"x": 20)", "robot: must be inside the map, outside every obstacle, and not on an edge of the map or of an obstacle; is at [20, -0.5]"},
    {R"("x": 0.0, "y": -0.5)", R"(@"x": 2.5, "y": 2.0)", "robot: must be inside the map, outside every obstacle"},
    {R"(, "y": -0.5)", "@", "robot: missing required key y"},
    {R"("yaw": 0.4)", R"(@"yaw": null)", "robot.yaw: has no value"},
    {R"("tau": 0.5)", R"(@"tau": 0)", "tau: must be above 0 and at most 3600, is 0"},
    {R"("tau": 0.5)", R"(@"tua": 0.5)", "tua: unknown key; did you mean tau?"},
    {R"("tau": 0.5)", "\"tau\": 0.5,\n@\"tau\": 0.5", "tau: duplicate key, first given on line 8"},
    {R"(, [1.0, 3.0])", R"(, @[1, 2, 3])", "controls[3]: must be a list of two numbers [speed in m/s, yaw rate in rad/s], is a list of 3"},
    {R"(, [1.0, 3.0])", R"(, @[-1, 2])", "controls[3][0]: must be at least 0 and at most 1000, is -1"},
    {R"(, [1.0, 3.0])", R"(, @3)", "controls[3]: must be a list of two numbers [speed in m/s, yaw rate in rad/s], is '3'"},
    {R"("T": 8)", R"(@"T": 0)", "T: must be at least 1 and at most 255, is '0'"},
    {R"("T": 8)", R"(@"T": 2.5)", "T: must be a whole number, is '2.5'"},
    {R"("double_integrator_2d")", R"(@"rover")", "target_model: must be one of static_2d, random_walk_2d, double_integrator_2d; is 'rover'"},
    {"\"double_integrator_2d\",\n  \"q\"", "\"static_2d\",\n  @\"q\"", "q: must be 0 for static_2d targets, is 0.001"},
    {R"("q": 0.001)", R"(@"q": -0.1)", "q: must be at least 0 and at most 1000000, is -0.1"},
    {R"("targets": [)", "\"targets\": [\n@[1, 2, 3], ", "targets[0]: must be a list of four numbers [x, y, vx, vy], is a list of 3"},
    {R"([-4.0, 9.0, 0.1, -0.4])", "[-4.0,\n@true, 0.1, -0.4]", "targets[1][1]: must be a number, is 'true'"},
    {R"([1.0, 0.5, 0.1, 0.2])", "[1.0, 0.5,\n@0, 0.2]", "prior_cov_diag[2]: must be at least 1e-12 and at most 1000000000000, is 0"},
    {R"("prior_cov_diag": [1.0, 0.5, 0.1, 0.2])", R"(@"prior_cov_diag": [1, 1])", "prior_cov_diag: must be a list of 4 variances, one per state component, is a list of 2"},
    {R"("n_targets": 3)", R"(@"n_targets": 4)", "n_targets: must be the number of targets, 3; is 4"},
    {R"("logdet")", R"(@"entropy")", "cost: must be one of logdet, trace; is 'entropy'"},
    {R"("logdet")", R"(@3)", "cost: must be one of logdet, trace; is '3'"},
    {R"("two rovers")", R"(@3)", "name: must be text in quotes, is 3"},
    {R"("seed": 7)", R"(@"seed": "x")", "seed: must be a plain number, is the text 'x'"},
    {R"("seed": 7)", R"(@"seed": 7, "horizon": 3)", "horizon: unknown key; valid keys are name, family"},
};
// clang-format on

TEST(ParseProblem, RefusesWithLineValueAndRule) {
  for (const BadEdit& edit : kBadEdits) {
    std::string text = text_of("tracking.json");
    const std::size_t at = text.find(edit.was);
    ASSERT_NE(at, std::string::npos) << "tracking.json has changed: no " << edit.was;
    text.replace(at, std::string_view(edit.was).size(), edit.becomes);
    const std::size_t mark = text.find('@');
    ASSERT_NE(mark, std::string::npos) << edit.becomes;
    text.erase(mark, 1);
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(mark), '\n');
    const std::string refusal = refusal_of(text);
    EXPECT_TRUE(refusal.starts_with("p.json:" + std::to_string(line) + ": " + edit.words))
        << "line " << line << ", " << edit.becomes << "\nsays " << refusal;
  }
}

TEST(ParseProblem, RefusesListsOfWrongLength) {
  json document = file("tracking.json");
  document["controls"] = json::array();
  EXPECT_EQ(refusal_of(document.dump()),
            "p.json:1: controls: must list at least 1 and at most 64 controls, lists 0");
  document = file("tracking.json");
  document["targets"] = json::array();
  EXPECT_EQ(refusal_of(document.dump()),
            "p.json:1: targets: must list at least 1 and at most 65534 targets, lists 0");
}

TEST(ParseProblem, NamesMissingKeys) {
  for (const char* key : {"map", "robot", "tau", "controls", "T", "target_model", "q", "targets",
                          "prior_cov_diag", "sensor"}) {
    json document = file("tracking.json");
    document.erase(key);
    EXPECT_EQ(refusal_of(document.dump()), std::string("p.json:1: missing required key ") + key);
  }
}

TEST(ParseProblem, AcceptsEmptyDescription) {
  json document = file("tracking.json");
  for (const char* key : {"name", "family", "notes"}) {
    document[key] = "";
  }
  EXPECT_EQ(parse(document).name, "");
}

TEST(ParseProblem, RefusesOtherDocuments) {
  EXPECT_EQ(refusal_of(""), "p.json:1: empty file; expected a planning problem");
  for (const char* text : {"[]", "12", "\"text\"", "true"}) {
    EXPECT_EQ(refusal_of(text), "p.json:1: must be a mapping of keys to values") << text;
  }
  EXPECT_EQ(refusal_of("null"), "p.json:1: has no value; expected a mapping of keys to values");
  EXPECT_EQ(refusal_of("{}"), "p.json:1: missing required key map");
  EXPECT_TRUE(refusal_of("{\n\"T\" 8}").starts_with("p.json:2:5: not JSON: "));
}

TEST(ParseProblem, SurvivesAnySingleCharacterChange) {
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

TEST(LoadProblem, RefusesPathsWithoutAFile) {
  const auto refusal = [](const std::string& path) -> std::string {
    try {
      static_cast<void>(load_problem(path));
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("/no/such/problem.json"), "/no/such/problem.json: no such file");
  EXPECT_EQ(refusal("/"), "/: is a directory; expected a planning problem file");
  EXPECT_EQ(refusal("/dev/null"), "/dev/null:1: empty file; expected a planning problem");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: must be at most 16777216 bytes");
}

}  // namespace
}  // namespace vantage::tools
