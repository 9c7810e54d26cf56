#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "bus/node.hpp"
#include "core/time.hpp"
#include "models/scenario/scenario.hpp"
#include "sim/world/world_simulation.hpp"

namespace vantage::sim {

/// vantage-sim on the bus: PLAN_* and COMMAND in, VICON, TRUTH, COLLISION and QUADROTOR_R out.
///
/// The world stands at the last instant published; it is stepped to each next one (a mocap capture,
/// a truth frame, a status report) when the mocap latency has passed after it, so a frame is on the
/// bus when a real one would be. What is published does not depend on how often tick() is called,
/// only on the plans and commands that were heard before it.
class SimNode : public bus::Node {
 public:
  /// @throws StartupError when a device of the scenario asks for a simulated wire protocol (this
  ///         node flies `direct` devices and leaves `real` ones alone), UsageError as
  ///         WorldSimulation does.
  SimNode(bus::Bus& bus, const bus::Clock& clock, const models::Scenario& scenario);

  [[nodiscard]] std::string name() const override { return "SIM"; }
  [[nodiscard]] Time next_tick() const override;
  /// At most kInstantsMax instants: after a stall it catches up in pieces, hearing the bus between.
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
  /// Ticks that came more than a mocap period late.
  [[nodiscard]] std::int64_t deadlines_missed() const override { return late_ticks_; }

  [[nodiscard]] const WorldSimulation& world() const { return world_; }

 private:
  static constexpr int kInstantsMax = 20;

  void on_plan(const std::string& channel, const models::RobotPlan& plan);
  void publish_instant(Time instant);
  void publish_statuses(Time instant, bool is_due);
  [[nodiscard]] Time next_instant() const;

  struct Said {
    models::FlightState state = models::FlightState::kIdle;
    std::int64_t round = -1;
  };

  bus::Bus& bus_;
  models::Scenario scenario_;
  WorldSimulation world_;
  Time next_capture_;
  Time next_truth_;
  Time next_status_;
  Time last_tick_;
  std::vector<Said> said_;  ///< what each vehicle last reported
  std::int64_t late_ticks_ = 0;
  std::int64_t chunks_ = 0;
  std::int64_t not_finite_ = 0;
  std::int64_t discontinuous_ = 0;
  std::int64_t stale_ = 0;
  std::int64_t not_following_ = 0;
  std::int64_t misaddressed_ = 0;
};

}  // namespace vantage::sim
