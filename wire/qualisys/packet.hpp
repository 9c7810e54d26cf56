#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wire/vicon/bytes.hpp"
#include "wire/vicon/stream_buffer.hpp"

// Packets of the real-time protocol of Qualisys Track Manager (QTM), versions 1.8 and later, over
// TCP in little-endian order. Lengths are millimetres. Source: public clients of Qualisys (C++ and
// Python SDK) and of KumarRobotics.

namespace vantage::wire::qualisys {

using vicon::Bytes;
using Reader = vicon::Reader<std::endian::little>;
using Writer = vicon::Writer<std::endian::little>;

inline constexpr std::size_t kHeaderBytes = 8;
/// Largest packet that is read, bytes. Parameters of many bodies are the largest.
inline constexpr std::size_t kPacketBytesMax = std::size_t{1} << 20U;

enum class PacketType : std::uint32_t {
  kError = 0,    ///< text of an error message
  kCommand = 1,  ///< text: a command, or the answer to one
  kXml = 2,      ///< parameters as text in XML
  kData = 3,
  kNoMoreData = 4,
  kEvent = 6,  ///< number of an event, one byte
};

struct Packet {
  vicon::Framing state = vicon::Framing::kNeedMore;
  PacketType type = PacketType::kError;
  Bytes body;
  std::size_t bytes = 0;  ///< number of bytes to consume
};

/// Returns the first packet of a stream. A packet smaller than its header or larger than
/// kPacketBytesMax is broken.
Packet next_packet(Bytes stream);

/// Appends a packet with a text and its final NUL: an error, a command or XML.
void append_text(std::vector<std::uint8_t>& out, PacketType type, std::string_view text);
void append_event(std::vector<std::uint8_t>& out, std::uint8_t event);
void append_no_more_data(std::vector<std::uint8_t>& out);
/// Returns the text up to the first NUL, or all bytes if there is none.
std::string_view text_of(Bytes body);

/// Content of a data packet.
enum class Component : std::uint32_t {
  k6D = 5,
  k6DEuler = 6,
  k6DResidual = 11,
  k6DEulerResidual = 12,
};

/// Pose of one body. A body that is not visible has a NaN position.
struct Body {
  Eigen::Vector3f position_mm = Eigen::Vector3f::Zero();
  Eigen::Matrix3f world_from_body = Eigen::Matrix3f::Identity();  ///< only without Euler angles
  Eigen::Vector3f euler_deg = Eigen::Vector3f::Zero();            ///< only with Euler angles
  float residual_mm = 0.0F;  ///< mean error of the markers; only in packets with residuals
};

struct Frame {
  std::int64_t time_us = 0;  ///< µs since the start of the measurement, by the server's clock
  std::uint32_t number = 0;
  Component component = Component::k6DResidual;
  std::uint16_t drop_rate = 0;         ///< 2D data lost by the cameras, per mille
  std::uint16_t out_of_sync_rate = 0;  ///< 2D data out of synchronisation, per mille
  std::vector<Body> bodies;
};

/// Reads the body of a data packet and its first component with poses. Other components are
/// skipped. Returns false if no component has poses, or if a size contradicts the content.
[[nodiscard]] bool decode_frame(Bytes body, Frame& out);
void append_frame(std::vector<std::uint8_t>& out, const Frame& frame);

}  // namespace vantage::wire::qualisys
