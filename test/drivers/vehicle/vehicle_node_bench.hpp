#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/convert/channels.hpp"
#include "bus/node/bus.hpp"
#include "bus/transport/transport.hpp"
#include "drivers/vehicle/port.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "test/bus/auth/auth_support.hpp"

namespace vantage::test {

/// A vehicle node connected to the emulated vehicle by real loopback datagrams, in virtual time. An
/// in-process bus carries mocap at 100 Hz and operator commands.
template <class Node, class Endpoint>
class VehicleNodeBench {
 public:
  using Place = std::function<Pose3(const Endpoint&)>;  ///< returns the pose of the markers

  template <class Spec>
  VehicleNodeBench(const scenario::Scenario& given, const Spec& spec, const std::string& url,
                   Time start, Place place_of)
      : clock(start),
        scenario(given),
        node(node_bus, clock, scenario, robot(), drivers::open_port(url)),
        vehicle(spec, url, start),
        place(std::move(place_of)) {
    lab.subscribe<models::VehicleStatus>(
        bus::vehicle_channel(robot()),
        [this](const models::VehicleStatus& received) { statuses.push_back(received); });
  }

  /// Makes node and lab sign and verify all further messages; the attacker has no key.
  void secure(const std::shared_ptr<const bus::auth::Keyring>& keys,
              const bus::auth::Authenticator::Rules& rules) {
    node_bus.secure(authenticator(keys, rules), clock);
    node_bus.use_clock(clock);
    lab.secure(authenticator(keys, rules), clock);
  }

  void send_command(models::OperatorAction action) {
    models::OperatorCommand command;
    command.stamp.time = clock.now() + operator_clock;
    command.action = action;
    lab.publish(bus::kCommand, command);
  }
  /// Publishes a message of a third party with the run id and sequence number in `message`.
  template <class Message>
  void publish_forged(const bus::Channel<Message>& channel, const Message& message) {
    const auto wire = bus::to_wire(message);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
    wire.encode(bytes.data(), 0, wire.getEncodedSize());
    attacker->publish(channel.name, bytes);
  }
  bool run_until(const std::function<bool()>& done, double seconds) {
    const Time end = clock.now() + from_seconds(seconds);
    for (; clock.now() < end && !done(); ++steps) {
      clock.set(clock.now() + Duration{5'000});
      vehicle.run_to(clock.now());
      if (steps % 2 == 0 && mocap != nullptr) {
        mocap->publish(bus::kVicon, see());
      }
      if (steps % 40 == 0) {
        send_command(models::OperatorAction::kHeartbeat);
      }
      if (each_step) {
        each_step();
      }
      node_bus.handle(std::chrono::microseconds(0));
      if (clock.now() >= node.next_tick()) {
        node.tick(clock.now());
      }
      lab.handle(std::chrono::microseconds(0));
    }
    return done();
  }
  /// Continues after an end request until the node may end; returns false if that takes longer than
  /// `seconds`.
  bool run_to_the_end(double seconds) {
    return run_until([this] { return node.may_end(clock.now()); }, seconds);
  }
  void run(double seconds) {
    run_until([] { return false; }, seconds);
  }
  [[nodiscard]] const std::string& robot() const { return scenario.robots[0].name; }
  /// Returns a mocap frame of the current state.
  [[nodiscard]] models::MocapFrame see() const {
    models::MocapFrame frame;
    frame.stamp.time = frame.arrival = clock.now() + mocap_clock;
    frame.frame_number = steps;
    models::MocapBody body;
    body.name = robot();
    body.world_from_body = place(vehicle);
    body.world_from_body.translation_m.x() += 1e-4 * std::sin(static_cast<double>(steps));
    frame.bodies.push_back(body);
    return frame;
  }

  bus::InProcessHub hub;
  bus::VirtualClock clock;
  std::unique_ptr<bus::Transport> node_side = hub.connect();
  std::unique_ptr<bus::Transport> lab_side = hub.connect();
  bus::Bus node_bus{*node_side, 11};
  std::unique_ptr<bus::Transport> attacker = hub.connect();
  bus::Bus lab{*lab_side, 22};
  scenario::Scenario scenario;
  Node node;
  Endpoint vehicle;
  Place place;
  std::vector<models::VehicleStatus> statuses;
  std::int64_t steps = 0;
  bus::Bus* mocap = &lab;           ///< bus that publishes VICON; nullptr: none
  Duration mocap_clock{};           ///< offset of the mocap computer's clock
  Duration operator_clock{};        ///< offset of the operator's clock
  std::function<void()> each_step;  ///< called at each step
};

}  // namespace vantage::test
