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
#include "estimator/filter/distributed_filter.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// Bus node that repeats the steps of a logged estimator. For each logged BELIEF_R, in order of
/// `step`, it computes the step from exactly the inputs that this BELIEF_R names. It publishes the
/// resulting BELIEF_R and MIXTURE_R under the bus's prefix. The result does not depend on when the
/// log player delivers messages.
///
/// A step waits for inputs that have not arrived yet, see ReplayQueue. When inputs are missing
/// permanently, or steps are missing from the log, the step is not published. The filter then
/// continues from the logged belief (it is rebased), so that one loss does not affect all later
/// steps. The filter is also rebased at the first step received, unless that is step 0. If a step
/// uses an observation made at or before the last rebase, the filter is rebased again. The steps
/// that would include the observation are then not available.
class EstimatorReplayNode : public bus::Node {
 public:
  /// @throws UsageError when `scenario` has no such robot.
  EstimatorReplayNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                      const std::string& robot);

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  /// Returns the filter's counters and these: steps_rebased, inputs_missing and differences.
  /// `differences` counts recomputed steps that differ from the logged ones by more than 1e−9
  /// relative to 1 + |x|.
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

  [[nodiscard]] std::int64_t steps_redone() const { return steps_redone_; }
  [[nodiscard]] std::int64_t steps_rebased() const { return steps_rebased_; }
  [[nodiscard]] std::int64_t inputs_missing() const { return inputs_missing_; }
  [[nodiscard]] std::int64_t differences() const { return differences_; }

 private:
  void work();
  /// Recomputes the step of `logged` from its inputs. If `missing` > 0, it rebases the filter
  /// instead.
  void recompute(const models::RobotBelief& logged, const StepMaterial& material,
                 std::int64_t missing);
  /// Returns the available inputs named by `logged`; `missing` receives the number of absent ones.
  StepMaterial gather(const models::RobotBelief& logged, std::int64_t& missing) const;

  bus::Bus& bus_;
  FilterSpec spec_;
  DistributedFilter filter_;
  std::string robot_;
  bus::InputStore<models::RobotMeasurement> measurements_;
  bus::InputStore<models::MocapFrame> frames_;
  bus::InputStore<models::RobotBelief> beliefs_;
  bus::ReplayQueue<models::RobotBelief> logged_;  ///< beliefs not recomputed yet
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

/// True if both beliefs have the same targets and grid cells, and all numbers agree within
/// `tolerance` · (1 + |x|).
bool same_content(const models::RobotBelief& a, const models::RobotBelief& b, double tolerance);

}  // namespace vantage::estimator
