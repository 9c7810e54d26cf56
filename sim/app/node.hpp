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

/// Bus node of vantage-sim: steps the world and simulates the devices that the scenario does not
/// mark as `real`.
///
/// TRUTH and COLLISION are published for all bodies, whatever their device. For `direct` devices
/// the node itself publishes VICON and, for each robot that follows PLAN_R, VEHICLE_R. Devices on
/// the `wire` use their own protocols on sockets (a mocap server, an autopilot per robot), and
/// their drivers publish.
///
/// The world is stepped to each next instant of publication (a mocap capture, a truth frame, a
/// status report) when the mocap latency has passed after that instant. A frame is therefore on the
/// bus when a real one would be. The published messages do not depend on how often tick() is
/// called, only on the plans and commands received before it. With a vehicle on the wire the world
/// instead follows the clock in steps of 5 ms, and frames are held until the latency has passed.
class SimNode : public bus::Node {
 public:
  /// @throws StartupError for a device on the wire under a clock that is not real time, or that
  ///         cannot be simulated there; UsageError as WorldSimulation does.
  SimNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario);

  [[nodiscard]] std::string name() const override { return "SIM"; }
  [[nodiscard]] Time next_tick() const override;
  /// Publishes at most kInstantsMax instants: after a stall it catches up in pieces and receives
  /// messages between them.
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
  std::unique_ptr<vicon::SocketServer> mocap_server_;  ///< mocap system on the wire; null otherwise
  WorldSimulation world_;
  Duration lag_;           ///< delay of the world behind the clock
  Duration truth_period_;  ///< mocap period if a real mocap's driver adds the simulated bodies
  Time next_capture_;
  Time next_truth_;
  Time next_status_;
  Time next_exchange_;  ///< exchange with the devices on the wire
  Time last_tick_;
  std::deque<models::MocapFrame> frames_;       ///< captured and not yet delivered
  std::optional<models::AttackNotice> attack_;  ///< last published
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
