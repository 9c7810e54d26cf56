#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "scenario/scenario.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"
#include "test/sim/autopilot/recording.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/messages.hpp"
#include "wire/mavlink/parser.hpp"

namespace vantage::test {

/// A MAVLink partner of an autopilot in virtual time. It sends only the messages that the test
/// requests. Derived classes connect it to an emulated or a real autopilot.
class ScriptedStation {
 public:
  static constexpr Time kBoot = from_utime(1'700'000'000'000'000);
  static constexpr Duration kTick{20'000};

  explicit ScriptedStation(models::AutopilotDialect spoken) : dialect(spoken) {}
  virtual ~ScriptedStation() = default;

  /// Advances one tick (50 Hz). Sends poses, set-points and heartbeats (5 Hz) if they are switched
  /// on.
  void tick();
  void run(double seconds);

  template <class Message>
  void send(const Message& message) {
    std::vector<std::uint8_t> bytes;
    wire::mavlink::append_bytes(wire::mavlink::pack(message, {255, 191, sequence_++}), bytes);
    transmit(bytes);
  }

  /// Sends a command and returns the result in its acknowledgement; −1 if none arrives within a
  /// second.
  int command(std::uint16_t number, float p1, float p2 = 0.0F, float p3 = 0.0F, float p7 = 0.0F);
  void set_parameter(const std::string& name, double value);

  static wire::mavlink::SetPositionTargetLocalNed velocity(float vx, float vy, float vz,
                                                           float yaw_rate);
  static wire::mavlink::SetPositionTargetLocalNed position(float x, float y, float z, float yaw);

  /// True state of the body; seen() returns the state at the capture time of the cameras.
  struct Body {
    Time time{};
    Pose3 world_from_body;
    Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  };
  [[nodiscard]] virtual Body body() const = 0;
  [[nodiscard]] virtual Body seen() const { return body(); }
  [[nodiscard]] double time_s() const { return to_seconds(now - kBoot); }

  models::AutopilotDialect dialect;
  Time now = kBoot;
  bool sends_poses = false;
  Eigen::Vector3d pose_offset_m = Eigen::Vector3d::Zero();  ///< m, z down; added to sent poses
  bool sends_heartbeats = false;
  std::uint8_t frame = wire::mavlink::frame::kLocalFrd;
  std::uint8_t estimator_type = wire::mavlink::kEstimatorVision;
  std::optional<wire::mavlink::SetPositionTargetLocalNed> target;
  Recording* recording = nullptr;  ///< if set, records all incoming messages

  // Last messages received.
  std::optional<wire::mavlink::CommandAck> last_ack;
  std::optional<wire::mavlink::Heartbeat> last_heartbeat;
  std::optional<wire::mavlink::ParamValue> last_parameter;
  std::optional<wire::mavlink::BatteryStatus> last_battery;
  std::string last_text;
  std::uint16_t flags = 0;
  std::uint8_t landed = 0;
  int positions = 0;
  int origins = 0;
  [[nodiscard]] bool reports_armed() const {
    return last_heartbeat && (last_heartbeat->base_mode & wire::mavlink::kArmedFlag) != 0;
  }

 protected:
  virtual void transmit(std::span<const std::uint8_t> bytes) = 0;
  /// Advances the autopilot by one tick, to `now`.
  virtual void pass() = 0;
  void receive(std::span<const std::uint8_t> bytes);

 private:
  void send_pose();
  void receive(const wire::mavlink::Frame& frame);
  void note(const std::string& kind, const std::string& what);

  wire::mavlink::Parser parser_;
  std::optional<wire::mavlink::Timesync> owed_;  ///< reply to be sent
  std::uint8_t sequence_ = 0;
  std::int64_t ticks_ = 0;
};

/// A station connected to an emulated autopilot.
class EmulatorStation : public ScriptedStation {
 public:
  explicit EmulatorStation(models::AutopilotDialect spoken)
      : EmulatorStation(spoken, lift({1.0, 2.0, 0.5}, 0.1), 0.0) {}
  EmulatorStation(models::AutopilotDialect spoken, const Pose3& start, double gust_sigma_mps)
      : ScriptedStation(spoken), emulator(spec_for(spoken, start, gust_sigma_mps), kBoot) {}

  static sim::AutopilotEmulatorSpec spec_for(models::AutopilotDialect spoken, const Pose3& start,
                                             double gust_sigma_mps) {
    sim::AutopilotEmulatorSpec spec;
    spec.dialect = spoken;
    spec.start = start;
    spec.airframe.wind_sigma_mps = gust_sigma_mps;
    return spec;
  }

  [[nodiscard]] Body body() const override {
    return {now, emulator.world_from_body(), emulator.velocity_world_mps()};
  }
  [[nodiscard]] bool armed() const { return emulator.controller().is_armed(); }
  [[nodiscard]] std::uint32_t mode() const { return emulator.controller().mode(); }
  [[nodiscard]] double height_m() const {
    return emulator.world_from_body().translation_m.z() - 0.1;
  }

  sim::AutopilotEmulator emulator;

 protected:
  void transmit(std::span<const std::uint8_t> bytes) override {
    emulator.receive(bytes, now);
    listen();
  }
  void pass() override {
    emulator.advance_to(now);
    listen();
  }

 private:
  void listen() {
    for (const auto& datagram : emulator.take_output()) {
      receive(datagram);
    }
  }
};

}  // namespace vantage::test
