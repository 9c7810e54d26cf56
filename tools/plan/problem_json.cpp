#include "tools/plan/problem_json.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "models/sensor/law.hpp"
#include "models/target/law.hpp"
#include "planner/search/expander.hpp"
#include "scenario/reader/mapping.hpp"
#include "scenario/reader/sensor_parameters.hpp"
#include "tools/plan/json_document.hpp"

namespace vantage::tools {
namespace {

using scenario::Mapping;
using scenario::Range;
using scenario::Value;

// m; larger than any lab or field, small enough that squares and sums of steps keep their
// precision.
constexpr double kFar_m = 1e6;
constexpr double kFastest_mps = 1e3;
constexpr double kLongest_s = 3600.0;
constexpr double kLeastSigma = 1e-6;
// m; closer targets are not observed. Towards zero distance, the information of a bearing or a
// range rate about the position grows without limit. This minimum distance keeps the information
// and therefore the lower bound finite.
constexpr double kLeastRange_m = 1e-3;
// The distance field only accelerates exact tests; 10⁶ cells are enough.
constexpr double kFieldCellsMax = 1e6;
constexpr double kFieldColumnsMax = 1e5;

constexpr Range positive(double max) { return scenario::above_to(0.0, max); }
constexpr Range within(double most) { return scenario::from_to(-most, most); }

models::Obstacle read_obstacle(const Value& value) {
  const std::vector<double> b =
      value.numbers(4, "four numbers [xmin, ymin, xmax, ymax]", within(kFar_m));
  if (b[0] >= b[2] || b[1] >= b[3]) {
    value.refuse(
        fmt::format("must be [xmin, ymin, xmax, ymax] with xmin < xmax and ymin < ymax, is [{}]",
                    fmt::join(b, ", ")));
  }
  models::Obstacle obstacle;
  obstacle.footprint = {{b[0], b[1]}, {b[2], b[3]}};
  return obstacle;
}

/// Reads the map. Returns the resolution of the distance field.
double read_map(Mapping& map, models::World& world) {
  const std::optional<Value> min = map.find_required("min");
  const std::optional<Value> max = map.find_required("max");
  double resolution_m = 0.1;
  map.number("res", resolution_m, positive(kFar_m));
  const std::optional<Value> obstacles = map.find("obstacles");
  map.finish();
  if (min && max) {
    world.bounds = {min->point(within(kFar_m)), max->point(within(kFar_m))};
    if ((world.bounds.min_m.array() >= world.bounds.max_m.array()).any()) {
      max->refuse(fmt::format("must be above map.min ([{}, {}]) in x and in y, but is [{}, {}]",
                              world.bounds.min_m.x(), world.bounds.min_m.y(),
                              world.bounds.max_m.x(), world.bounds.max_m.y()));
    }
  }
  for (const Value& item : obstacles ? obstacles->items() : std::vector<Value>()) {
    world.obstacles.push_back(read_obstacle(item));
  }
  const Eigen::Vector2d extent_m = world.bounds.max_m - world.bounds.min_m;
  return std::max({resolution_m, std::sqrt(extent_m.prod() / kFieldCellsMax),
                   extent_m.maxCoeff() / kFieldColumnsMax});
}

Pose2 read_start(Mapping& robot, double& height_m) {
  Pose2 start;
  robot.require("x");
  robot.require("y");
  robot.number("x", start.x_m, within(kFar_m));
  robot.number("y", start.y_m, within(kFar_m));
  robot.number("yaw", start.yaw_rad, within(kFastest_mps));
  robot.number("height_m", height_m, scenario::from_to(0.0, kFar_m));
  start.yaw_rad = wrap_to_pi(start.yaw_rad);
  return start;
}

std::vector<models::UnicycleControl> read_controls(const Value& value) {
  const std::vector<Value> items = value.items();
  if (items.empty() || items.size() > planner::kMaxControls) {
    value.refuse(fmt::format("must list at least 1 and at most {} controls, lists {}",
                             planner::kMaxControls, items.size()));
  }
  std::vector<models::UnicycleControl> controls;
  for (const Value& item : items) {
    const std::vector<Value> parts = item.items(2, "two numbers [speed in m/s, yaw rate in rad/s]");
    controls.push_back({parts[0].number(scenario::from_to(0.0, kFastest_mps)),
                        parts[1].number(within(kFastest_mps))});
  }
  return controls;
}

void read_sensor(Mapping& keys, models::SensorModel& sensor) {
  const Range sigmas = scenario::from_to(kLeastSigma, kFar_m);
  double fov_deg = 360.0;
  double bearing_sigma_deg = 0.0;
  keys.require("type");
  keys.require("range");
  keys.choice("type", sensor.kind, models::all_sensor_kinds());
  const models::SensorLaw& law = sensor.kind.law();
  if (law.measures_range) {
    keys.require("sigma_r");
  }
  if (law.measures_bearing) {
    keys.require("sigma_b_deg");
  }
  if (law.measures_bearing || models::measures_velocity(sensor)) {
    sensor.range_min_m = kLeastRange_m;
  }
  keys.number("range", sensor.range_max_m, positive(kFar_m));
  keys.number("fov_deg", fov_deg, positive(360.0));
  keys.number("sigma_r", sensor.range_sigma_m, sigmas);
  keys.number("sigma_b_deg", bearing_sigma_deg, sigmas);
  keys.number("range_min_m", sensor.range_min_m, scenario::from_to(sensor.range_min_m, kFar_m));
  keys.number("position_sigma_m", sensor.position_sigma_m, sigmas);
  keys.number("pixel_sigma", sensor.pixel_sigma, sigmas);
  keys.number("focal_length_pixels", sensor.focal_length_pixels, positive(kFar_m));
  keys.angle("camera_tilt", sensor.camera_tilt_rad, scenario::from_to(0.0, 90.0));
  keys.number("depth_min_m", sensor.depth_min_m, positive(kFar_m));
  scenario::read_own_parameters(keys, sensor);
  sensor.fov_rad = radians(fov_deg);
  if (law.measures_bearing) {
    sensor.bearing_sigma_rad = radians(bearing_sigma_deg);
  }
}

/// Returns the target models that problem files may select, by name with the suffix "_2d". These
/// models have no parameter except q.
std::vector<std::pair<std::string_view, models::TargetKind>> planar_kinds() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const models::TargetKind kind : models::all_target_kinds()) {
      names.push_back(std::string(kind.name()) + "_2d");
    }
    return names;
  }();
  std::vector<std::pair<std::string_view, models::TargetKind>> kinds;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const models::TargetKind kind = models::all_target_kinds()[i];
    if (!kind.law().uses_oscillator && kind.law().unseen_noise == nullptr) {
      kinds.emplace_back(kNames[i], kind);
    }
  }
  return kinds;
}

