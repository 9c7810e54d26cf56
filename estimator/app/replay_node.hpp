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

/// Does the steps of a logged estimator again: for each logged BELIEF_R, in order of `step`, the
/// same step from exactly the inputs that it names, published under the bus's prefix (and
/// MIXTURE_R). What it makes does not depend on when the log player delivers what.
///
/// A step waits for inputs that are still to come, see ReplayQueue. When inputs are missing for
/// good, or steps are missing from the log, nothing is published for that step and the filter
/// continues from the logged content, so that one loss does not spoil the rest; the first step
/// heard is such a one unless it is step 0, and so is a step with a look that belongs before the
/// last such one: the steps to be done again with it are not known.
class EstimatorReplayNode : public bus::Node {
 public:
  /// @throws UsageError when `scenario` has no such robot.
  EstimatorReplayNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                      const std::string& robot);

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  /// Those of the filter, and: steps_rebased, inputs_missing, and differences:
  /// redone steps that are not the logged ones within 1e−9 (relative to 1 + |x|).
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

  [[nodiscard]] std::int64_t steps_redone() const { return steps_redone_; }
  [[nodiscard]] std::int64_t steps_rebased() const { return steps_rebased_; }
  [[nodiscard]] std::int64_t inputs_missing() const { return inputs_missing_; }
  [[nodiscard]] std::int64_t differences() const { return differences_; }

 private:
  void work();
  /// From what is there of the inputs that `logged` names; `missing` are not.
  void redo(const models::RobotBelief& logged, const StepMaterial& material, std::int64_t missing);
  /// The inputs that `logged` names; `missing` is how many are not there.
  StepMaterial gather(const models::RobotBelief& logged, std::int64_t& missing) const;

  bus::Bus& bus_;
  FilterSpec spec_;
  DistributedFilter filter_;
  std::string robot_;
  bus::InputStore<models::DetectionSet> looks_;
  bus::InputStore<models::MocapFrame> frames_;
  bus::InputStore<models::RobotBelief> beliefs_;
  bus::ReplayQueue<models::RobotBelief> logged_;  ///< not done yet
  std::optional<models::Stamp> last_done_;
  std::int64_t last_step_ = -1;
  std::optional<Time> rebased_to_;  ///< where the filter last continued from the log
  Time next_tick_{};
  std::int64_t steps_redone_ = 0;
  std::int64_t steps_rebased_ = 0;
  std::int64_t inputs_missing_ = 0;
  std::int64_t differences_ = 0;
  std::optional<MapReplayer> map_;  ///< of a scenario that maps
};

/// True when the two say the same of the same targets and cells, numbers within
/// `tolerance` · (1 + |x|).
bool same_content(const models::RobotBelief& a, const models::RobotBelief& b, double tolerance);

}  // namespace vantage::estimator
