#include "scenario/reader/scenario_yaml.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "scenario/neighbourhood.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "scenario/reader/mapping.hpp"
#include "scenario/reader/scenario_agents_yaml.hpp"
#include "scenario/reader/scenario_detection_yaml.hpp"
#include "scenario/reader/scenario_ros2_yaml.hpp"
#include "scenario/reader/scenario_sections_yaml.hpp"
#include "scenario/reader/text_file.hpp"
#include "scenario/reader/yaml_document.hpp"
#include "scenario/search_name.hpp"

namespace vantage::scenario {
namespace {

constexpr double kDurationMaxS = 86'400.0;
constexpr double kGridCellsMax = 4e6;
// Size limits, bytes, of a BELIEF message, which contains all targets and grid cells. A message has
// at most 4 MiB.
constexpr double kBeliefBytesMax = 4e6;
constexpr double kTargetBytes = 200.0;
constexpr double kCellBytes = 8.0;

void read_footprint(Mapping& from, models::Rectangle& footprint, const models::World& world) {
  from.require("footprint");
  from.section("footprint", [&](Mapping& rectangle) { read_rectangle(rectangle, footprint); });
  from.finish();
  if ((footprint.max_m.array() <= world.bounds.min_m.array()).any() ||
      (footprint.min_m.array() >= world.bounds.max_m.array()).any()) {
    from.refuse("footprint", "must overlap world.bounds; is entirely outside");
  }
}

void read_world(Mapping& from, models::World& world) {
  from.require("bounds");
  from.section("bounds", [&](Mapping& bounds) { read_rectangle(bounds, world.bounds); });
  from.number("ceiling_m", world.ceiling_m, above_to(0.0, kLengthMaxM));
  from.declare({"obstacles", "regions"});
  from.finish();
  if (const std::optional<Value> obstacles = from.find("obstacles")) {
    for (const Value& item : obstacles->items()) {
      read_mapping({item}, [&](Mapping& obstacle) {
        models::Obstacle box;
        obstacle.number("height_m", box.height_m, above_to(0.0, kLengthMaxM));
        read_footprint(obstacle, box.footprint, world);
        world.obstacles.push_back(box);
      });
    }
  }
  if (const std::optional<Value> regions = from.find("regions")) {
    for (const Value& item : regions->items()) {
      read_mapping({item}, [&](Mapping& region) {
        models::Region part;
        region.require("name");
        region.text("name", part.name);
        region.number("cost_per_step", part.cost_per_step, at_least(0.0));
        read_footprint(region, part.footprint, world);
        world.regions.push_back(part);
      });
    }
  }
}

void read_target_truth(Mapping& from, TargetTruthSpec& truth) {
  from.choice("motion", truth.motion,
              {{"random_waypoint", TargetMotion::kRandomWaypoint},
               {"double_integrator", TargetMotion::kDoubleIntegrator},
               {"still", TargetMotion::kStill}});
  from.number("speed_min_mps", truth.speed_min_mps, above(0.0));
  from.number("speed_max_mps", truth.speed_max_mps, above(0.0));
  from.number("pause_max_s", truth.pause_max_s, from_to(0.0, kDurationMaxS));
  from.number("acceleration_q", truth.acceleration_q, at_least(0.0));
  if (truth.speed_min_mps > truth.speed_max_mps) {
    from.refuse("speed_min_mps", fmt::format("must be at most speed_max_mps ({}), but is {}",
                                             truth.speed_max_mps, truth.speed_min_mps));
  }
}

/// Reads the parameters of the targets' stationary distribution. Defaults are mean and σ of a
/// uniform distribution over the world's bounds.
void read_oscillator(Mapping& from, const models::World& world,
                     models::DampedOscillator& oscillator) {
  const auto pair = [&](const char* key, Eigen::Vector2d& value, const Range& range) {
    if (const std::optional<Value> found = from.find(key)) {
      value = found->point(range);
    }
  };
  const models::Rectangle& bounds = world.bounds;
  oscillator.center_m = 0.5 * (bounds.min_m + bounds.max_m);
  oscillator.position_sigma_m = (bounds.max_m - bounds.min_m) / std::sqrt(12.0);
  pair("center_m", oscillator.center_m, from_to(-kLengthMaxM, kLengthMaxM));
  pair("position_sigma_m", oscillator.position_sigma_m, above_to(0.0, kLengthMaxM));
  pair("velocity_sigma_mps", oscillator.velocity_sigma_mps, above(0.0));
  pair("damping_per_s", oscillator.damping_per_s, above(0.0));
}

void read_target_model(Mapping& from, const models::World& world, models::TargetModel& model) {
  from.choice("kind", model.kind, models::all_target_kinds());
  from.integer("position_dim", model.position_dim, 2, 3);
  from.number("q", model.q, at_least(0.0));
  read_oscillator(from, world, model.oscillator);
  if (model.has_velocity() && model.position_dim != 2) {
    from.refuse("position_dim", fmt::format("must be 2 for kind {}, is 3", model.kind.name()));
  }
}

void check_grid(Mapping& from, const Scenario& scenario) {
  const double resolution_m = scenario.estimator.grid_resolution_m;
  const auto refuse_above = [&](double cells_max, const Eigen::Vector2d& size_m, const char* what) {
    const double cells = (size_m / resolution_m).array().ceil().prod();
    if (cells > cells_max) {
      from.refuse("grid_resolution_m",
                  fmt::format("must divide {} into at most {:.0f} cells; {} gives {:.0f}", what,
                              cells_max, resolution_m, cells));
    }
  };
  const Eigen::Vector2d size_m = scenario.world.bounds.max_m - scenario.world.bounds.min_m;
  refuse_above(kGridCellsMax, size_m, "world.bounds");
  const double belief_cells_max = std::floor(
      (kBeliefBytesMax - kTargetBytes * static_cast<double>(scenario.targets.size())) / kCellBytes);
  if (const double near_m = scenario.network.neighbourhood_m; near_m > 0.0) {
    refuse_above(belief_cells_max, size_m.cwiseMin(2.5 * near_m),
                 "the area of each belief (side 2.5 · network.neighbourhood_m)");
  } else {
    refuse_above(belief_cells_max, size_m, "world.bounds, which every belief covers,");
  }
}

void read_estimator(Mapping& from, Scenario& scenario) {
  EstimatorSpec& estimator = scenario.estimator;
  read_publisher(from, estimator.publisher);
  from.section("target_model", [&](Mapping& model) {
    read_target_model(model, scenario.world, estimator.target_model);
  });
  from.number("prior_position_sigma_m", estimator.prior_position_sigma_m, above(0.0));
  from.number("prior_velocity_sigma_mps", estimator.prior_velocity_sigma_mps, above(0.0));
  from.number("undiscovered_position_sigma_m", estimator.undiscovered_position_sigma_m, above(0.0));
  from.number("grid_resolution_m", estimator.grid_resolution_m, above(0.0));
  from.number("grid_memory_s", estimator.grid_memory_s, from_to(-1.0, kDurationMaxS));
  from.number("gate_sigma", estimator.gate_sigma, at_least(0.0));
  // Must be below 1: with 1, a scan without a detection would give probability 0, and its logarithm
  // would be infinite.
  from.number("detection_probability", estimator.detection_probability, from_below(0.0, 1.0));
  from.flag("targets_stay_inside", estimator.targets_stay_inside);
  from.flag("samples", estimator.samples);
  check_grid(from, scenario);
}

void read_exploration(Mapping& from, models::ExplorationSpec& exploration) {
  from.number("landmark_sigma_m", exploration.landmark_sigma_m, above(0.0));
  from.number("landmark_spacing_m", exploration.landmark_spacing_m, above(0.0));
  from.integer("landmarks_max", exploration.landmarks_max, 0, 1000);
  from.flag("until_found", exploration.until_found);
}

void read_tour(Mapping& from, TourSpec& tour) {
  from.number("horizon_s", tour.horizon_s, from_to(0.0, kDurationMaxS));
  from.number("weight", tour.weight, at_least(0.0));
  from.number("visit_s", tour.visit_s, at_least(0.0));
  from.number("region_m", tour.region_m, at_least(0.0));
}

void check_round(Mapping& from, const PlannerSpec& planner) {
  if (planner.execute_steps > planner.horizon_steps) {
    from.refuse("execute_steps", fmt::format("must be at most horizon_steps ({}), but is {}",
                                             planner.horizon_steps, planner.execute_steps));
  }
  const double round_s = planner.execute_steps * planner.step_s;
  if (planner.publish_margin_s + planner.team_budget_s > round_s) {
    from.refuse("team_budget_s",
                fmt::format("must be at most the round (execute_steps · step_s = {1} s) minus "
                            "publish_margin_s ({0}), but is {2}",
                            planner.publish_margin_s, round_s, planner.team_budget_s));
  }
}

void check_team(Mapping& from, const PlannerSpec& planner) {
  if (is_external(planner) && planner.attacks_max > 0) {
    from.refuse("attacks_max",
                fmt::format("must be 0 with algorithm: external, which sends no proposals; is {}",
                            planner.attacks_max));
  }
  if (!planner.team_algorithm.exchanges_solutions()) {
    return;
  }
  const std::string_view name = planner.team_algorithm.name();
  if (planner.objective != PlanObjective::kTracking) {
    from.refuse("team_algorithm", fmt::format("{} needs objective: tracking", name));
  }
  if (planner.algorithm != "arvi" && planner.algorithm != "rvi") {
    from.refuse("algorithm", fmt::format("must be arvi or rvi with team_algorithm: {}, which needs "
                                         "their candidates; is {}",
                                         name, planner.algorithm));
  }
  if (planner.attacks_max > 0) {
    from.refuse("attacks_max",
                fmt::format("must be 0 with team_algorithm: {}, is {}", name, planner.attacks_max));
  }
}

/// Refuses a tour together with planning methods that do not use its terminal value.
void check_tour(Mapping& from, const PlannerSpec& planner) {
  if (planner.tour.horizon_s == 0.0) {
    return;
  }
  if (planner.objective != PlanObjective::kTracking) {
    from.refuse("tour", fmt::format("horizon_s must be 0 (off) unless objective: tracking; is {}",
                                    planner.tour.horizon_s));
  }
  if (planner.team_algorithm.exchanges_solutions()) {
    from.refuse("tour", fmt::format("horizon_s must be 0 (off) with team_algorithm: {}; is {}",
                                    planner.team_algorithm.name(), planner.tour.horizon_s));
  }
}

void read_planner(Mapping& from, PlannerSpec& planner) {
  read_publisher(from, planner.publisher);
  from.choice("objective", planner.objective,
              {{"tracking", PlanObjective::kTracking}, {"mapping", PlanObjective::kMapping}});
  std::vector<std::pair<std::string_view, std::string>> searches;
  for (const std::string& name : search_names()) {
    searches.emplace_back(name, name);
  }
  searches.emplace_back(kExternalSearch, kExternalSearch);
  from.choice("algorithm", planner.algorithm, searches);
  from.integer("horizon_steps", planner.horizon_steps, 1, 100);
  from.number("step_s", planner.step_s, from_to(0.01, 60.0));
  from.integer("execute_steps", planner.execute_steps, 1, 100);
  from.number("team_budget_s", planner.team_budget_s, above(0.0));
  from.number("publish_margin_s", planner.publish_margin_s, at_least(0.0));
  from.integer("slots", planner.slots, 0, 10'000);
  if (const std::optional<Value> nodes = from.find("node_budget")) {
    planner.node_budget = nodes->integer(0, std::numeric_limits<std::int64_t>::max());
  }
  from.number("epsilon_initial", planner.epsilon_initial, at_least(0.0));
  from.number("delta_initial_m", planner.delta_initial_m, at_least(0.0));
  from.number("yaw_weight_m_per_rad", planner.yaw_weight_m_per_rad, at_least(0.0));
  from.choice("team_algorithm", planner.team_algorithm, all_team_algorithms());
  from.integer("candidates_max", planner.candidates_max, 1, 10'000);
  from.integer("attacks_max", planner.attacks_max, 0, 1000);
  from.number("separation_m", planner.separation_m, above_to(0.0, kLengthMaxM));
  from.flag("separation_from_above", planner.separation_from_above);
  from.number("obstacle_margin_m", planner.obstacle_margin_m, from_to(0.0, kLengthMaxM));
  from.number("tracking_tolerance_m", planner.tracking_tolerance_m, above_to(0.0, kLengthMaxM));
  from.section("exploration",
               [&](Mapping& exploration) { read_exploration(exploration, planner.exploration); });
  from.section("tour", [&](Mapping& tour) { read_tour(tour, planner.tour); });
  check_round(from, planner);
  check_team(from, planner);
  check_tour(from, planner);
}

/// Refuses a neighbourhood together with algorithms that use the messages of the complete team.
void check_neighbourhood(Mapping& from, const Scenario& scenario) {
  const double neighbourhood_m = scenario.network.neighbourhood_m;
  const PlannerSpec& planner = scenario.planner;
  if (neighbourhood_m == 0.0) {
    if (planner.slots > 0) {
      from.refuse("neighbourhood_m",
                  "must be above 0 with planner.slots above 0, so that robots near each other plan "
                  "in different slots");
    }
    return;
  }
  if (const double least_m = least_neighbourhood_m(scenario); neighbourhood_m < least_m) {
    from.refuse(
        "neighbourhood_m",
        fmt::format("must be 0 (off) or at least {:.4g} here: otherwise two robots can come "
                    "too close before they have exchanged plans; is {}",
                    least_m, neighbourhood_m));
  }
  if (planner.objective != PlanObjective::kTracking || planner.attacks_max > 0 ||
      planner.team_algorithm.exchanges_solutions()) {
    from.refuse("neighbourhood_m",
                "must be 0 with objective: mapping, team_algorithm: local_search or attacks_max "
                "above 0, which need the messages of the whole team");
  }
}

void read_network(Mapping& from, Scenario& scenario) {
  constexpr double kBudgetMinKbitps = 4.0;
  constexpr double kBudgetMaxKbitps = 1e6;
  constexpr double kLossMax = 0.99;
  NetworkSpec& network = scenario.network;
  from.number("communication_range_m", network.communication_range_m, from_to(-1.0, kLengthMaxM));
  from.number("neighbourhood_m", network.neighbourhood_m, from_to(0.0, kLengthMaxM));
  check_neighbourhood(from, scenario);
  from.number("budget_kbitps", network.budget_kbitps, from_to(0.0, kBudgetMaxKbitps));
  if (network.budget_kbitps > 0.0 && network.budget_kbitps < kBudgetMinKbitps) {
    from.refuse("budget_kbitps",
                fmt::format("must be 0 (unlimited) or at least {:g} kbit/s, the rate of plans and "
                            "observations alone; is {:g}",
                            kBudgetMinKbitps, network.budget_kbitps));
  }
  from.section("simulation", [&](Mapping& simulation) {
    simulation.number("loss", network.simulation.loss, from_to(0.0, kLossMax));
    simulation.number("rate_kbitps", network.simulation.rate_kbitps,
                      from_to(0.0, kBudgetMaxKbitps));
  });
  from.text("url", network.url);
  constexpr std::array<std::string_view, 2> kSchemes = {"udpm://", "memq://"};
  const bool is_known = std::any_of(kSchemes.begin(), kSchemes.end(), [&](std::string_view scheme) {
    return network.url.rfind(scheme, 0) == 0;
  });
  if (!is_known) {
    from.refuse("url", "must begin with udpm:// or memq://, is '" + network.url + "'");
  }
}

void read_security(Mapping& from, SecuritySpec& security) {
  from.require("mode");
  from.choice("mode", security.mode,
              {{"off", SecurityMode::kOff},
               {"warn", SecurityMode::kWarn},
               {"require", SecurityMode::kRequire}});
  from.text("keys", security.keys);
  if (security.mode != SecurityMode::kOff && security.keys.empty()) {
    from.refuse("keys", "must name the folder that `vantage keys new` created");
  }
}

/// Refuses a name that is unsuitable as part of the file names of logs.
void read_name(Mapping& top, std::string& name) {
  top.text("name", name);
  const bool is_file_name = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  });
  if (!is_file_name) {
    top.refuse("name", "must contain only letters, digits, - and _, is '" + name + "'");
  }
}

void read_wind(Mapping& from, WindSpec& wind) {
  constexpr double kWindMaxMps = 30.0;
  from.number("x_mps", wind.x_mps, from_to(-kWindMaxMps, kWindMaxMps));
  from.number("y_mps", wind.y_mps, from_to(-kWindMaxMps, kWindMaxMps));
  from.number("gust_sigma_mps", wind.gust_sigma_mps, from_to(0.0, kWindMaxMps));
}

/// Refuses a sensor that measures velocities together with targets whose state has none: it would
/// report rates that the target model excludes.
void check_velocity(Mapping& top, const Scenario& scenario) {
  const models::TargetModel& model = scenario.estimator.target_model;
  const auto measures = [](const RobotSpec& robot) {
    return models::measures_velocity(robot.sensor);
  };
  const auto robot = std::find_if(scenario.robots.begin(), scenario.robots.end(), measures);
  if (robot != scenario.robots.end() && !scenario.targets.empty() && !model.has_velocity()) {
    top.refuse("estimator",
               fmt::format("target_model.kind must be one with a velocity, such as "
                           "double_integrator, for the sensor of robot {}, kind {}; is {}",
                           robot->name, robot->sensor.kind.name(), model.kind.name()));
  }
}

/// Reads the scenario in `document`; `top` is the mapping of `document`. Stores the section
/// `localizer`, which Scenario does not contain, in `localizer` unless it is null.
void read_scenario(const Value& document, Mapping& top, Scenario& scenario,
                   std::optional<LocalizerSpec>* localizer = nullptr) {
  top.declare({"name", "duration_s", "seed", "world", "robot_defaults", "robots", "targets",
               "target_truth", "estimator", "planner", "mapping", "network", "mocap", "attacks",
               "hosts", "wind", "security", "localizer", "ros2"});
  for (const char* key : {"name", "world", "robots"}) {
    top.require(key);
  }
  top.finish();

  read_name(top, scenario.name);
  top.number("duration_s", scenario.duration_s, above_to(0.0, kDurationMaxS));
  if (const std::optional<Value> seed = top.find("seed")) {
    scenario.seed = seed->unsigned_integer();
  }
  top.section("world", [&](Mapping& from) { read_world(from, scenario.world); });
  top.section("wind", [&](Mapping& from) { read_wind(from, scenario.wind.emplace()); });
  top.section("planner", [&](Mapping& from) { read_planner(from, scenario.planner); });
  tolerate([&] { read_mapping_spec(top, scenario); });
  tolerate([&] { read_robots(top, scenario); });
  tolerate([&] { read_targets(top, scenario); });
  top.section("target_truth",
              [&](Mapping& from) { read_target_truth(from, scenario.target_truth); });
  if (!top.section("network", [&](Mapping& from) { read_network(from, scenario); })) {
    check_neighbourhood(top, scenario);
  }
  if (!top.section("estimator", [&](Mapping& from) { read_estimator(from, scenario); })) {
    check_grid(top, scenario);
  }
  top.section("security", [&](Mapping& from) { read_security(from, scenario.security); });
  read_mocap(top, scenario.mocap);
  top.section("ros2", [&](Mapping& from) {
    Ros2Spec checked;  // ros2_of() reads the section again
    read_ros2(from, scenario, checked);
  });
  tolerate([&] { check_without_ids(top, scenario); });
  tolerate([&] { check_velocity(top, scenario); });
  tolerate([&] { read_attacks(top, scenario); });
  tolerate([&] { read_hosts(top, scenario); });
  tolerate([&] {
    std::optional<LocalizerSpec> spec = read_localizer(top, scenario);
    check_cameras(document, scenario, spec);
    if (localizer != nullptr) {
      *localizer = std::move(spec);
    }
  });
}

}  // namespace

void read_rectangle(Mapping& from, models::Rectangle& rectangle) {
  const Range coordinate = from_to(-kLengthMaxM, kLengthMaxM);
  const std::optional<Value> min = from.find_required("min_m");
  const std::optional<Value> max = from.find_required("max_m");
  if (!min || !max) {
    return;
  }
  rectangle.min_m = min->point(coordinate);
  rectangle.max_m = max->point(coordinate);
  if (!(rectangle.min_m.array() < rectangle.max_m.array()).all()) {
    max->refuse(fmt::format("must be above min_m ([{}, {}]) in x and in y, but is [{}, {}]",
                            rectangle.min_m.x(), rectangle.min_m.y(), rectangle.max_m.x(),
                            rectangle.max_m.y()));
  }
}

Scenario load_scenario(const std::string& path) {
  return parse_scenario(read_text_file(path), path);
}

Scenario parse_scenario(const std::string& yaml, const std::string& name) {
  Scenario scenario;
  scenario.source_text = yaml;
  const Value document = parse_yaml(yaml, name);
  read_mapping({document}, [&](Mapping& top) { read_scenario(document, top, scenario); });
  return scenario;
}

std::optional<LocalizerSpec> parse_localizer(const std::string& yaml, const std::string& name) {
  Scenario scenario;
  std::optional<LocalizerSpec> localizer;
  const Value document = parse_yaml(yaml, name);
  read_mapping({document},
               [&](Mapping& top) { read_scenario(document, top, scenario, &localizer); });
  return localizer;
}

std::vector<KeyRule> keys_of_scenario(const std::string& path) {
  constexpr std::string_view kDefaults = "robot_defaults.";
  KeyTable asked;
  Value document = parse_yaml(read_text_file(path), path);
  document.keys = &asked;
  Scenario scenario;
  read_mapping({document}, [&](Mapping& top) { read_scenario(document, top, scenario); });
  KeyTable merged;
  for (KeyRule rule : asked.rules()) {
    if (rule.path.starts_with(kDefaults)) {
      rule.path.replace(0, kDefaults.size(), "robots[].");
    }
    merged.note(std::move(rule));
  }
  return merged.rules();
}

int line_of_key(const std::string& text, const std::string& path) {
  const Value document = parse_yaml(text, "");
  const Node* node = document.node.get();
  std::istringstream keys(path);
  int line = 0;
  for (std::string key; node != nullptr && std::getline(keys, key, '.');) {
    const Node* next = nullptr;
    const std::size_t entries = node->kind == Node::Kind::kMapping ? node->entry_count() : 0;
    for (std::size_t entry = 0; entry < entries; ++entry) {
      if (node->key(entry).text == key) {
        line = node->key(entry).line;
        next = &node->value(entry);
      }
    }
    node = next;
  }
  return line;
}

}  // namespace vantage::scenario
