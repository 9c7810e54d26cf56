#include "logs/foxglove/values.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/index.hpp"
#include "logs/foxglove/scene.hpp"
#include "models/mapping/cell_counts.hpp"

namespace vantage::logs::foxglove {
namespace {

constexpr int kFloat32 = 7;  // FLOAT32 in foxglove.PackedElementField

void set_if_finite(Json& object, const char* key, double value) {
  if (std::isfinite(value)) {
    object[key] = value;
  }
}

Json transform(Time time, const std::string& child, const Pose3& world_from_child) {
  return {{"timestamp", to_json(time)},
          {"parent_frame_id", kWorldFrame},
          {"child_frame_id", child},
          {"translation", to_json(world_from_child.translation_m)},
          {"rotation", to_json(world_from_child.rotation)}};
}

Json point(const Eigen::Vector2d& p_m) { return Json::array({p_m.x(), p_m.y()}); }

const char* name_of(models::ProcessState state) {
  switch (state) {
    case models::ProcessState::kStarting:
      return "starting";
    case models::ProcessState::kRunning:
      return "running";
    case models::ProcessState::kDegraded:
      return "degraded";
    case models::ProcessState::kStopping:
      return "stopping";
  }
  return "";
}

Json float_grid(const models::GridGeometry& grid, const char* field,
                const std::vector<float>& values, Time time) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(values.size() * 4);
  for (const float value : values) {
    const auto word = std::bit_cast<std::uint32_t>(value);
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes.push_back(static_cast<std::uint8_t>(word >> shift & 0xFFU));
    }
  }
  const Pose3 corner{{grid.origin_m.x(), grid.origin_m.y(), 0.0}, Quaternion::Identity()};
  return {{"timestamp", to_json(time)},
          {"frame_id", kWorldFrame},
          {"pose", to_json(corner)},
          {"column_count", grid.columns},
          {"cell_size", {{"x", grid.resolution_m}, {"y", grid.resolution_m}}},
          {"row_stride", 4 * grid.columns},
          {"cell_stride", 4},
          {"fields", Json::array({{{"name", field}, {"offset", 0}, {"type", kFloat32}}})},
          {"data", base64(bytes)}};
}

void add_step_of_robots(const TrialMetrics& metrics, Json& out) {
  const RobotStep& robots = metrics.step_of_robots();
  if (const auto entropy_nats = robots.entropy_nats()) {
    set_if_finite(out, "robot_entropy_nats", *entropy_nats);
  }
  if (const auto rmse_m = robots.rmse_m()) {
    set_if_finite(out, "robot_rmse_m", *rmse_m);
  }
  Json by_age = Json::array();
  for (std::size_t i = 0; i < kAgeClasses; ++i) {
    const RobotStep::Nees& nees = robots.nees_by_age()[i];
    const double mean = nees.sum / static_cast<double>(nees.samples);
    if (nees.samples > 0 && std::isfinite(mean)) {
      by_age.push_back({{"age_s", age_name(i)}, {"samples", nees.samples}, {"mean", mean}});
    }
  }
  if (!by_age.empty()) {
    out["nees_by_age"] = std::move(by_age);
    out["nees_expected"] = metrics.position_dim();
  }
}

}  // namespace

Json frame_transforms(const models::MocapFrame& frame) {
  Json list = Json::array();
  for (const models::MocapBody& body : frame.bodies) {
    if (!body.occluded) {
      list.push_back(transform(frame.stamp.time, body.name, body.world_from_body));
    }
  }
  return {{"transforms", std::move(list)}};
}

Json frame_transforms(const models::TruthFrame& truth, const std::string& prefix) {
  Json list = Json::array();
  for (const models::TruthBody& body : truth.bodies) {
    list.push_back(transform(truth.stamp.time, prefix + body.name, body.world_from_body));
  }
  return {{"transforms", std::move(list)}};
}

