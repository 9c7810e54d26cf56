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

// The flight bench from device bytes to device bytes, in virtual time: a DataStream server's bytes
// go through the mocap driver and its filter onto a bus, from there into three quadrotor nodes, and
// from these as MAVLink into emulated autopilots, and back. Plans and orders are encoded messages
// on the same bus. The knobs of FlightBench change bytes here, or what a device does.

namespace vantage::test {

/// Both ends of a vehicle's wire. Knobs decide what passes.
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
  /// Before time 0: boot, parameters, arming, take-off.
  static constexpr double kWireLeadS = 70.0;

  /// Q1 and Q3 have autopilots of `dialect`, Q2 has one of the other.
  WireBench(std::uint64_t seed, models::AutopilotDialect dialect);

  void fly_up(double until_s) override;
  [[nodiscard]] std::int64_t count_of(const Vehicle& vehicle,
                                      const std::string& counter) const override;
  /// Of the vehicle's node, of its bus and of the mocap driver.
  [[nodiscard]] std::vector<models::NamedCount> counts_of(const Vehicle& vehicle) const;
  /// What the vehicle's newest status gives as reasons.
  [[nodiscard]] const std::vector<std::string>& reasons_of(const std::string& robot);
  [[nodiscard]] sim::AutopilotEmulator& emulator(const std::string& robot);

 protected:
  void deliver(const models::MocapFrame& frame) override;
  bool deliver(Vehicle& vehicle, const models::RobotPlan& plan) override;
  void deliver(const models::OperatorCommand& command) override;
  void move() override;

 private:
  struct Seat {
    Seat(WireBench& bench, const scenario::RobotSpec& robot, std::uint64_t seed, Time start);

    std::unique_ptr<bus::Transport> side;
    bus::Bus bus;
    WirePort* port;  ///< owned by the node
    drivers::QuadrotorNode node;
    sim::AutopilotEmulator emulator;
    std::vector<std::string> reasons;
    bool was_mode_left = false;
    bool was_end_requested = false;
    std::optional<double> charge_share;  ///< what the battery has without its fault
  };
  static scenario::Scenario wire_scenario(models::AutopilotDialect dialect);
  [[nodiscard]] bool is_px4(const std::string& robot) const;
  [[nodiscard]] Seat& seat(const std::string& robot);
  void change_vehicle(Vehicle& vehicle, Seat& seat, double dt_s);
  void pass_telemetry(const Vehicle& vehicle, Seat& seat);
  void read_truth(Vehicle& vehicle, Seat& seat);
  void on_status(const models::VehicleStatus& status);
  template <class Message>
  void publish(const std::string& channel, const Message& message);

  bus::InProcessHub hub_;
  bus::VirtualClock clock_;
  std::unique_ptr<bus::Transport> mocap_side_ = hub_.connect();
  bus::Bus mocap_bus_{*mocap_side_, 33};
  std::unique_ptr<bus::Transport> stranger_ = hub_.connect();  ///< plans and orders, as encoded
  std::unique_ptr<bus::Transport> lab_side_ = hub_.connect();
  bus::Bus lab_{*lab_side_, 44};
  ViconBench vicon_;
  std::vector<std::unique_ptr<Seat>> seats_;
};

}  // namespace vantage::test
