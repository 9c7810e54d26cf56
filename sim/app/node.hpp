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
#include "sim/app/localisation.hpp"
#include "sim/app/wire_vehicle.hpp"
#include "sim/vicon/socket_server.hpp"
#include "sim/world/world_simulation.hpp"

namespace vantage::sim {

/// Bus node of vantage-sim: steps the world and simulates the devices that the scenario does not
/// mark as `real`. With localizer.simulation it also publishes ODOMETRY_R and SIGHTINGS_R.
///
/// TRUTH and COLLISION are published for all simulated bodies. For `direct` devices, the node
/// itself publishes VICON and, for each robot that follows PLAN_R, VEHICLE_R. Devices with `wire`
/// use their own protocols on sockets (a mocap server, an autopilot per robot), and their drivers
/// publish these messages.
///
/// The world is stepped to the next instant of publication (a mocap capture, a truth frame, a
/// status report) when the mocap latency has passed since that instant. A frame is therefore
/// published when a real mocap would publish it. The published messages depend on the received
/// plans and commands, not on the times of tick(). With a `wire` vehicle, the world instead follows
/// the clock in steps of 5 ms, and frames are delayed until the latency has passed.
class SimNode : public bus::Node {
 public:
  /// @throws StartupError for a `wire` device if the clock is not real time or the device cannot be
  ///         emulated; UsageError as WorldSimulation does.
  SimNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario);

  [[nodiscard]] std::string name() const override { return "SIM"; }
  [[nodiscard]] Time next_tick() const override;
  /// Publishes at most kInstantsMax instants per call: after a stall the node catches up in several
  /// calls and receives messages between them.
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
  /// Returns the number of ticks that were more than a mocap period late.
  [[nodiscard]] std::int64_t deadlines_missed() const override { return late_ticks_; }

  [[nodiscard]] const WorldSimulation& world() const { return world_; }

 private:
  static constexpr int kInstantsMax = 20;

  void on_plan(const std::string& channel, const models::RobotPlan& plan);
  void publish_instant(Time instant);
  void publish_statuses(Time instant, bool is_due);
  /// Publishes ATTACK with the robots that the scenario jams at `instant`, once per second and on
  /// change.
  void publish_attack(Time instant);
  void deliver_frames(Time now);
  void serve_wires(Time now);
  [[nodiscard]] Time next_instant() const;
  [[nodiscard]] bool has_wire() const { return !wires_.empty() || mocap_server_; }

  struct LastStatus {
    models::FlightState state = models::FlightState::kIdle;
    std::int64_t round = -1;
  };

  bus::Bus& bus_;
  const bus::Clock& clock_;
  scenario::Scenario scenario_;
  Time start_;
  std::vector<std::unique_ptr<WireVehicle>> wires_;
  /// server if mocap is `wire`; null otherwise
  std::unique_ptr<vicon::SocketServer> mocap_server_;
  WorldSimulation world_;
  std::unique_ptr<SimulatedLocalisation> localisation_;  ///< null without localizer.simulation
  Duration lag_;  ///< delay of the world relative to the clock
  /// period of TRUTH; equal to the mocap period if the driver of a real mocap uses TRUTH
  Duration truth_period_;
  Time next_capture_;
  Time next_truth_;
  Time next_status_;
  Time next_exchange_;  ///< time of the next exchange with the `wire` devices
  Time last_tick_;
  std::deque<models::MocapFrame> frames_;       ///< captured frames that are not yet delivered
  std::optional<models::AttackNotice> attack_;  ///< last published notice
  Time next_attack_{};
  std::vector<LastStatus> last_statuses_;  ///< last published status of each Quadrotor
  std::int64_t late_ticks_ = 0;
  std::int64_t chunks_ = 0;
  std::int64_t not_finite_ = 0;
  std::int64_t discontinuous_ = 0;
  std::int64_t stale_ = 0;
  std::int64_t not_following_ = 0;
  std::int64_t misaddressed_ = 0;
};

}  // namespace vantage::sim
