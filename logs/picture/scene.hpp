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

/// One point of a body's track.
struct TrackPoint {
  Time time{};
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
};

struct RobotScene {
  std::vector<TrackPoint> track;
  std::optional<Pose2> world_from_body;  ///< newest pose of the body
  std::optional<models::RobotPlan> plan;
};

struct TargetScene {
  std::vector<TrackPoint> track;  ///< true path; empty without truth messages
  std::optional<logs::PositionEstimate> estimate;
};

/// Content of a picture of a trial at `time`.
struct Scene {
  Time time{};
  std::map<std::string, RobotScene> robots;
  std::map<int, TargetScene> targets;
  models::GridGeometry grid;
  /// µs; time of the newest scan of each cell by any robot
  std::vector<std::int64_t> last_seen_utime;
  std::set<std::string> jammed;         ///< names of the jammed robots
  std::optional<models::RobotMap> map;  ///< newest map of any robot; nullopt if no robot maps
  std::map<std::string, double> map_entropies_nats;  ///< entropy of each robot's newest map
};

/// Collector of a Scene from the messages of a trial. Tracks are thinned to one point per 0.1 s or
/// 2 cm, whichever is rarer. When a track reaches 4096 points, every second point is removed and
/// the interval is doubled. So tracks stay complete with bounded memory in trials of any length.
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
  std::map<std::string, double> thinning_s_;  ///< current thinning interval of each body's track
  /// True if beliefs cover parts of the world's grid only (neighbourhoods).
  bool has_partial_grids_ = false;
};

}  // namespace vantage::logs
