#include "wire/vicon/datastream_blocks.hpp"
#include "wire/vicon/datastream_parts.hpp"

// Functions for blocks that describe subjects, and for lists of named numbers.

namespace vantage::wire::vicon {

using namespace parts;  // NOLINT(google-build-using-namespace): names for these codecs

namespace {

constexpr std::size_t kSegmentBytesMin = 2 * 4 + 6 * 4 + kCountBytes;
constexpr std::size_t kMarkerBytesMin = 4 + kCountBytes;
constexpr std::size_t kAttachmentBytes = 8;
constexpr std::size_t kPoseBytes = 4 + 12 * 8;
constexpr std::size_t kLightPoseBytes = 4 + 6 * 4;
constexpr std::size_t kNamedNumberBytesMin = kCountBytes + 8;

}  // namespace

bool decode(Bytes body, SubjectInfo& out) {
  LittleReader reader(body);
  out.subject_id = reader.u32();
  read_string(reader, out.name);
  out.segments.resize(reader.count(kSegmentBytesMin));
  for (SubjectInfo::Segment& segment : out.segments) {
    segment.parent_id = reader.u32();
    segment.id = reader.u32();
    for (float& bound : segment.bounds) {
      bound = reader.f32();
    }
    read_string(reader, segment.name);
  }
  out.markers.resize(reader.count(kMarkerBytesMin));
  for (SubjectInfo::Marker& marker : out.markers) {
    marker.id = reader.u32();
    read_string(reader, marker.name);
  }
  out.attachments.resize(reader.count(kAttachmentBytes));
  for (SubjectInfo::Attachment& attachment : out.attachments) {
    attachment.marker_id = reader.u32();
    attachment.segment_id = reader.u32();
  }
  return reader.ok();
}

void append(PacketWriter& packet, const SubjectInfo& value) {
  append_block(packet, kSubjectInfo, [&](LittleWriter& to) {
    to.u32(value.subject_id);
    write_string(to, value.name);
    write_count(to, value.segments.size());
    for (const SubjectInfo::Segment& segment : value.segments) {
      to.u32(segment.parent_id);
      to.u32(segment.id);
      for (const float bound : segment.bounds) {
        to.f32(bound);
      }
      write_string(to, segment.name);
    }
    write_count(to, value.markers.size());
    for (const SubjectInfo::Marker& marker : value.markers) {
      to.u32(marker.id);
      write_string(to, marker.name);
    }
    write_count(to, value.attachments.size());
    for (const SubjectInfo::Attachment& attachment : value.attachments) {
      to.u32(attachment.marker_id);
      to.u32(attachment.segment_id);
    }
  });
}

bool decode(Bytes body, Segments& out) {
  LittleReader reader(body);
  out.subject_id = reader.u32();
  out.poses.resize(reader.count(kPoseBytes));
  for (Segments::Pose& pose : out.poses) {
    pose.segment_id = reader.u32();
    for (double& component : pose.translation_mm) {
      component = reader.f64();
    }
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 3; ++column) {
        pose.world_from_body(row, column) = reader.f64();
      }
    }
  }
  return reader.ok();
}

void append(PacketWriter& packet, const Segments& value, BlockType type) {
  append_block(packet, type, [&](LittleWriter& to) {
    to.u32(value.subject_id);
    write_count(to, value.poses.size());
    for (const Segments::Pose& pose : value.poses) {
      to.u32(pose.segment_id);
      for (const double component : pose.translation_mm) {
        to.f64(component);
      }
      for (Eigen::Index row = 0; row < 3; ++row) {
        for (Eigen::Index column = 0; column < 3; ++column) {
          to.f64(pose.world_from_body(row, column));
        }
      }
    }
  });
}

bool decode(Bytes body, LightweightSegments& out) {
  LittleReader reader(body);
  out.subject_id = reader.u32();
  out.poses.resize(reader.count(kLightPoseBytes));
  for (LightweightSegments::Pose& pose : out.poses) {
    pose.segment_id = reader.u32();
    for (float& component : pose.translation_mm) {
      component = reader.f32();
    }
    for (float& component : pose.angle_axis_rad) {
      component = reader.f32();
    }
  }
  return reader.ok();
}

void append(PacketWriter& packet, const LightweightSegments& value) {
  append_block(packet, kLightweightSegments, [&](LittleWriter& to) {
    to.u32(value.subject_id);
    write_count(to, value.poses.size());
    for (const LightweightSegments::Pose& pose : value.poses) {
      to.u32(pose.segment_id);
      for (const float component : pose.translation_mm) {
        to.f32(component);
      }
      for (const float component : pose.angle_axis_rad) {
        to.f32(component);
      }
    }
  });
}

double LatencyInfo::total_s() const {
  double total_s = 0.0;
  for (const Stage& stage : stages) {
    total_s += stage.latency_s;
  }
  return total_s;
}

bool decode(Bytes body, LatencyInfo& out) {
  LittleReader reader(body);
  out.stages.resize(reader.count(kNamedNumberBytesMin));
  for (LatencyInfo::Stage& stage : out.stages) {
    read_string(reader, stage.name);
    stage.latency_s = reader.f64();
  }
  return reader.ok();
}

void append(PacketWriter& packet, const LatencyInfo& value) {
  append_block(packet, kLatencyInfo, [&](LittleWriter& to) {
    write_count(to, value.stages.size());
    for (const LatencyInfo::Stage& stage : value.stages) {
      write_string(to, stage.name);
      to.f64(stage.latency_s);
    }
  });
}

bool decode(Bytes body, FrameRateInfo& out) {
  LittleReader reader(body);
  out.rates.resize(reader.count(kNamedNumberBytesMin));
  for (FrameRateInfo::Entry& entry : out.rates) {
    read_string(reader, entry.name);
    entry.rate_hz = reader.f64();
  }
  return reader.ok();
}

void append(PacketWriter& packet, const FrameRateInfo& value) {
  append_block(packet, kFrameRateInfo, [&](LittleWriter& to) {
    write_count(to, value.rates.size());
    for (const FrameRateInfo::Entry& entry : value.rates) {
      write_string(to, entry.name);
      to.f64(entry.rate_hz);
    }
  });
}

bool decode(Bytes body, ObjectQuality& out) {
  LittleReader reader(body);
  out.subject_id = reader.u32();
  out.quality = reader.f64();
  return reader.ok();
}

void append(PacketWriter& packet, const ObjectQuality& value) {
  append_block(packet, kObjectQuality, [&](LittleWriter& to) {
    to.u32(value.subject_id);
    to.f64(value.quality);
  });
}

bool decode(Bytes body, SubjectHealth& out) {
  LittleReader reader(body);
  out.subject_id = reader.u32();
  out.marker_error = reader.f64();
  out.health = reader.f64();
  return reader.ok();
}

void append(PacketWriter& packet, const SubjectHealth& value) {
  append_block(packet, kSubjectHealth, [&](LittleWriter& to) {
    to.u32(value.subject_id);
    to.f64(value.marker_error);
    to.f64(value.health);
  });
}

}  // namespace vantage::wire::vicon
