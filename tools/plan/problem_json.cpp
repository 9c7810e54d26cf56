#include "tools/plan/problem_json.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "core/check.hpp"
#include "planner/search/expander.hpp"
#include "tools/plan/json_value.hpp"

namespace vantage::tools {
namespace {

// Far beyond any lab or field, near enough that every square and sum of steps stays exact.
constexpr double kFar_m = 1e6;
constexpr double kFastest_mps = 1e3;
constexpr double kLongest_s = 3600.0;
constexpr double kLeastSigma = 1e-6;
// A bearing knows no direction at its own place. A target this near is not seen; it keeps the
// information of a look finite, and so the lower bound.
constexpr double kLeastBearingRange_m = 1e-3;
// The field only speeds up what is decided exactly; a million cells are enough for that.
constexpr double kFieldCellsMax = 1e6;
constexpr double kFieldColumnsMax = 1e5;

constexpr Bounds positive(double max) { return {0.0, max, true}; }
constexpr Bounds within(double most) { return {-most, most, false}; }

Eigen::Vector2d point(const JsonValue& value) {
  const std::vector<double> p = value.numbers(2, within(kFar_m), "[x, y], two numbers");
  return {p[0], p[1]};
}

models::Obstacle read_obstacle(const JsonValue& value) {
  const std::vector<double> b =
      value.numbers(4, within(kFar_m), "[xmin, ymin, xmax, ymax], four numbers");
  if (b[0] >= b[2] || b[1] >= b[3]) {
    value.refuse("must be [xmin, ymin, xmax, ymax] with xmin < xmax and ymin < ymax");
  }
  models::Obstacle obstacle;
  obstacle.footprint = {{b[0], b[1]}, {b[2], b[3]}};
  return obstacle;
}

/// Returns the resolution that the distance field is made with.
double read_map(const JsonValue& value, models::World& world) {
  JsonObject map(value);
  world.bounds.min_m = point(map.get("min"));
  const JsonValue max = map.get("max");
  world.bounds.max_m = point(max);
  if ((world.bounds.min_m.array() >= world.bounds.max_m.array()).any()) {
    max.refuse(fmt::format("must be above map.min [{}, {}] in both", world.bounds.min_m.x(),
                           world.bounds.min_m.y()));
  }
  const double resolution_m = map.number_or("res", 0.1, positive(kFar_m));
  if (const std::optional<JsonValue> obstacles = map.find("obstacles")) {
    for (const JsonValue& item : obstacles->items()) {
      world.obstacles.push_back(read_obstacle(item));
    }
  }
  map.finish();
  const Eigen::Vector2d extent_m = world.bounds.max_m - world.bounds.min_m;
  return std::max({resolution_m, std::sqrt(extent_m.prod() / kFieldCellsMax),
                   extent_m.maxCoeff() / kFieldColumnsMax});
}

Pose2 read_start(const JsonValue& value, const models::World& world) {
  JsonObject robot(value);
  Pose2 start;
  start.x_m = robot.number("x", within(kFar_m));
  start.y_m = robot.number("y", within(kFar_m));
  start.yaw_rad = wrap_to_pi(robot.number_or("yaw", 0.0, within(kFastest_mps)));
  robot.finish();
  if (models::clearance_m(world, start.position_m()) <= 0.0) {
    value.refuse("must be inside the map and outside every obstacle, touching neither");
  }
  return start;
}

std::vector<models::UnicycleControl> read_controls(const JsonValue& value) {
  const std::vector<JsonValue> items = value.items();
  if (items.empty() || items.size() > planner::kMaxControls) {
    value.complain(fmt::format("must be between 1 and {} controls, got {}", planner::kMaxControls,
                               items.size()));
  }
  std::vector<models::UnicycleControl> controls;
  for (const JsonValue& item : items) {
    static_cast<void>(item.numbers(2, {}, "[speed in m/s, yaw rate in rad/s], two numbers"));
    const std::vector<JsonValue> parts = item.items();
    controls.push_back(
        {parts[0].number({0.0, kFastest_mps, false}), parts[1].number(within(kFastest_mps))});
  }
  return controls;
}

models::SensorModel read_sensor(const JsonValue& value) {
  JsonObject keys(value);
  models::SensorModel sensor;
  const bool has_bearing = keys.get("type").word({"range", "range_bearing"}) == 1;
  sensor.kind = has_bearing ? models::SensorKind::kRangeBearing : models::SensorKind::kRange;
  sensor.range_max_m = keys.number("range", positive(kFar_m));
  sensor.fov_rad = radians(keys.number_or("fov_deg", 360.0, positive(360.0)));
  const Bounds sigmas{0.0, kFar_m, true};
  const auto sigma = [&](const JsonValue& at) {
    const double read = at.number(sigmas);
    if (read < kLeastSigma) {
      at.refuse(fmt::format("must be ≥ {}", kLeastSigma));
    }
    return read;
  };
  sensor.range_sigma_m = sigma(keys.get("sigma_r"));
  if (has_bearing) {
    sensor.range_min_m = kLeastBearingRange_m;
    sensor.bearing_sigma_rad = radians(sigma(keys.get("sigma_b_deg")));
  } else if (const std::optional<JsonValue> unused = keys.find("sigma_b_deg")) {
    static_cast<void>(sigma(*unused));
  }
  keys.finish();
  return sensor;
}

std::vector<planner::SearchTarget> read_targets(JsonObject& keys) {
  const JsonValue kind = keys.get("target_model");
  const bool moves = kind.word({"static_2d", "double_integrator_2d"}) == 1;
  models::TargetModel model;
  model.kind = moves ? models::TargetKind::kDoubleIntegrator : models::TargetKind::kStatic;
  if (moves) {
    model.q = keys.number("q", {0.0, kFar_m, false});
  } else if (const std::optional<JsonValue> q = keys.find("q")) {
    if (q->number({0.0, kFar_m, false}) != 0.0) {
      q->refuse("must be 0 for static_2d targets, which do not move");
    }
  }
  const auto n = static_cast<std::size_t>(model.dim());
  const std::string shape = moves ? "[x, y, vx, vy], four numbers" : "[x, y], two numbers";

  const JsonValue prior = keys.get("prior_cov_diag");
  const std::vector<double> variances = prior.numbers(
      n, positive(kFar_m * kFar_m), fmt::format("{} variances, one a state component", n));
  models::StateMatrix covariance = models::StateMatrix::Zero(model.dim(), model.dim());
  for (std::size_t i = 0; i < n; ++i) {
    if (variances[i] < kLeastSigma * kLeastSigma) {
      prior.refuse(fmt::format("must be ≥ {} each", kLeastSigma * kLeastSigma));
    }
    covariance(static_cast<int>(i), static_cast<int>(i)) = variances[i];
  }

  const JsonValue list = keys.get("targets");
  std::vector<planner::SearchTarget> targets;
  for (const JsonValue& item : list.items()) {
    const std::vector<double> mean = item.numbers(n, within(kFar_m), shape);
    planner::SearchTarget target{model, {}};
    target.prior.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), model.dim());
    target.prior.covariance = covariance;
    targets.push_back(target);
  }
  constexpr std::size_t kTargetsMax = 65'534;
  if (targets.empty() || targets.size() > kTargetsMax) {
    list.complain(
        fmt::format("must be between 1 and {} targets, got {}", kTargetsMax, targets.size()));
  }
  if (const std::optional<JsonValue> count = keys.find("n_targets")) {
    if (count->integer(0, 1'000'000'000) != std::ssize(targets)) {
      count->refuse(fmt::format("must be the number of targets, which is {}", targets.size()));
    }
  }
  return targets;
}

// What describes a problem and changes nothing of it.
void read_description(JsonObject& keys, PlanningProblem& read) {
  if (const std::optional<JsonValue> name = keys.find("name")) {
    read.name = name->text();
  }
  for (const std::string_view key : {"family", "notes"}) {
    if (const std::optional<JsonValue> words = keys.find(key)) {
      static_cast<void>(words->text());
    }
  }
  if (const std::optional<JsonValue> seed = keys.find("seed")) {
    constexpr std::int64_t kExactMax = std::int64_t{1} << 53;
    static_cast<void>(seed->integer(-kExactMax, kExactMax));
  }
}

}  // namespace

