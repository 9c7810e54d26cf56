#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/neighbour_watch.hpp"
#include "bus/node/node.hpp"
#include "estimator/app/map_step.hpp"
#include "estimator/app/step_material.hpp"
#include "estimator/exchange/belief_sender.hpp"
#include "estimator/filter/distributed_filter.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// Bus node of a DistributedFilter. Inputs are the team's MEASUREMENT_*, VICON and the teammates'
/// BELIEF_*. With network.budget_kbitps, the node receives COMPACT_BELIEF_* instead of BELIEF_* and
/// also publishes COMPACT_BELIEF_R, with the parts that a BeliefSender selects. The node publishes
/// MIXTURE_R for beliefs that are not Gaussian, then BELIEF_R and, in a mapping scenario, MAP_R.
/// The filter decides which teammates' observations are in range. If neighbourhoods are used, the
/// node subscribes only to teammates in the robot's neighbourhood.
///
/// A step belongs to the instant t = kτ of absolute time and is computed τ/10 later, so that the
/// measurement of t has arrived. The robot's own observation may arrive later, because it is
/// computed from a mocap frame, which has latency. The step then waits for this observation, and
/// τ/100 more for the teammates' observations, but at most until t + τ/6. The published belief has
/// `utime` = t, `step` = the number of steps since the start, and the names of all messages used.
/// Later observations are used in the next step. The newest beliefs are used until they are stale;
/// a compact belief has only parts of a belief, and is used in one step.
class EstimatorNode : public bus::Node {
 public:
  /// Returns the beliefs of the targets at time t, sorted by target_id, including the observations
  /// of the step.
  using BeliefOverride = std::function<std::vector<models::TargetBelief>(
      Time t, const std::vector<NamedMessage<models::RobotMeasurement>>& measurements)>;

  /// @param belief_override if not empty, the node publishes the beliefs that this function returns
  /// instead of the filter's
  /// @throws UsageError when `scenario` has no such robot.
  EstimatorNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                const std::string& robot, BeliefOverride belief_override = {});

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] Time next_tick() const override;
  void tick(Time now) override;
  /// Returns the filter's counters and those of the node. looks_overflowed: observations dropped
  /// from a full queue. beliefs_overflowed: compact beliefs dropped from a full queue.
  /// grids_too_large: compact beliefs whose grid is too large. misaddressed: messages with a robot
  /// name that differs from that of their channel. viewpoint_unknown: steps that used the robot's
  /// last known viewpoint.
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
  /// Returns the number of instants kτ without a step.
  [[nodiscard]] std::int64_t deadlines_missed() const override { return instants_missed_; }

  [[nodiscard]] const DistributedFilter& filter() const { return filter_; }

 private:
  void subscribe_measurements(const std::string& sender);
  void subscribe_teammate(const std::string& teammate);
  void on_measurement(const std::string& sender,
                      const std::shared_ptr<const models::RobotMeasurement>& look);
  void on_mocap(const models::MocapFrame& frame);
  void on_belief(const std::string& teammate,
                 const std::shared_ptr<const models::RobotBelief>& belief);
  void on_compact_belief(const std::string& teammate, const models::CompactBelief& belief);
  void send_compact_belief(const models::RobotBelief& own, const StepMaterial& material);
  StepMaterial gather(Time t);

  bus::Bus& bus_;
  const bus::Clock& clock_;
  DistributedFilter filter_;
  BeliefOverride belief_override_;
  std::string robot_;
  std::size_t
      mocap_index_;  ///< index in a mocap frame at which the search for the robot's body begins
  Duration step_;
  Duration lag_;
  Duration lag_max_;
  Time next_instant_{};
  Time last_own_measurement_{};           ///< instant of the robot's newest own observation
  Time last_own_measurement_received_{};  ///< time at which the newest own observation was received
  std::int64_t steps_ = 0;
  std::deque<NamedMessage<models::RobotMeasurement>> measurements_;  ///< observations not yet used
  std::deque<NamedMessage<OwnPose>> poses_;  ///< robot's mocap poses, newest last
  std::map<std::string, NamedMessage<models::RobotBelief>> newest_;  ///< newest belief, by teammate
  std::optional<BeliefSender> sender_;                               ///< only with a budget
  std::vector<NamedMessage<models::RobotBelief>> partial_;  ///< compact beliefs not used yet
  std::optional<MapPublisher> map_;                         ///< only in a mapping scenario
  std::optional<bus::NeighbourWatch> neighbours_;
  std::int64_t instants_missed_ = 0;
  std::int64_t looks_overflowed_ = 0;
  std::int64_t misaddressed_ = 0;
  std::int64_t viewpoint_unknown_ = 0;
  std::int64_t beliefs_overflowed_ = 0;
  std::int64_t grids_too_large_ = 0;
};

}  // namespace vantage::estimator