/// Reads the model and the prior covariance that all targets share.
planner::SearchTarget read_target_model(Mapping& keys) {
  planner::SearchTarget target;
  models::TargetModel& model = target.model;
  keys.choice("target_model", model.kind, planar_kinds());
  double q = 0.0;
  keys.number("q", q, scenario::from_to(0.0, kFar_m));
  if (model.kind.law().uses_q) {
    keys.require("q");
    model.q = q;
  } else if (q != 0.0) {
    keys.refuse("q", fmt::format("must be 0 for {}_2d targets, is {}", model.kind.name(), q));
  }
  target.prior.covariance = models::StateMatrix::Zero(model.dim(), model.dim());
  if (const std::optional<Value> prior = keys.find_required("prior_cov_diag")) {
    const std::vector<double> variances =
        prior->numbers(static_cast<std::size_t>(model.dim()),
                       fmt::format("{} variances, one per state component", model.dim()),
                       scenario::from_to(kLeastSigma * kLeastSigma, kFar_m * kFar_m));
    target.prior.covariance.diagonal() =
        Eigen::Map<const Eigen::VectorXd>(variances.data(), model.dim());
  }
  return target;
}

std::vector<planner::SearchTarget> read_targets(Mapping& keys) {
  constexpr std::size_t kTargetsMax = 65'534;
  planner::SearchTarget target = read_target_model(keys);
  const int dim = target.model.dim();
  const char* shape = dim == 4 ? "four numbers [x, y, vx, vy]" : "two numbers [x, y]";
  const std::optional<Value> list = keys.find_required("targets");
  std::vector<planner::SearchTarget> targets;
  for (const Value& item : list ? list->items() : std::vector<Value>()) {
    const std::vector<double> mean =
        item.numbers(static_cast<std::size_t>(dim), shape, within(kFar_m));
    target.prior.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), dim);
    targets.push_back(target);
  }
  if (list && (targets.empty() || targets.size() > kTargetsMax)) {
    list->refuse(fmt::format("must list at least 1 and at most {} targets, lists {}", kTargetsMax,
                             targets.size()));
  }
  int count = static_cast<int>(targets.size());
  keys.integer("n_targets", count, 0, std::numeric_limits<int>::max());
  if (count != std::ssize(targets)) {
    keys.refuse("n_targets",
                fmt::format("must be the number of targets, {}; is {}", targets.size(), count));
  }
  return targets;
}

