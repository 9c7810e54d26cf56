#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "drivers/quadrotor/app/node.hpp"
#include "drivers/vehicle/port.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/drivers/vicon/vicon_bench.hpp"

// Flight bench in virtual time in which all data pass as device bytes. Bytes of a DataStream server
// pass through the mocap driver and its filter onto a bus. Three quadrotor nodes read them there
// and exchange MAVLink with emulated autopilots. Plans and commands are encoded messages on the
// same bus. The knobs of FlightBench change these bytes or the behaviour of a device.

namespace vantage::test {

/// Connection of a node to its emulated vehicle; knobs decide which messages pass.
class WirePort : public drivers::Port {
 public:
  [[nodiscard]] bool is_datagram() const override { return true; }
  std::size_t read(std::span<std::uint8_t> buffer, Time now) override;
  void write(std::span<const std::uint8_t> message, Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override { return {}; }

  std::deque<std::vector<std::uint8_t>> to_driver;
  std::vector<std::vector<std::uint8_t>> to_vehicle;
};

class WireBench : public FlightBench {
 public:
  /// s; time before t = 0 for boot, parameters, arming and take-off.
  static constexpr double kWireLeadS = 70.0;

  /// Constructs a bench in which Q1 and Q3 have autopilots of `dialect` and Q2 has the other
  /// dialect.
  WireBench(std::uint64_t seed, models::AutopilotDialect dialect);

  void fly_up(double until_s) override;
  [[nodiscard]] std::int64_t count_of(const Vehicle& vehicle,
                                      const std::string& counter) const override;
  /// Returns the counters of the vehicle's node, of the node's bus and of the mocap driver.
  [[nodiscard]] std::vector<models::NamedCount> counts_of(const Vehicle& vehicle) const;
  /// Returns the reasons in the newest status of the vehicle.
  [[nodiscard]] const std::vector<std::string>& reasons_of(const std::string& robot);
  [[nodiscard]] sim::AutopilotEmulator& emulator(const std::string& robot);

 protected:
  void deliver(const models::MocapFrame& frame) override;
  bool deliver(Vehicle& vehicle, const models::RobotPlan& plan) override;
  void deliver(const models::OperatorCommand& command) override;
  void move() override;

 private:
  struct WiredVehicle {
    WiredVehicle(WireBench& bench, const scenario::RobotSpec& robot, std::uint64_t seed,
                 Time start);

    std::unique_ptr<bus::Transport> side;
    bus::Bus bus;
    WirePort* port;  ///< owned by the node of the vehicle
    drivers::QuadrotorNode node;
    sim::AutopilotEmulator emulator;
    std::vector<std::string> reasons;
    bool was_mode_left = false;
    bool was_end_requested = false;
    std::optional<double> charge_share;  ///< reported battery share without a fault
  };
  static scenario::Scenario wire_scenario(models::AutopilotDialect dialect);
  [[nodiscard]] bool is_px4(const std::string& robot) const;
  [[nodiscard]] WiredVehicle& wired_vehicle(const std::string& robot);
  void change_vehicle(Vehicle& vehicle, WiredVehicle& wired_vehicle, double dt_s);
  void pass_telemetry(const Vehicle& vehicle, WiredVehicle& wired_vehicle);
  void read_truth(Vehicle& vehicle, WiredVehicle& wired_vehicle);
  void on_status(const models::VehicleStatus& status);
  template <class Message>
  void publish(const std::string& channel, const Message& message);

  bus::InProcessHub hub_;
  bus::VirtualClock clock_;
  std::unique_ptr<bus::Transport> mocap_side_ = hub_.connect();
  bus::Bus mocap_bus_{*mocap_side_, 33};
  std::unique_ptr<bus::Transport> planner_side_ = hub_.connect();  ///< plans, commands
  std::unique_ptr<bus::Transport> lab_side_ = hub_.connect();
  bus::Bus lab_{*lab_side_, 44};
  ViconBench vicon_;
  std::vector<std::unique_ptr<WiredVehicle>> wired_vehicles_;
};

}  // namespace vantage::test
