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
#include "localizer/app/pose_step.hpp"
#include "scenario/scenario.hpp"

namespace vantage::localizer {

/// Bus node that repeats the steps of a logged localizer. For each logged POSE_R, in order of
/// `step`, it computes the step from exactly the inputs that this POSE_R names, and publishes the
/// result under the bus's prefix. The result does not depend on when the log player delivers
/// messages.
///
/// A step waits for inputs that have not arrived yet, see ReplayQueue. POSE_R does not contain the
/// joint filter, so the replay begins at step 0 of a run. If an input or a step is missing, no
/// steps are replayed until the next step 0.
class LocalizerReplayNode : public bus::Node {
 public:
  /// @throws UsageError when `scenario` or its section `localizer` has no such robot.
  LocalizerReplayNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                      const std::string& robot);

  [[nodiscard]] std::string name() const override { return "REPLAY_LOCALIZER_" + robot_; }
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  /// Returns the counters of PoseSteps and these. inputs_missing: inputs that never arrived.
  /// steps_skipped: steps that were not replayed because an input or an earlier step was missing.
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  template <class Message>
  void keep(const bus::Channel<Message>& channel, bus::InputStore<Message>& store);
  void work();
  /// Recomputes one step. Returns false while an input is missing.
  bool recompute(const models::PoseEstimate& logged, bool is_last_chance);

  bus::Bus& bus_;
  const scenario::Scenario scenario_;
  std::string robot_;
  std::optional<PoseSteps> steps_;  ///< absent: the next step cannot be recomputed
  std::vector<std::string> teammates_;
  bus::InputStore<models::OdometryReport> odometry_{256};
  bus::InputStore<models::SightingReport> sightings_{256};
  bus::InputStore<models::PoseEstimate> estimates_{256};
  bus::InputStore<models::MocapFrame> frames_{512};
  bus::ReplayQueue<models::PoseEstimate> logged_;  ///< poses not recomputed yet
  std::int64_t run_id_ = 0;
  std::int64_t next_step_ = 0;
  Time next_tick_;
  std::int64_t inputs_missing_ = 0;
  std::int64_t steps_skipped_ = 0;
};

}  // namespace vantage::localizer