PlanningProblem parse_problem(const std::string& text, const std::string& source) {
  const nlohmann::json document = parse_json(text, source);
  PlanningProblem read;
  read.world = std::make_unique<models::World>();
  planner::SearchProblem& problem = read.problem;
  JsonObject keys(JsonValue(document, source));
  read_description(keys, read);
  const double resolution_m = read_map(keys.get("map"), *read.world);
  problem.start = read_start(keys.get("robot"), *read.world);
  problem.step_s = keys.number("tau", positive(kLongest_s));
  problem.controls = read_controls(keys.get("controls"));
  problem.horizon_steps = static_cast<int>(keys.get("T").integer(1, 255));
  problem.targets = read_targets(keys);
  problem.sensors = {read_sensor(keys.get("sensor"))};
  if (const std::optional<JsonValue> cost = keys.find("cost")) {
    problem.cost = cost->word({"logdet", "trace"}) == 0 ? planner::CostKind::kLogDet
                                                        : planner::CostKind::kTrace;
  }
  keys.finish();
  read.field = std::make_unique<models::DistanceField>(*read.world, resolution_m);
  problem.world = read.world.get();
  problem.field = read.field.get();
  planner::require_valid(problem);
  return read;
}

PlanningProblem load_problem(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw StartupError(path + ": no such file");
  }
  std::ifstream file(path, std::ios::binary);
  if (std::filesystem::is_directory(path, error) || !file) {
    throw StartupError(path + ": cannot be read; expected a problem file");
  }
  constexpr std::uintmax_t kBytesMax = std::uintmax_t{64} << 20U;
  if (const auto size = std::filesystem::file_size(path, error); !error && size > kBytesMax) {
    throw StartupError(path + ": must be at most 64 MiB; expected a problem file");
  }
  return parse_problem({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()},
                       path);
}

}  // namespace vantage::tools
