#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wire/vicon/datastream.hpp"

// The bodies of the blocks that poses need. Each `decode` fills a value whose memory it reuses and
// answers false, the value then being unspecified, for a body that is too short or whose counts do
// not fit into it; bytes after what it knows are ignored, as Vicon's own client does. Each
// `append` adds one block to a packet. Lengths are millimetres here and only here.

namespace vantage::wire::vicon {

/// 100001: what a server can send, or a client wants.
struct ObjectEnums {
  std::vector<std::uint32_t> types;  ///< ascending
};
bool decode(Bytes body, ObjectEnums& out);
void append(PacketWriter& packet, const ObjectEnums& value);

/// 100002. false asks for one frame.
struct RequestFrame {
  bool streaming = false;
};
bool decode(Bytes body, RequestFrame& out);
void append(PacketWriter& packet, const RequestFrame& value);

/// 100008.
struct RequestNextFrame {
  std::uint32_t count = 1;
};
bool decode(Bytes body, RequestNextFrame& out);
void append(PacketWriter& packet, const RequestNextFrame& value);

/// 100004: what a packet holds, and what the receiver is to keep from the packet before.
struct Contents {
  struct Entry {
    std::uint32_t type = 0;
    std::uint32_t blocks = 0;
  };
  std::vector<Entry> sent;               ///< by ascending type
  std::vector<std::uint32_t> unchanged;  ///< ascending

  [[nodiscard]] bool is_unchanged(std::uint32_t type) const;
};
bool decode(Bytes body, Contents& out);
void append(PacketWriter& packet, const Contents& value);

/// 42: echoed as it came.
struct Ping {
  std::uint64_t id = 0;
};
bool decode(Bytes body, Ping& out);
void append(PacketWriter& packet, const Ping& value);

/// 1.
struct StreamInfo {
  static constexpr double kTicksPerSecond = 135e6;
  std::int64_t period_ticks = 0;
  /// 0 when it is not known.
  [[nodiscard]] double rate_hz() const;
};
bool decode(Bytes body, StreamInfo& out);
void append(PacketWriter& packet, const StreamInfo& value);

/// 2: one subject and what it is made of.
struct SubjectInfo {
  struct Segment {
    std::uint32_t parent_id = 0;  ///< 0: the root
    std::uint32_t id = 0;
    std::array<float, 6> bounds{};
    std::string name;
  };
  struct Marker {
    std::uint32_t id = 0;
    std::string name;
  };
  struct Attachment {
    std::uint32_t marker_id = 0;
    std::uint32_t segment_id = 0;
  };
  std::uint32_t subject_id = 0;
  std::string name;
  std::vector<Segment> segments;
  std::vector<Marker> markers;
  std::vector<Attachment> attachments;
};
bool decode(Bytes body, SubjectInfo& out);
void append(PacketWriter& packet, const SubjectInfo& value);

/// 5. The number kNoFrame means that there is none; Vicon's SDK reports it plus one.
struct FrameInfo {
  static constexpr std::uint32_t kNoFrame = 0xFFFFFFFF;
  std::uint32_t frame_number = 0;
};
bool decode(Bytes body, FrameInfo& out);
void append(PacketWriter& packet, const FrameInfo& value);

/// 36.
struct HardwareFrameInfo {
  std::uint32_t frame_number = 0;
};
bool decode(Bytes body, HardwareFrameInfo& out);
void append(PacketWriter& packet, const HardwareFrameInfo& value);

/// 37.
struct ApplicationInfo {
  bool is_y_up = false;  ///< else z
};
bool decode(Bytes body, ApplicationInfo& out);
void append(PacketWriter& packet, const ApplicationInfo& value);

/// 9 (poses in the world) and 8 (relative to the parent segment; of the root: in the world).
struct Segments {
  struct Pose {
    std::uint32_t segment_id = 0;
    Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d world_from_body = Eigen::Matrix3d::Identity();  ///< row major on the wire
  };
  std::uint32_t subject_id = 0;
  std::vector<Pose> poses;  ///< of those that are seen; an occluded one is absent
};
bool decode(Bytes body, Segments& out);
void append(PacketWriter& packet, const Segments& value, BlockType type = kGlobalSegments);

/// 901: as 8, in single precision, rotations as axis times angle.
struct LightweightSegments {
  struct Pose {
    std::uint32_t segment_id = 0;
    Eigen::Vector3f translation_mm = Eigen::Vector3f::Zero();
    Eigen::Vector3f angle_axis_rad = Eigen::Vector3f::Zero();
  };
  std::uint32_t subject_id = 0;
  std::vector<Pose> poses;
};
bool decode(Bytes body, LightweightSegments& out);
void append(PacketWriter& packet, const LightweightSegments& value);

/// 26: where the time went on the Vicon host.
struct LatencyInfo {
  struct Stage {
    std::string name;
    double latency_s = 0.0;
  };
  std::vector<Stage> stages;
  [[nodiscard]] double total_s() const;
};
bool decode(Bytes body, LatencyInfo& out);
void append(PacketWriter& packet, const LatencyInfo& value);

/// 39: rates by name.
struct FrameRateInfo {
  struct Entry {
    std::string name;
    double rate_hz = 0.0;
  };
  std::vector<Entry> rates;
};
bool decode(Bytes body, FrameRateInfo& out);
void append(PacketWriter& packet, const FrameRateInfo& value);

/// 40: how well Tracker finds an object, 0 … 1.
struct ObjectQuality {
  std::uint32_t subject_id = 0;
  double quality = 0.0;
};
bool decode(Bytes body, ObjectQuality& out);
void append(PacketWriter& packet, const ObjectQuality& value);

/// 29.
struct SubjectHealth {
  std::uint32_t subject_id = 0;
  double marker_error = 0.0;
  double health = 0.0;
};
bool decode(Bytes body, SubjectHealth& out);
void append(PacketWriter& packet, const SubjectHealth& value);

/// 23.
struct Timecode {
  std::uint8_t hours = 0;
  std::uint8_t minutes = 0;
  std::uint8_t seconds = 0;
  std::uint8_t frames = 0;
  std::uint16_t subframe = 0;
  std::uint16_t subframes_per_frame = 0;
  std::uint32_t standard = 0;
  std::uint32_t user_bits = 0;
  std::uint8_t field = 0;
};
bool decode(Bytes body, Timecode& out);
void append(PacketWriter& packet, const Timecode& value);

}  // namespace vantage::wire::vicon
