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
#include "estimator/distributed_filter.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// Joins a DistributedFilter to the bus: the team's MEASUREMENT_*, VICON and the teammates'
/// BELIEF_* in, BELIEF_R out, before it MIXTURE_R of what in it is no Gaussian; in a scenario that
/// maps, MAP_R after it. Which teammates' looks are
/// in range is the filter's business; in a neighbourhood, only those within it are listened to.
///
/// A step is of the instant t = kτ of the absolute time, and is made a tenth of τ later so that
/// the measurement of that instant has come. Where the own looks come later than that (they need
/// a mocap frame that is old when it arrives) it waits for this one up to a sixth of τ, and a
/// hundredth more for the teammates'. Its message says `utime` = t, `step` = steps made
/// since the start, and names every message it used. Later looks wait for the next step; newest
/// beliefs are used until they are stale.
class EstimatorNode : public bus::Node {
 public:
  /// What is believed of the targets at t, by ascending target_id, after the looks of its step.
  using Believe = std::function<std::vector<models::TargetBelief>(
      Time t, const std::vector<Heard<models::DetectionSet>>& looks)>;

  /// @param believe  said instead of what the filter believes of the targets; none: the filter's
  /// @throws UsageError when `scenario` has no such robot.
  EstimatorNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                const std::string& robot, Believe believe = {});

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] Time next_tick() const override;
  void tick(Time now) override;
  /// Those of the filter, and: looks_overflowed (more waited than fit), misaddressed (a robot's
  /// name inside a message is not that of its channel), viewpoint_unknown (steps that had to take
  /// the robot to be where it was).
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
  /// Instants kτ that passed without a step.
  [[nodiscard]] std::int64_t deadlines_missed() const override { return instants_missed_; }

  [[nodiscard]] const DistributedFilter& filter() const { return filter_; }

 private:
  void listen_to_looks_of(const std::string& looker);
  void listen_to(const std::string& teammate);
  void on_look(const std::string& looker, const std::shared_ptr<const models::DetectionSet>& look);
  void on_mocap(const models::MocapFrame& frame);
  void on_belief(const std::string& teammate,
                 const std::shared_ptr<const models::RobotBelief>& belief);
  StepMaterial gather(Time t);

  bus::Bus& bus_;
  const bus::Clock& clock_;
  DistributedFilter filter_;
  Believe believe_;
  std::string robot_;
  std::size_t mocap_index_;  ///< where frames have the robot, most likely
  Duration step_;
  Duration lag_;
  Duration lag_max_;
  Time next_instant_{};
  Time last_own_look_{};        ///< the newest one's instant
  Time last_own_look_heard_{};  ///< and when it came
  std::int64_t steps_ = 0;
  std::deque<Heard<models::DetectionSet>> looks_;             ///< not used yet
  std::deque<Heard<OwnPose>> poses_;                          ///< newest last
  std::map<std::string, Heard<models::RobotBelief>> newest_;  ///< by teammate
  std::optional<MapPublisher> map_;                           ///< of a scenario that maps
  std::optional<bus::NeighbourWatch> neighbours_;
  std::int64_t instants_missed_ = 0;
  std::int64_t looks_overflowed_ = 0;
  std::int64_t misaddressed_ = 0;
  std::int64_t viewpoint_unknown_ = 0;
};

}  // namespace vantage::estimator
