#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/input_store.hpp"
#include "bus/node/node.hpp"
#include "bus/node/replay_queue.hpp"
#include "estimator/app/map_step.hpp"
#include "estimator/app/step_material.hpp"
#include "estimator/distributed_filter.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// Bus node that repeats the steps of a logged estimator. For each logged BELIEF_R, in order of
/// `step`, it computes the step from exactly the inputs named in it. It publishes the result, and
/// MIXTURE_R, under the bus's prefix. The result does not depend on the delivery times of the log
/// player.
///
/// A step waits for inputs that are still to come, see ReplayQueue. When inputs are missing
/// permanently, or steps are missing from the log, the step is not published. The filter then
/// continues from the logged content (it is rebased), so that one loss does not affect all later
/// steps. The first step received is treated in this way unless it is step 0. So is a step with an
/// observation at or before the last rebase, because the steps to repeat with it are unknown.
class EstimatorReplayNode : public bus::Node {
 public:
  /// @throws UsageError when `scenario` has no such robot.
  EstimatorReplayNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                      const std::string& robot);

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  /// Returns the filter's counters and: steps_rebased, inputs_missing, and differences (repeated
  /// steps that differ from the logged ones by more than 1e−9, relative to 1 + |x|).
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

  [[nodiscard]] std::int64_t steps_redone() const { return steps_redone_; }
  [[nodiscard]] std::int64_t steps_rebased() const { return steps_rebased_; }
  [[nodiscard]] std::int64_t inputs_missing() const { return inputs_missing_; }
  [[nodiscard]] std::int64_t differences() const { return differences_; }

 private:
  void work();
  /// Repeats the step of `logged` from the available inputs; `missing` inputs are absent.
  void recompute(const models::RobotBelief& logged, const StepMaterial& material,
                 std::int64_t missing);
  /// Returns the available inputs named by `logged`; `missing` receives the number of absent ones.
  StepMaterial gather(const models::RobotBelief& logged, std::int64_t& missing) const;

  bus::Bus& bus_;
  FilterSpec spec_;
  DistributedFilter filter_;
  std::string robot_;
  bus::InputStore<models::RobotMeasurement> looks_;
  bus::InputStore<models::MocapFrame> frames_;
  bus::InputStore<models::RobotBelief> beliefs_;
  bus::ReplayQueue<models::RobotBelief> logged_;  ///< not repeated yet
  std::optional<models::Stamp> last_done_;
  std::int64_t last_step_ = -1;
  std::optional<Time> rebased_to_;  ///< instant at which the filter last continued from the log
  Time next_tick_{};
  std::int64_t steps_redone_ = 0;
  std::int64_t steps_rebased_ = 0;
  std::int64_t inputs_missing_ = 0;
  std::int64_t differences_ = 0;
  std::optional<MapReplayer> map_;  ///< only in a mapping scenario
};

/// True if the two have the same targets and cells with equal content, numbers within `tolerance` ·
/// (1 + |x|).
bool same_content(const models::RobotBelief& a, const models::RobotBelief& b, double tolerance);

}  // namespace vantage::estimator
