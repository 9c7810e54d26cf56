#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/linear.hpp"
#include "wire/vicon/bytes.hpp"
#include "wire/vicon/stream_buffer.hpp"

// VRPN (port 3883, TCP and UDP), all numbers big-endian. Each side sends a cookie of 24 bytes.
// Messages follow, with a 24-byte header and a payload padded to a multiple of 8. Each side numbers
// its own senders and types, and announces their names.

namespace vantage::wire::vicon {

inline constexpr int kVrpnPort = 3883;
inline constexpr std::size_t kVrpnCookieBytes = 24;
inline constexpr std::size_t kVrpnHeaderBytes = 24;
inline constexpr std::size_t kVrpnMessageBytesMax = 65536;
inline constexpr std::size_t kVrpnNameBytesMax = 128;

// Message types that are known without an announcement.
inline constexpr std::int32_t kVrpnSenderDescription = -1;
inline constexpr std::int32_t kVrpnTypeDescription = -2;
inline constexpr std::int32_t kVrpnUdpDescription = -3;
inline constexpr std::int32_t kVrpnLogDescription = -4;
inline constexpr std::int32_t kVrpnDisconnect = -5;

inline constexpr std::string_view kVrpnPoseType = "vrpn_Tracker Pos_Quat";
inline constexpr std::string_view kVrpnVelocityType = "vrpn_Tracker Velocity";
inline constexpr std::string_view kVrpnPingType = "vrpn_Base ping_message";
inline constexpr std::string_view kVrpnPongType = "vrpn_Base pong_message";

/// Appends the cookie: "vrpn: ver. 07.35", two spaces, log mode "0", zeros; 24 bytes.
void append_vrpn_cookie(std::vector<std::uint8_t>& out, int minor = 35);
/// Version in a cookie, the first 24 bytes of a stream. The decoder returns nullopt for other
/// bytes.
struct VrpnVersion {
  int major = 0;
  int minor = 0;
};
std::optional<VrpnVersion> decode_vrpn_cookie(Bytes bytes);
/// Required major version; the minor version may differ.
inline constexpr int kVrpnMajor = 7;

struct VrpnHeader {
  std::uint32_t seconds = 0;  ///< s since the Unix epoch, by the sender's clock
  std::uint32_t microseconds = 0;
  std::int32_t sender = 0;
  std::int32_t type = 0;
};

/// Returns the first message of a stream after its cookie; sets `header` when it is complete.
/// `body` is the payload without padding.
Framed next_vrpn_message(Bytes stream, VrpnHeader& header);

/// Appends a message that contains `payload` and padding.
void append_vrpn_message(std::vector<std::uint8_t>& out, const VrpnHeader& header, Bytes payload);

/// Returns the name that a description (type −1 or −2) announces for header.sender, as a view into
/// `payload`; nullopt unless the name has 1 … 128 bytes.
std::optional<std::string_view> decode_vrpn_name(Bytes payload);
/// Appends a message that announces `name` for `id`; `type` is kVrpnSenderDescription or
/// kVrpnTypeDescription.
void append_vrpn_name(std::vector<std::uint8_t>& out, std::int32_t type, std::int32_t id,
                      std::string_view name);

/// Position and attitude (Pos_Quat); 64 bytes.
struct VrpnPose {
  std::int32_t sensor = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 4, 1, kUnaligned> quaternion_xyzw{0.0, 0.0, 0.0, 1.0};
};
std::optional<VrpnPose> decode_vrpn_pose(Bytes payload);
void append_vrpn_pose(std::vector<std::uint8_t>& out, const VrpnHeader& header,
                      const VrpnPose& pose);

/// Datagram by which a client requests a server to connect to the client: "<ip> <port>" and a NUL.
struct VrpnCallback {
  std::string address;
  int port = 0;
};
std::optional<VrpnCallback> decode_vrpn_callback(Bytes datagram);
void append_vrpn_callback(std::vector<std::uint8_t>& out, const VrpnCallback& callback);

}  // namespace vantage::wire::vicon
