#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// A point of a driven track.
struct TrackPoint {
  Time time{};
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
};

struct RobotScene {
  std::vector<TrackPoint> track;
  std::optional<Pose2> world_from_body;  ///< now
  std::optional<models::RobotPlan> plan;
};

struct TargetScene {
  std::vector<TrackPoint> track;  ///< true; empty when no truth is heard
  std::optional<logs::PositionEstimate> estimate;
};

/// All that a picture of a trial shows, as of `time`.
struct Scene {
  Time time{};
  std::map<std::string, RobotScene> robots;
  std::map<int, TargetScene> targets;
  models::GridGeometry grid;
  std::vector<std::int64_t> last_seen_utime;         ///< per cell, newest of any robot
  std::set<std::string> jammed;                      ///< robots
  std::optional<models::RobotMap> map;               ///< newest of any robot, of a team that maps
  std::map<std::string, double> map_entropies_nats;  ///< of each robot's newest map
};

/// Gathers a Scene from the messages of a trial; pure. Tracks are thinned to one point each
/// 0.1 s or 2 cm, whichever is rarer; one that comes to 4096 points is thinned by half from then
/// on, so that it stays whole and its memory bounded however long the trial.
class SceneRecorder {
 public:
  explicit SceneRecorder(const scenario::Scenario& scenario);
  void on_truth(const models::TruthFrame& frame);
  void on_belief(const models::RobotBelief& belief);
  void on_plan(const models::RobotPlan& plan);
  void on_map(const models::RobotMap& map);
  void on_attack(const models::AttackNotice& attack);
  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
  std::map<std::string, double> thinning_s_;  ///< of each body's track, now
  bool are_grids_parts_ = false;              ///< of the world's: beliefs of a neighbourhood
};

}  // namespace vantage::logs
