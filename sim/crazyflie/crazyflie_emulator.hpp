#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "sim/crazyflie/crazyflie_supervisor.hpp"
#include "sim/crazyflie/crazyflie_tables.hpp"
#include "sim/crazyflie/flight_control.hpp"
#include "sim/crazyflie/pose_memory.hpp"
#include "sim/firmware/crazyflie_link.hpp"
#include "sim/firmware/multirotor.hpp"
#include "wire/crtp/flight.hpp"
#include "wire/crtp/packet.hpp"

namespace vantage::sim {

/// Properties of an emulated Crazyflie.
struct CrazyflieEmulatorSpec {
  Pose2 start;
  std::uint64_t seed = 1;
  MultirotorParameters body = crazyflie_body();
  bool arms_itself = true;  ///< true: arms itself, as vehicles with brushed motors do
  std::uint8_t id = 0xE7;   ///< last byte of the radio address; marks packed poses
};

/// Emulated Crazyflie: receives CRTP packets, replies as firmware 2026.08 does, and flies a
/// simulated body. It has the dangerous properties of the firmware: the motors lock when no more
/// set-points arrive, malformed packets crash the firmware, poses are not checked, and a lost pose
/// is not reported. Time is an argument; the same calls give the same bytes.
class CrazyflieEmulator {
 public:
  static constexpr Duration kStep{2'000};

  CrazyflieEmulator(const CrazyflieEmulatorSpec& spec, Time boot);
  // The log variables refer to this object.
  CrazyflieEmulator(const CrazyflieEmulator&) = delete;
  CrazyflieEmulator& operator=(const CrazyflieEmulator&) = delete;
  CrazyflieEmulator(CrazyflieEmulator&&) = delete;
  CrazyflieEmulator& operator=(CrazyflieEmulator&&) = delete;
  ~CrazyflieEmulator() = default;

  /// Processes the bytes of one packet.
  void receive(wire::crtp::Bytes bytes, Time now);
  /// Steps the body and the firmware to `now`.
  void advance_to(Time now);
  /// Returns the packets to send, and removes them.
  std::vector<std::vector<std::uint8_t>> take_output();

  [[nodiscard]] const Pose3& world_from_body() const { return body_.world_from_body(); }
  [[nodiscard]] const Eigen::Vector3d& velocity_world_mps() const {
    return body_.velocity_world_mps();
  }
  /// Returns the supervisor's bits (wire::crtp::info).
  [[nodiscard]] std::uint16_t info() const;
  /// True after a packet has crashed the firmware.
  [[nodiscard]] bool has_crashed_firmware() const { return is_dead_; }
  [[nodiscard]] bool are_motors_running() const { return are_motors_running_; }
  [[nodiscard]] double parameter(const std::string& name) const { return tables_.parameter(name); }
  /// Returns the number of packets that were not understood.
  [[nodiscard]] std::int64_t ignored() const { return ignored_; }
  [[nodiscard]] std::int64_t poses() const { return poses_; }
  [[nodiscard]] std::int64_t setpoints() const { return setpoints_; }
  /// Sets the reported battery voltage; nullopt: the voltage of the body's battery is reported.
  void set_battery_v(std::optional<double> voltage_v) { battery_v_ = voltage_v; }
  [[nodiscard]] std::optional<Eigen::Vector3d> setpoint_m() const;

 private:
  struct LowLevel {
    ControlGoal goal;
    bool has_motors = true;  ///< false: the set-point stops the motors
    Time received{};
    /// end of the set-point's validity, once the driver has announced the end of its set-points
    std::optional<Time> valid_until;
  };
  /// Trajectory of the high-level commander from rest to rest.
  struct Trajectory {
    Eigen::Vector3d from_m, to_m;
    double yaw_from_rad = 0.0;
    double yaw_to_rad = 0.0;
    Time begin{};
    double duration_s = 0.0;
    bool is_landing = false;
  };

  void process(const wire::crtp::Packet& packet, Time now);
  void process_flight(const wire::crtp::Packet& packet, Time now);
  void process_supervisor(const wire::crtp::Packet& packet, Time now);
  void process_memory(const wire::crtp::Packet& packet);
  void process_platform(const wire::crtp::Packet& packet);
  std::uint8_t command(const wire::crtp::FlightMessage& message, Time now);
  std::uint8_t plan(const Eigen::Vector3d& to_m, double yaw_rad, double duration_s, bool is_landing,
                    Time now);
  void take_setpoint(const ControlGoal& goal, bool has_motors, Time now);
  void take_pose(const wire::crtp::ExternalPose& pose, bool has_rotation, Time now);
  void step(Time now);
  [[nodiscard]] std::optional<ControlGoal> goal(Time now);
  [[nodiscard]] Pose3 estimate() const { return memory_.estimate(body_.world_from_body(), now_); }
  /// Returns the estimated velocity; 0 before the first pose.
  [[nodiscard]] Eigen::Vector3d estimated_velocity_mps() const {
    return memory_.has_pose() ? body_.velocity_world_mps()
                              : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
  void reply(const wire::crtp::Packet& packet);
  std::vector<CrazyflieVariable> parameters() const;
  std::vector<CrazyflieVariable> logs();

  std::uint8_t id_;
  Time boot_;
  Time now_;
  Time stepped_;
  Multirotor body_;
  FlightControl control_;
  CrazyflieSupervisor supervisor_;
  PoseMemory memory_;
  std::optional<LowLevel> low_level_;
  std::optional<double> level_m_;  ///< m; height that is kept while the set-point is too old
  std::optional<Trajectory> trajectory_;
  CrazyflieTables tables_;
  std::vector<std::vector<std::uint8_t>> output_;
  bool are_motors_running_ = false;
  bool is_dead_ = false;
  std::optional<double> battery_v_;
  std::int64_t ignored_ = 0;
  std::int64_t poses_ = 0;
  std::int64_t setpoints_ = 0;
};

}  // namespace vantage::sim
