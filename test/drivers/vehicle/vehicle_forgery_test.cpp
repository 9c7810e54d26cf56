// Tests which forged messages a flying vehicle accepts. The forger uses the names of the vehicle's
// partners.

#include <map>

#include <gtest/gtest.h>

#include "bus/auth/trailer.hpp"
#include "bus/convert/wire_walk.hpp"
#include "test/bus/auth/auth_support.hpp"
#include "test/drivers/vehicle/vehicle_trust.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;
using test::kOtherRun;
using test::kSecondSource;
using test::VehicleTrust;

// Forgeries that cannot be detected without keys: they use the run id and next sequence number of
// the live stream, and current stamps.

class Forgery : public VehicleTrust {
 protected:
  static constexpr std::int64_t kPlannerRun = 77;

  /// Forges poses in the name of the real publisher for three seconds.
  void forge_poses() {
    const auto receiver = open_receiver();
    bench.each_step = [&] {
      read_newest(*receiver);
      if (bench.steps % 2 == 1) {
        models::MocapFrame frame = bench.see();
        frame.stamp = {bench.clock.now(), vicon_.run_id, vicon_.sequence + 1};
        frame.bodies[0].world_from_body.translation_m.x() += 0.02 * static_cast<double>(++forged_);
        send(bus::kVicon.name, bytes_of(frame));
      }
    };
    bench.run(3.0);
    bench.each_step = nullptr;
  }
  void forge_order(OperatorAction action) {
    const auto receiver = open_receiver();
    bench.each_step = [&] { read_newest(*receiver); };
    bench.run(0.5);
    bench.each_step = nullptr;
    send(bus::kCommand.name, bytes_of(command(action, command_.run_id, command_.sequence + 1, {})));
    bench.run(0.5);
  }
  /// Sends the payload without a signature, and again with the newest signature trailer received on
  /// the channel.
  void send(const std::string& channel, const std::vector<std::uint8_t>& payload) {
    bench.attacker->publish(channel, payload);
    std::vector<std::uint8_t> with_trailer = payload;
    const std::vector<std::uint8_t>& whole = newest_[channel];
    const std::size_t trailer_bytes = whole.size() - bus::auth::payload_of(whole).size();
    with_trailer.insert(with_trailer.end(),
                        whole.end() - static_cast<std::ptrdiff_t>(trailer_bytes), whole.end());
    if (trailer_bytes > 0) {
      bench.attacker->publish(channel, with_trailer);
      bench.attacker->publish(channel, whole);  // replay of the genuine message
    }
  }
  template <class Message>
  static std::vector<std::uint8_t> bytes_of(const Message& message) {
    const auto wire = bus::to_wire(message);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
    wire.encode(bytes.data(), 0, wire.getEncodedSize());
    return bytes;
  }
  std::unique_ptr<bus::Transport> open_receiver() {
    auto receiver = bench.hub.connect();
    for (const std::string& channel : {bus::kVicon.name, bus::kCommand.name}) {
      receiver->subscribe(channel,
                          [this](std::string_view name, std::span<const std::uint8_t> bytes) {
                            newest_[std::string(name)] = {bytes.begin(), bytes.end()};
                          });
    }
    return receiver;
  }
  void read_newest(bus::Transport& receiver) {
    while (receiver.handle(std::chrono::microseconds(0)) > 0) {
    }
    if (const auto frame = bus::decode_wire<vantage_lcm::mocap_frame_t>(newest_["VICON"])) {
      vicon_ = {from_utime(frame->utime), frame->run_id, frame->sequence};
    }
    if (const auto order = bus::decode_wire<vantage_lcm::command_t>(newest_["COMMAND"])) {
      command_ = {from_utime(order->utime), order->run_id, order->sequence};
    }
  }
  /// Returns a plan that begins at the vehicle's hover position in 0.5 s.
  models::RobotPlan plan() const {
    models::RobotPlan plan;
    plan.robot = bench.robot();
    plan.trajectory.start_time = bench.clock.now() + from_seconds(0.5);
    plan.trajectory.start = {2.0, 2.0, kPi / 2};
    plan.trajectory.height_m = 1.0;
    plan.stamp = {plan.trajectory.start_time, kPlannerRun, 0};
    return plan;
  }