// Reads the keys that describe a problem without changing it.
void read_description(Mapping& keys, PlanningProblem& read) {
  if (const std::optional<Value> name = keys.find("name")) {
    read.name = name->text_or_empty();
  }
  for (const std::string_view key : {"family", "notes"}) {
    if (const std::optional<Value> words = keys.find(key)) {
      static_cast<void>(words->text_or_empty());
    }
  }
  if (const std::optional<Value> seed = keys.find("seed")) {
    constexpr std::int64_t kExactMax = std::int64_t{1} << 53;
    static_cast<void>(seed->integer(-kExactMax, kExactMax));
  }
}

void read_problem(Mapping& top, PlanningProblem& read) {
  planner::SearchProblem& problem = read.problem;
  top.declare({"name", "family", "notes", "seed", "n_targets", "q", "cost"});
  for (const char* key : {"map", "robot", "tau", "controls", "T", "target_model", "targets",
                          "prior_cov_diag", "sensor"}) {
    top.require(key);
  }
  top.finish();

  read_description(top, read);
  double resolution_m = 0.0;
  top.section("map", [&](Mapping& map) { resolution_m = read_map(map, *read.world); });
  top.section("robot",
              [&](Mapping& robot) { problem.start = read_start(robot, problem.height_m); });
  if (models::clearance_m(*read.world, problem.start.position_m()) <= 0.0) {
    top.refuse("robot", fmt::format("must be inside the map, outside every obstacle, and not on an "
                                    "edge of the map or of an obstacle; is at [{}, {}]",
                                    problem.start.x_m, problem.start.y_m));
  }
  top.number("tau", problem.step_s, positive(kLongest_s));
  if (const std::optional<Value> controls = top.find("controls")) {
    problem.controls = read_controls(*controls);
  }
  top.integer("T", problem.horizon_steps, 1, 255);
  problem.targets = read_targets(top);
  top.section("sensor",
              [&](Mapping& sensor) { read_sensor(sensor, problem.sensors.emplace_back()); });
  top.choice("cost", problem.cost,
             {{"logdet", planner::CostKind::kLogDet}, {"trace", planner::CostKind::kTrace}});
  top.finish();
  read.field = std::make_unique<models::DistanceField>(*read.world, resolution_m);
  problem.world = read.world.get();
  problem.field = read.field.get();
}

}  // namespace

PlanningProblem parse_problem(const std::string& text, const std::string& source) {
  PlanningProblem read;
  read.world = std::make_unique<models::World>();
  scenario::read_mapping({parse_json(text, source)},
                         [&](Mapping& top) { read_problem(top, read); });
  planner::require_valid(read.problem);
  return read;
}

PlanningProblem load_problem(const std::string& path) {
  return parse_problem(scenario::read_text_file(path, kProblemText), path);
}

}  // namespace vantage::tools