Json visibility_grid(const models::GridGeometry& grid,
                     const std::vector<std::int64_t>& last_seen_utime, Time time) {
  std::vector<float> ages_s;
  ages_s.reserve(last_seen_utime.size());
  for (const std::int64_t seen : last_seen_utime) {
    const bool is_seen = seen != models::VisibilityGrid::kNeverSeen;
    ages_s.push_back(is_seen ? static_cast<float>(to_seconds(time - from_utime(seen))) : -1.0F);
  }
  return float_grid(grid, "age_s", ages_s, time);
}

Json occupancy_grid(const models::RobotMap& map, const models::MappingSpec& spec) {
  const models::OccupancyBelief belief = models::belief_of(map.grid, map.team_looks, spec);
  std::vector<float> occupancies;
  occupancies.reserve(map.team_looks.size());
  for (int cell = 0; cell < map.grid.size(); ++cell) {
    occupancies.push_back(static_cast<float>(belief.occupancy(cell)));
  }
  return float_grid(map.grid, "occupancy", occupancies, map.stamp.time);
}

Json scenario_json(const models::ScenarioNotice& notice, const scenario::Scenario& scenario) {
  const models::Rectangle& bounds = scenario.world.bounds;
  const bool is_mapping = scenario.planner.objective == scenario::PlanObjective::kMapping;
  Json robots = Json::array();
  for (const scenario::RobotSpec& robot : scenario.robots) {
    robots.push_back({{"name", robot.name},
                      {"color", to_json(robot_colour(scenario, robot.name).value())},
                      {"height_m", robot.height_m},
                      {"radius_m", robot.limits.radius_m},
                      {"sensor_range_m", robot.sensor.range_max_m},
                      {"fov_rad", robot.sensor.fov_rad}});
  }
  Json targets = Json::array();
  for (const scenario::TargetSpec& target : scenario.targets) {
    targets.push_back({{"name", target.name}, {"id", target.id}, {"radius_m", target.radius_m}});
  }
  return {{"timestamp", to_json(notice.stamp.time)},
          {"name", scenario.name},
          {"version", notice.version},
          {"process", notice.process},
          {"session", fmt::format("{:x}", notice.stamp.run_id)},
          {"yaml", notice.yaml},
          {"objective", is_mapping ? "mapping" : "tracking"},
          {"grid_memory_s", scenario.estimator.grid_memory_s},
          {"duration_s", scenario.duration_s},
          {"ceiling_m", scenario.world.ceiling_m},
          {"bounds", {{"min_m", point(bounds.min_m)}, {"max_m", point(bounds.max_m)}}},
          {"robots", std::move(robots)},
          {"targets", std::move(targets)}};
}

Json plan_json(const models::RobotPlan& plan) {
  Json out{{"timestamp", to_json(plan.stamp.time)},
           {"robot", plan.robot},
           {"round", plan.round},
           {"source", name_of(plan.source)},
           {"passes", plan.passes},
           {"nodes", plan.nodes},
           {"margin_s", to_seconds(plan.deadline - plan.finish)},
           {"late", plan.late}};
  set_if_finite(out, "cost_nat", plan.cost);
  set_if_finite(out, "lower_bound_nat", plan.lower_bound);
  set_if_finite(out, "gap_nat", plan.cost - plan.lower_bound);
  set_if_finite(out, "epsilon", plan.epsilon);
  set_if_finite(out, "delta_m", plan.delta_m);
  return out;
}

Json vehicle_json(const models::VehicleStatus& status,
                  std::optional<Duration> capture_to_setpoint) {
  Json out{{"timestamp", to_json(status.stamp.time)},
           {"robot", status.robot},
           {"state", name_of(status.state)},
           {"battery_share", status.battery_share},
           {"plan_round", status.plan_round},
           {"setpoint",
            {{"x_m", status.setpoint.x_m},
             {"y_m", status.setpoint.y_m},
             {"yaw_rad", status.setpoint.yaw_rad},
             {"height_m", status.setpoint_height_m}}},
           {"reasons", status.reasons}};
  if (capture_to_setpoint) {
    out["capture_to_setpoint_s"] = to_seconds(*capture_to_setpoint);
  }
  return out;
}

