#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "wire/crtp/packet.hpp"

// Messages that move a Crazyflie or locate it: external pose (port 6), set-points (port 7) and the
// high-level commander (port 8). Positions are in the world frame.

namespace vantage::wire::crtp {

/// External position without attitude.
struct ExternalPosition {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
};
/// External pose of the receiving vehicle.
struct ExternalPose {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Quaternion world_from_body = Quaternion::Identity();
};
/// External pose of one of several vehicles, in steps of 1 mm.
struct PackedPose {
  std::uint8_t id = 0;  ///< last byte of the vehicle's address
  ExternalPose pose;
};
inline constexpr std::size_t kPackedPosesMax = 2;  ///< maximum number of poses in one packet

std::optional<Packet> encode(const ExternalPosition& position);
std::optional<Packet> encode(const ExternalPose& pose);
/// @return nullopt if a value is out of range, or if there are no poses or more than
/// kPackedPosesMax
std::optional<Packet> encode(std::span<const PackedPose> poses);

/// Set-point that switches the motors off.
struct StopSetpoint {};
/// Full state for the Mellinger controller. The PID controller uses only position and yaw.
struct FullStateSetpoint {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();         ///< ± 32.767 m
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();       ///< ± 32.767 m/s
  Eigen::Vector3d acceleration_world_mps2 = Eigen::Vector3d::Zero();  ///< ± 32.767 m/s²
  Quaternion world_from_body = Quaternion::Identity();
  Eigen::Vector3d rate_body_radps = Eigen::Vector3d::Zero();  ///< ± 32.767 rad/s
};
struct PositionSetpoint {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
};
/// End of the set-points: the high-level commander takes control. Without a high-level command the
/// motors stop at once.
struct SetpointsEnd {
  std::uint32_t valid_for_ms = 0;  ///< ms; time for which the last set-point stays valid
};

std::optional<Packet> encode(const StopSetpoint& setpoint);
std::optional<Packet> encode(const FullStateSetpoint& setpoint);
std::optional<Packet> encode(const PositionSetpoint& setpoint);
std::optional<Packet> encode(const SetpointsEnd& end);

/// Commands of the high-level commander (port 8), by number.
enum class HighLevelCommand : std::uint8_t { kStop = 3, kTakeOff = 7, kLand = 8, kGoTo = 12 };
/// Stops a running trajectory; the motors stop.
struct HighLevelStop {};
/// Climb or descent to an absolute height.
struct HighLevelHeight {
  bool is_landing = false;
  double height_m = 0.0;
  std::optional<double> yaw_rad;  ///< absent: the present yaw
  double duration_s = 0.0;
};
struct HighLevelGoTo {
  bool is_relative = false;
  bool is_linear = false;
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  double duration_s = 0.0;
};
std::optional<Packet> encode(const HighLevelStop& stop);
std::optional<Packet> encode(const HighLevelHeight& command);
std::optional<Packet> encode(const HighLevelGoTo& command);

/// Error codes in replies of the high-level commander.
inline constexpr std::uint8_t kHighLevelOk = 0;
/// refused by the planner, for example a second landing
inline constexpr std::uint8_t kHighLevelRefused = 1;
inline constexpr std::uint8_t kHighLevelUnknown = 8;
inline constexpr std::uint8_t kHighLevelBusy = 16;  ///< the vehicle is not allowed to fly
struct HighLevelReply {
  std::uint8_t command = 0;
  std::uint8_t error = 0;
};
std::optional<Packet> encode_reply(const Packet& request, std::uint8_t error);
std::optional<HighLevelReply> decode_high_level_reply(const Packet& packet);

/// Message on the ports 6, 7 or 8, as the vehicle reads it.
using FlightMessage = std::variant<ExternalPosition, ExternalPose, std::vector<PackedPose>,
                                   StopSetpoint, FullStateSetpoint, PositionSetpoint, SetpointsEnd,
                                   HighLevelStop, HighLevelHeight, HighLevelGoTo>;
/// Returns the message in `packet`; nullopt for another port or kind, or a wrong length. Numbers in
/// the message may be non-finite.
std::optional<FlightMessage> decode_flight(const Packet& packet);

}  // namespace vantage::wire::crtp
