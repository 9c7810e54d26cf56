#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "core/time.hpp"
#include "scenario/scenario.hpp"
#include "sim/app/wire_vehicle.hpp"
#include "sim/vicon/socket_server.hpp"
#include "sim/world/world_simulation.hpp"

namespace vantage::sim {

/// vantage-sim on the bus: the world, and each device of the scenario that is simulated.
///
/// TRUTH and COLLISION are published of all bodies, whatever their devices. Of `direct` devices the
/// node speaks itself: VICON, VEHICLE_R of those that follow PLAN_R. Devices on the `wire` speak
/// their own protocols on sockets (a mocap server, an autopilot per robot), and their drivers
/// publish. `real` ones are left alone.
///
/// The world stands at the last instant published; it is stepped to each next one (a mocap capture,
/// a truth frame, a status report) when the mocap latency has passed after it, so a frame is on the
/// bus when a real one would be. What is published does not depend on how often tick() is called,
/// only on the plans and commands that were heard before it. With a vehicle on the wire the
/// world keeps up with the clock instead, in steps of 5 ms, and frames wait for the latency to
/// pass.
class SimNode : public bus::Node {
 public:
  /// @throws StartupError for a device on the wire under a clock that is not real time, or that
  ///         cannot be simulated there; UsageError as WorldSimulation does.
  SimNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario);

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
  /// ATTACK: who is jammed at `instant` by the scenario, once a second and on change.
  void publish_attack(Time instant);
  void deliver_frames(Time now);
  void serve_wires(Time now);
  [[nodiscard]] Time next_instant() const;
  [[nodiscard]] bool has_wire() const { return !wires_.empty() || mocap_server_; }

  struct Said {
    models::FlightState state = models::FlightState::kIdle;
    std::int64_t round = -1;
  };

  bus::Bus& bus_;
  const bus::Clock& clock_;
  scenario::Scenario scenario_;
  Time start_;
  std::vector<std::unique_ptr<WireVehicle>> wires_;
  std::unique_ptr<vicon::SocketServer> mocap_server_;  ///< of a mocap system on the wire
  WorldSimulation world_;
  Duration lag_;           ///< by which the world follows the clock
  Duration truth_period_;  ///< that of a real mocap, whose driver adds the simulated bodies
  Time next_capture_;
  Time next_truth_;
  Time next_status_;
  Time next_exchange_;  ///< with what is on the wire
  Time last_tick_;
  std::deque<models::MocapFrame> frames_;       ///< captured, and not yet out
  std::optional<models::AttackNotice> attack_;  ///< as last said
  Time next_attack_{};
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