  models::Stamp vicon_;
  models::Stamp command_;
  std::map<std::string, std::vector<std::uint8_t>> newest_;
  std::int64_t forged_ = 0;
};

TEST_F(Forgery, SucceedsForPosesWithoutSignatures) {
  take_off();
  forge_poses();
  EXPECT_FALSE(only_hovered());
}

TEST_F(Forgery, IsRefusedForPosesWithSignatures) {
  bench.secure(test::keys_of_a_trial(), {});
  take_off();
  forge_poses();
  EXPECT_TRUE(only_hovered());
  EXPECT_GT(bench.count("VICON.unsigned"), 200);
  EXPECT_GT(bench.count("VICON.bad_mac"), 200);
  EXPECT_GT(bench.count("VICON.replayed"), 200);
}

TEST_F(Forgery, SucceedsForCommandsWithoutSignatures) {
  take_off();
  forge_order(OperatorAction::kEmergencyStop);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
}

TEST_F(Forgery, IsRefusedForCommandsWithSignatures) {
  bench.secure(test::keys_of_a_trial(), {});
  take_off();
  for (const OperatorAction action :
       {OperatorAction::kLand, OperatorAction::kEmergencyStop, OperatorAction::kArm}) {
    forge_order(action);
  }
  EXPECT_TRUE(only_hovered());
  EXPECT_EQ(bench.count("COMMAND.unsigned"), 3);
  EXPECT_EQ(bench.count("COMMAND.bad_mac"), 3);
  EXPECT_EQ(bench.count("COMMAND.replayed"), 3);
  bench.send_command(OperatorAction::kEmergencyStop);
  bench.run(0.05);
  EXPECT_EQ(bench.state(), FlightState::kKilled) << "the genuine command is accepted";
}

TEST_F(Forgery, IsRefusedForPlansWithSignatures) {
  const std::string channel = bus::plan_channel(bench.robot()).name;
  take_off();
  send(channel, bytes_of(plan()));
  bench.run(0.1);
  EXPECT_EQ(bench.count("plan.not following"), 1)
      << "a guard that requires no signature evaluates the plan";
  bench.secure(test::keys_of_a_trial(), {});
  bench.run(0.5);
  send(channel, bytes_of(plan()));
  bench.run(0.1);
  EXPECT_EQ(bench.count("plan.not following"), 1);
  EXPECT_EQ(bench.count(channel + ".unsigned"), 1);
}

TEST_F(Forgery, IsRefusedForSimulationMessagesByALiveVehicle) {
  const auto keys = test::keys_of_a_trial();
  bench.secure(keys, {});
  take_off();
  const auto side = bench.hub.connect();
  bus::Bus simulation(*side, kOtherRun);
  simulation.secure(test::authenticator(
                        keys, {scenario::SecurityMode::kRequire, scenario::TrialMode::kSimulation}),
                    bench.clock);
  bench.each_step = [&] {
    models::MocapFrame frame = bench.see();
    frame.bodies[0].world_from_body.translation_m = {-1.0, 1.0, 0.05};
    simulation.publish(bus::kVicon, frame);
    simulation.publish(bus::kCommand, command(OperatorAction::kEmergencyStop, 0, 0, {}));
  };
  bench.run(3.0);
  EXPECT_TRUE(only_hovered());
  EXPECT_GT(bench.count("VICON.wrong_mode"), 500);
  EXPECT_GT(bench.count("COMMAND.wrong_mode"), 500);
  EXPECT_FALSE(bench.has_reason(kSecondSource));
}

}  // namespace
}  // namespace vantage::drivers
