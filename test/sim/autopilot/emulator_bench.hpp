#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/axes.hpp"
#include "core/pose.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/messages.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/mavlink/single.hpp"

namespace vantage::test {

namespace mavlink = wire::mavlink;

constexpr Time kBenchBoot = from_utime(1'700'000'000'000'000);

inline sim::AutopilotEmulatorSpec spec_of(models::AutopilotDialect dialect) {
  sim::AutopilotEmulatorSpec spec;
  spec.dialect = dialect;
  spec.system_id = 9;
  spec.start = lift({1.0, 2.0, 0.5}, 0.25);
  spec.airframe.wind_sigma_mps = 0.0;
  return spec;
}

/// An emulated autopilot with system id 9, and the frames that it has sent.
struct EmulatorBench {
  explicit EmulatorBench(models::AutopilotDialect dialect) : EmulatorBench(spec_of(dialect)) {}
  explicit EmulatorBench(const sim::AutopilotEmulatorSpec& spec) : emulator(spec, kBenchBoot) {}

  template <class Message>
  void send(const Message& message, std::uint8_t system_id = 255) {
    std::vector<std::uint8_t> bytes;
    mavlink::append_bytes(mavlink::pack(message, {system_id, 191, sequence++}), bytes);
    emulator.receive(bytes, now);
    collect();
  }
  void run(double seconds) {
    for (const Time end = now + from_seconds(seconds); now < end;) {
      now += sim::AutopilotEmulator::kStep;
      emulator.advance_to(now);
      collect();
    }
  }
  int command(std::uint16_t number, float p1 = 0.0F, float p2 = 0.0F, float p3 = 0.0F,
              float p7 = 0.0F, std::uint8_t to = 9) {
    mavlink::CommandLong out;
    out.command = number;
    out.param1 = p1;
    out.param2 = p2;
    out.param3 = p3;
    out.param7 = p7;
    out.target_system = to;
    frames.clear();
    send(out);
    const auto acks = all<mavlink::CommandAck>();
    if (acks.size() == 1) {
      EXPECT_EQ(acks[0].command, number);
      EXPECT_EQ(acks[0].target_system, 255);
      EXPECT_EQ(acks[0].target_component, 191);
    }
    return acks.size() == 1 ? acks[0].result : -1;
  }
  template <class Message>
  std::vector<Message> all() const {
    std::vector<Message> out;
    for (const mavlink::Frame& frame : frames) {
      if (const auto message = mavlink::unpack<Message>(frame)) {
        out.push_back(*message);
      }
    }
    return out;
  }
  /// Requests a message and returns the newest one that arrives within 0.1 s.
  template <class Message>
  Message request() {
    EXPECT_EQ(command(mavlink::command::kSetMessageInterval, float(Message::kMessage.id), 5000.0F),
              0);
    frames.clear();
    run(0.1);
    const auto received = all<Message>();
    EXPECT_EQ(received.size(), 20u);
    return received.empty() ? Message{} : received.back();
  }
  mavlink::Odometry pose(const Eigen::Vector3d& position_m) const {
    mavlink::Odometry out;
    out.x = mavlink::f32(position_m.x());
    out.y = mavlink::f32(position_m.y());
    out.z = mavlink::f32(position_m.z());
    out.frame_id = mavlink::frame::kLocalFrd;
    out.child_frame_id = mavlink::frame::kBodyFrd;
    out.estimator_type = mavlink::kEstimatorVision;
    out.time_usec = static_cast<std::uint64_t>(to_utime(now));
    return out;
  }
  [[nodiscard]] Eigen::Vector3d place_m() const {
    return convert_axes(emulator.world_from_body().translation_m);
  }
  /// Sends poses at 50 Hz for `seconds`, each with the set-point `target` if it is not null.
  void send_poses(double seconds, const mavlink::SetPositionTargetLocalNed* target = nullptr) {
    for (double t = 0.0; t < seconds - 1e-9; t += 0.02) {
      send(pose(place_m()));
      if (target != nullptr) {
        send(*target);
      }
      run(0.02);
    }
  }
  [[nodiscard]] std::int64_t poses() const { return emulator.controller().estimator().poses(); }

  sim::AutopilotEmulator emulator;
  Time now = kBenchBoot;
  std::vector<mavlink::Frame> frames;

 private:
  void collect() {
    for (const auto& datagram : emulator.take_output()) {
      parser_.feed(datagram, [&](const mavlink::Frame& frame) { frames.push_back(frame); });
    }
  }
  mavlink::Parser parser_;
  std::uint8_t sequence = 0;
};

inline mavlink::SetPositionTargetLocalNed target_of(std::uint16_t mask) {
  mavlink::SetPositionTargetLocalNed out;
  out.type_mask = mask;
  out.coordinate_frame = mavlink::frame::kLocalNed;
  out.target_system = 9;
  return out;
}

/// Returns a bench with a PX4 that hovers at a height of 1.5 m.
inline EmulatorBench flying() {
  EmulatorBench bench(models::AutopilotDialect::kPx4);
  bench.send_poses(3.0);
  auto target = target_of(mavlink::mask::kPositionAndYaw);
  target.x = 1.0F;
  target.y = -2.0F;
  target.z = -1.75F;
  target.yaw = -0.5F;
  bench.send_poses(1.5, &target);
  EXPECT_EQ(bench.command(mavlink::command::kSetMode, 1.0F, 6.0F), 0);
  EXPECT_EQ(bench.command(mavlink::command::kArmDisarm, 1.0F), 0);
  bench.send_poses(8.0, &target);
  EXPECT_NEAR(bench.place_m().z(), -1.75, 0.1);
  return bench;
}

}  // namespace vantage::test
