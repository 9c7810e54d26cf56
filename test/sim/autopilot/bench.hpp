#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "models/wire/mavlink/parser.hpp"
#include "models/wire/mavlink/vocabulary.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"

namespace vantage::test {

namespace wire = models::mavlink;

/// A hand that speaks MAVLink to an emulated autopilot, message by message, in virtual time: it
/// does nothing that it is not told.
class Hand {
 public:
  static constexpr Time kBoot = from_utime(1'700'000'000'000'000);
  static constexpr Duration kTick{20'000};

  explicit Hand(models::AutopilotDialect dialect) : emulator(spec_for(dialect), kBoot) {
    now = kBoot;
  }

  static sim::AutopilotEmulatorSpec spec_for(models::AutopilotDialect dialect) {
    sim::AutopilotEmulatorSpec spec;
    spec.dialect = dialect;
    spec.start = lift({1.0, 2.0, 0.5}, 0.1);
    spec.airframe.wind_sigma_mps = 0.0;
    return spec;
  }

  /// 50 Hz for `seconds`: poses and set-points as they are switched on.
  void run(double seconds) {
    const Time end = now + from_seconds(seconds);
    while (now < end) {
      if (sends_poses) {
        send_pose();
      }
      if (target) {
        send(*target);
      }
      now += kTick;
      emulator.advance_to(now);
      collect();
    }
  }

  template <class Message>
  void send(const Message& message) {
    std::vector<std::uint8_t> bytes;
    wire::append_bytes(wire::pack(message, {255, 191, sequence++}), bytes);
    emulator.receive(bytes, now);
    collect();
  }

  /// Result of the acknowledgement; −1 without one.
  int command(std::uint16_t number, float p1, float p2 = 0.0F, float p3 = 0.0F, float p7 = 0.0F) {
    last_ack.reset();
    wire::CommandLong out;
    out.command = number;
    out.param1 = p1;
    out.param2 = p2;
    out.param3 = p3;
    out.param7 = p7;
    out.target_system = 1;
    out.target_component = 1;
    send(out);
    return last_ack && last_ack->command == number ? last_ack->result : -1;
  }

  void send_pose() {
    const Pose3 pose = emulator.world_from_body();
    wire::Odometry odometry;
    odometry.time_usec = static_cast<std::uint64_t>(to_utime(now));
    odometry.x = static_cast<float>(pose.translation_m.x());
    odometry.y = static_cast<float>(-pose.translation_m.y());
    odometry.z = static_cast<float>(-pose.translation_m.z());
    odometry.frame_id = frame;
    odometry.child_frame_id = wire::frame::kBodyFrd;
    odometry.estimator_type = estimator_type;
    send(odometry);
  }

  static wire::SetPositionTargetLocalNed velocity(float vx, float vy, float vz, float yaw_rate) {
    wire::SetPositionTargetLocalNed out;
    out.type_mask = wire::mask::kVelocityAndYawRate;
    out.coordinate_frame = wire::frame::kLocalNed;
    out.vx = vx;
    out.vy = vy;
    out.vz = vz;
    out.yaw_rate = yaw_rate;
    return out;
  }
  static wire::SetPositionTargetLocalNed position(float x, float y, float z, float yaw) {
    wire::SetPositionTargetLocalNed out;
    out.type_mask = wire::mask::kPositionAndYaw;
    out.coordinate_frame = wire::frame::kLocalNed;
    out.x = x;
    out.y = y;
    out.z = z;
    out.yaw = yaw;
    return out;
  }

  bool armed() const { return emulator.controller().is_armed(); }
  std::uint32_t mode() const { return emulator.controller().mode(); }
  double height_m() const { return emulator.world_from_body().translation_m.z() - 0.1; }

  sim::AutopilotEmulator emulator;
  Time now;
  bool sends_poses = false;
  std::uint8_t frame = wire::frame::kLocalFrd;
  std::uint8_t estimator_type = wire::kEstimatorVision;
  std::optional<wire::SetPositionTargetLocalNed> target;
  std::optional<wire::CommandAck> last_ack;
  std::string last_text;
  std::uint16_t flags = 0;
  int positions = 0;
  std::uint8_t sequence = 0;

 private:
  void collect() {
    for (const auto& datagram : emulator.take_output()) {
      parser_.feed(datagram, [this](const wire::Frame& got) {
        if (const auto ack = wire::unpack<wire::CommandAck>(got)) {
          last_ack = ack;
        } else if (const auto text = wire::unpack<wire::Statustext>(got)) {
          last_text = text->text.data();
        } else if (const auto px4 = wire::unpack<wire::EstimatorStatus>(got)) {
          flags = px4->flags;
        } else if (const auto ekf = wire::unpack<wire::EkfStatusReport>(got)) {
          flags = ekf->flags;
        } else if (got.message_id == wire::LocalPositionNed::kMessage.id) {
          ++positions;
        }
      });
    }
  }
  wire::Parser parser_;
};

}  // namespace vantage::test
