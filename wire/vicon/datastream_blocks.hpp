#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wire/vicon/datastream.hpp"

// Bodies of the blocks that are needed for poses. Each `decode` fills a value and reuses its
// memory. It returns false for a body that is too short or contains a count that exceeds its size;
// the value is then unspecified. Bytes after the known fields are ignored, as in Vicon's client.
// Each `append` adds one block to a packet. Lengths are in mm.

namespace vantage::wire::vicon {

/// Block 100001: the block types that a server offers, or that a client requests.
struct ObjectEnums {
  std::vector<std::uint32_t> types;  ///< ascending
};
bool decode(Bytes body, ObjectEnums& out);
void append(PacketWriter& packet, const ObjectEnums& value);

/// Block 100002: requests frames; streaming = false requests a single frame.
struct RequestFrame {
  bool streaming = false;
};
bool decode(Bytes body, RequestFrame& out);
void append(PacketWriter& packet, const RequestFrame& value);

/// Block 100008: requests the next frames.
struct RequestNextFrame {
  std::uint32_t count = 1;
};
bool decode(Bytes body, RequestNextFrame& out);
void append(PacketWriter& packet, const RequestNextFrame& value);

/// Block 100004: the block types in a packet, and the block types that are unchanged since the
/// previous packet.
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

/// Block 42; the server echoes it unchanged.
struct Ping {
  std::uint64_t id = 0;
};
bool decode(Bytes body, Ping& out);
void append(PacketWriter& packet, const Ping& value);

/// Block 1: frame period.
struct StreamInfo {
  static constexpr double kTicksPerSecond = 135e6;
  std::int64_t period_ticks = 0;
  /// Returns the frame rate, Hz; 0 if unknown.
  [[nodiscard]] double rate_hz() const;
};
bool decode(Bytes body, StreamInfo& out);
void append(PacketWriter& packet, const StreamInfo& value);

/// Block 2: one subject with its segments and markers.
struct SubjectInfo {
  struct Segment {
    std::uint32_t parent_id = 0;  ///< 0: this is the root
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

/// Block 5: frame number. kNoFrame: the frame has no number. Vicon's SDK reports the number plus
/// one.
struct FrameInfo {
  static constexpr std::uint32_t kNoFrame = 0xFFFFFFFF;
  std::uint32_t frame_number = 0;
};
bool decode(Bytes body, FrameInfo& out);
void append(PacketWriter& packet, const FrameInfo& value);

/// Block 36: hardware frame number.
struct HardwareFrameInfo {
  std::uint32_t frame_number = 0;
};
bool decode(Bytes body, HardwareFrameInfo& out);
void append(PacketWriter& packet, const HardwareFrameInfo& value);

/// Block 37: vertical axis.
struct ApplicationInfo {
  bool is_y_up = false;  ///< false: z is up
};
bool decode(Bytes body, ApplicationInfo& out);
void append(PacketWriter& packet, const ApplicationInfo& value);

/// Blocks 9 (poses in the world frame) and 8 (poses relative to the parent segment; the root's pose
/// is in the world frame).
struct Segments {
  struct Pose {
    std::uint32_t segment_id = 0;
    Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d world_from_body = Eigen::Matrix3d::Identity();  ///< row-major in the message
  };
  std::uint32_t subject_id = 0;
  std::vector<Pose> poses;  ///< visible segments only; occluded segments are absent
};
bool decode(Bytes body, Segments& out);
void append(PacketWriter& packet, const Segments& value, BlockType type = kGlobalSegments);

/// Block 901: as block 8, in single precision, with rotations as rotation vectors (axis times
/// angle).
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

/// Block 26: processing times on the Vicon host.
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

/// Block 39: frame rates with their names.
struct FrameRateInfo {
  struct Entry {
    std::string name;
    double rate_hz = 0.0;
  };
  std::vector<Entry> rates;
};
bool decode(Bytes body, FrameRateInfo& out);
void append(PacketWriter& packet, const FrameRateInfo& value);

/// Block 40: quality of Tracker's fit of an object, 0 … 1.
struct ObjectQuality {
  std::uint32_t subject_id = 0;
  double quality = 0.0;
};
bool decode(Bytes body, ObjectQuality& out);
void append(PacketWriter& packet, const ObjectQuality& value);

/// Block 29: marker error of one subject.
struct SubjectHealth {
  std::uint32_t subject_id = 0;
  double marker_error = 0.0;
  double health = 0.0;
};
bool decode(Bytes body, SubjectHealth& out);
void append(PacketWriter& packet, const SubjectHealth& value);

/// Block 23: time code.
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
