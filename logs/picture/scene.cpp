#include "logs/picture/scene.hpp"

#include <algorithm>
#include <limits>

namespace vantage::logs {
namespace {

constexpr double kThinning_s = 0.1;
constexpr double kThinning_m = 0.02;
constexpr std::size_t kBodiesMax = 4096;
// maximum number of points of a track: about seven minutes of motion with the initial thinning
constexpr std::size_t kPointsMost = 4096;

// Removes every second point of a track.
void thin(std::vector<TrackPoint>& track) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < track.size(); i += 2) {
    track[kept++] = track[i];
  }
  track.resize(kept);
}

// Adds a point. A full track is thinned and its interval doubled, because a trial may last for
// days.
void extend(std::vector<TrackPoint>& track, double& thinning_s, Time time,
            const Eigen::Vector2d& position_m) {
  const bool keep = track.empty() || (to_seconds(time - track.back().time) >= thinning_s &&
                                      (position_m - track.back().position_m).norm() >= kThinning_m);
  if (!keep) {
    return;
  }
  if (track.size() == kPointsMost) {
    thin(track);
    thinning_s *= 2.0;
  }
  track.push_back({time, position_m});
}

}  // namespace

SceneRecorder::SceneRecorder(const scenario::Scenario& scenario)
    : has_partial_grids_(scenario.network.neighbourhood_m > 0.0) {
  if (has_partial_grids_) {
    scene_.grid =
        models::GridGeometry::covering(scenario.world.bounds, scenario.estimator.grid_resolution_m);
    scene_.last_seen_utime.assign(static_cast<std::size_t>(scene_.grid.size()),
                                  models::VisibilityGrid::kNeverSeen);
  }
  for (const scenario::RobotSpec& robot : scenario.robots) {
    scene_.robots[robot.name];
  }
  for (const scenario::TargetSpec& target : scenario.targets) {
    scene_.targets[target.id];
  }
}

void SceneRecorder::on_truth(const models::TruthFrame& frame) {
  scene_.time = std::max(scene_.time, frame.stamp.time);
  for (const models::TruthBody& body : frame.bodies) {
    const bool is_known = thinning_s_.contains(body.name) || thinning_s_.size() < kBodiesMax;
    const bool has_room = body.target_id < 0 || scene_.targets.contains(body.target_id) ||
                          scene_.targets.size() < kBodiesMax;
    if (!is_known || !has_room) {
      continue;
    }
    const Pose2 pose = flatten(body.world_from_body);
    double& thinning_s = thinning_s_.try_emplace(body.name, kThinning_s).first->second;
    if (body.target_id >= 0) {
      extend(scene_.targets[body.target_id].track, thinning_s, frame.stamp.time, pose.position_m());
    } else {
      RobotScene& robot = scene_.robots[body.name];
      extend(robot.track, thinning_s, frame.stamp.time, pose.position_m());
      robot.world_from_body = pose;
    }
  }
}

void SceneRecorder::on_belief(const models::RobotBelief& belief) {
  scene_.time = std::max(scene_.time, belief.stamp.time);
  if (!has_partial_grids_ && !(scene_.grid == belief.grid)) {
    scene_.grid = belief.grid;
    scene_.last_seen_utime = belief.last_seen_utime;
    return;
  }
  models::merge_stamps(scene_.grid, scene_.last_seen_utime, belief.grid, belief.last_seen_utime,
                       std::numeric_limits<std::int64_t>::max());
}

void SceneRecorder::on_map(const models::RobotMap& map) {
  scene_.time = std::max(scene_.time, map.stamp.time);
  scene_.map_entropies_nats[map.robot] = map.entropy_nats;
  scene_.map = map;
}

void SceneRecorder::on_attack(const models::AttackNotice& attack) {
  scene_.jammed = {attack.jammed.begin(), attack.jammed.end()};
}

void SceneRecorder::on_plan(const models::RobotPlan& plan) {
  scene_.robots[plan.robot].plan = plan;
}

}  // namespace vantage::logs