Json health_json(const models::ProcessHealth& health) {
  Json counters = Json::array();
  std::int64_t lost = 0;
  for (const models::NamedCount& counter : health.counters) {
    counters.push_back({{"name", counter.name}, {"count", counter.count}});
    lost += counter.name.ends_with(".lost") ? counter.count : 0;
  }
  return {{"timestamp", to_json(health.stamp.time)},
          {"process", health.process},
          {"state", name_of(health.state)},
          {"loops", health.loops},
          {"loop_worst_s", health.loop_worst_s},
          {"deadlines_missed", health.deadlines_missed},
          {"messages_lost", lost},
          {"counters", std::move(counters)}};
}

Json attack_json(const models::AttackNotice& attack) {
  return {{"timestamp", to_json(attack.stamp.time)}, {"jammed", attack.jammed}};
}

Json team_json(const TrialMetrics& metrics, Time time) {
  double entropy_nats = 0.0;
  double squares_m2 = 0.0;
  std::int64_t errors = 0;
  std::int64_t known = 0;
  for (const TargetStatus& target : metrics.targets()) {
    entropy_nats += target.entropy_nats;
    known += target.estimate ? 1 : 0;
    if (target.error_m) {
      squares_m2 += *target.error_m * *target.error_m;
      ++errors;
    }
  }
  Json out{{"timestamp", to_json(time)},
           {"known", known},
           {"targets", metrics.targets().size()},
           {"collisions", metrics.collisions()},
           {"separation_violations", metrics.separation_violations()},
           {"rounds", metrics.rounds()},
           {"rounds_late", metrics.rounds_late()},
           {"messages_lost", metrics.messages_lost()}};
  if (!metrics.targets().empty()) {
    set_if_finite(out, "entropy_nats",
                  entropy_nats / static_cast<double>(metrics.targets().size()));
  }
  if (metrics.map_entropy_nats()) {
    set_if_finite(out, "map_entropy_nats", *metrics.map_entropy_nats());
  }
  if (errors > 0) {
    set_if_finite(out, "rmse_m", std::sqrt(squares_m2 / static_cast<double>(errors)));
  }
  add_step_of_robots(metrics, out);
  return out;
}

Json targets_json(const TrialMetrics& metrics, const std::vector<TargetStory>& stories,
                  const std::map<int, Sighting>& sightings, double unknown_until_s, Time time) {
  Json targets = Json::array();
  for (int id = 0; id < std::ssize(metrics.targets()); ++id) {
    const TargetStatus& target = metrics.targets()[index(id)];
    Json out{{"name", target.name}, {"state", name_of(stories[index(id)].state())}};
    if (target.discovered_s && *target.discovered_s >= unknown_until_s) {
      out["found_s"] = *target.discovered_s;
      out["found_by"] = target.discovered_by;
    }
    if (target.error_m) {
      set_if_finite(out, "error_m", *target.error_m);
    }
    if (target.estimate) {
      set_if_finite(out, "sigma_m", target.estimate->sigma_m());
      out["unseen_s"] = to_seconds(target.estimate->time - target.estimate->last_seen);
    }
    if (const auto seen = sightings.find(id); seen != sightings.end()) {
      out["seen_by"] = seen->second.robot;
      out["unseen_s"] = std::max(0.0, to_seconds(time - seen->second.time));
    } else if (target.estimate) {
      out["seen_by"] = target.estimate->robot;
    }
    targets.push_back(std::move(out));
  }
  return {{"timestamp", to_json(time)}, {"targets", std::move(targets)}};
}

Json log_json(const Event& event) {
  return {{"timestamp", to_json(event.time)},
          {"level", static_cast<int>(event.level)},
          {"message", event.text},
          {"name", event.kind},
          {"file", ""},
          {"line", 0}};
}

}  // namespace vantage::logs::foxglove
