#include "python/task/task_picture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/index.hpp"
#include "logs/picture/picture.hpp"

namespace vantage::python {
namespace {

// Log-odds of one count in a drawn map, as a share of the limit of the log-odds. This is fine
// enough for eight shades.
constexpr double kCountShare = 1e-3;

logs::TrialSummary summary_of(const TeamTask& task, const std::string& title, double step_s) {
  logs::TrialSummary summary;
  summary.seed = task.seed();
  summary.scenario = title;
  summary.duration_s = task.steps() * step_s;
  summary.entropy_nats = task.entropy_nats();
  return summary;
}

Time time_of(const TeamTask& task, double step_s) {
  return Time{} + from_seconds(task.steps() * step_s);
}

}  // namespace

std::string TaskPicture::draw(const TeamTask& task, const std::string& title) {
  follow_episode(task);
  const auto* const tracking = dynamic_cast<const TrackingTask*>(&task);
  return tracking != nullptr ? draw_tracking(*tracking, title)
                             : draw_mapping(dynamic_cast<const MappingTask&>(task), title);
}

void TaskPicture::follow_episode(const TeamTask& task) {
  if (seed_ != task.seed() || task.steps() < steps_) {
    scene_ = {};
    seed_ = task.seed();
  }
  steps_ = task.steps();
  scene_.jammed.clear();
}

void TaskPicture::add_track_point(std::vector<logs::TrackPoint>& track,
                                  const Eigen::Vector2d& position_m) const {
  if (track.empty() || track.back().time != scene_.time) {
    track.push_back({scene_.time, position_m});
  }
}

void TaskPicture::add_robots(scenario::Scenario& scenario, const TeamTask& task,
                             const std::vector<Pose2>& poses, const models::SensorModel& sensor) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    scenario::RobotSpec robot;
    robot.name = fmt::format("robot_{}", i);
    robot.sensor = sensor;
    logs::RobotScene& shown = scene_.robots[robot.name];
    shown.world_from_body = poses[i];
    add_track_point(shown.track, poses[i].position_m());
    if (task.jammed()[i] != 0) {
      scene_.jammed.insert(robot.name);
    }
    scenario.robots.push_back(std::move(robot));
  }
}

std::string TaskPicture::draw_tracking(const TrackingTask& task, const std::string& title) {
  const double step_s = task.spec().targets.step_s;
  scene_.time = time_of(task, step_s);
  scenario::Scenario scenario;
  scenario.world = task.world();
  add_robots(scenario, task, task.poses(), task.spec().sensor);
  logs::TrialSummary summary = summary_of(task, title, step_s);
  const std::vector<models::Gaussian>& beliefs = task.targets().beliefs();
  double squares_m2 = 0.0;
  for (std::size_t m = 0; m < beliefs.size(); ++m) {
    const int id = static_cast<int>(m);
    scenario.targets.push_back({fmt::format("T{}", m), id, std::nullopt});
    const Eigen::Vector2d truth_m = task.targets().truth()[m].head<2>();
    logs::TargetScene& shown = scene_.targets[id];
    add_track_point(shown.track, truth_m);
    logs::PositionEstimate& estimate = shown.estimate.emplace();
    estimate.time = scene_.time;
    estimate.mean_m = beliefs[m].mean.head(2);
    estimate.covariance_m2 = beliefs[m].covariance.topLeftCorner(2, 2);
    const double error_m = (beliefs[m].mean.head<2>() - truth_m).norm();
    squares_m2 += error_m * error_m;
    summary.discovery_time_s.emplace_back(0.0);  // all targets are known from the start
    summary.rmse_per_target_m.emplace_back(error_m);
    summary.entropy_per_target_nats.push_back(models::entropy_nats(beliefs[m]));
  }
  summary.targets = summary.discovered = static_cast<int>(beliefs.size());
  summary.rmse_m = std::sqrt(squares_m2 / static_cast<double>(beliefs.size()));
  return logs::draw_picture(scenario, scene_, summary, logs::KeyNumbers::kEstimate);
}

std::string TaskPicture::draw_mapping(const MappingTask& task, const std::string& title) {
  const double step_s = task.setup().search.step_s;
  scene_.time = time_of(task, step_s);
  scenario::Scenario scenario;
  scenario.world = task.setup().world;
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  models::SensorModel scanner;
  scanner.range_max_m = task.setup().scanner.range_max_m;
  scanner.fov_rad = task.setup().scanner.field_of_view_rad;
  add_robots(scenario, task, task.ground().poses(), scanner);
  // A map is drawn from counts of scans; the counts are chosen to give the log-odds of the task.
  const models::OccupancyBelief& belief = task.ground().map();
  const double count_log_odds = kCountShare * task.setup().clamp_log_odds;
  scenario.mapping.look_probability = models::probability_of(count_log_odds);
  scenario.mapping.settled_probability = models::probability_of(task.setup().clamp_log_odds);
  models::RobotMap& map = scene_.map.emplace();
  map.grid = belief.geometry();
  for (int cell = 0; cell < map.grid.size(); ++cell) {
    map.team_looks.push_back(
        static_cast<std::int16_t>(std::lround(belief.log_odds(cell) / count_log_odds)));
  }
  logs::TrialSummary summary = summary_of(task, title, step_s);
  summary.map_entropy_nats = task.entropy_nats();
  for (const scenario::RobotSpec& robot : scenario.robots) {
    scene_.map_entropies_nats[robot.name] = task.entropy_nats();
  }
  return logs::draw_picture(scenario, scene_, summary, logs::KeyNumbers::kEstimate);
}

}  // namespace vantage::python
