#include <algorithm>

#include "wire/vicon/datastream_blocks.hpp"
#include "wire/vicon/datastream_parts.hpp"

// Functions for blocks that control the stream, and for blocks with a single number.

namespace vantage::wire::vicon {

using namespace parts;  // NOLINT(google-build-using-namespace): names for these codecs

namespace {

void read_types(LittleReader& from, std::vector<std::uint32_t>& types) {
  types.resize(from.count(sizeof(std::uint32_t)));
  for (std::uint32_t& type : types) {
    type = from.u32();
  }
}

void write_types(LittleWriter& to, const std::vector<std::uint32_t>& types) {
  write_count(to, types.size());
  for (const std::uint32_t type : types) {
    to.u32(type);
  }
}

}  // namespace

bool decode(Bytes body, ObjectEnums& out) {
  LittleReader reader(body);
  read_types(reader, out.types);
  return reader.ok();
}

void append(PacketWriter& packet, const ObjectEnums& value) {
  append_block(packet, kObjectEnums, [&](LittleWriter& to) { write_types(to, value.types); });
}

bool decode(Bytes body, RequestFrame& out) {
  LittleReader reader(body);
  out.streaming = reader.u8() != 0;
  return reader.ok();
}

void append(PacketWriter& packet, const RequestFrame& value) {
  append_block(packet, kRequestFrame, [&](LittleWriter& to) { to.u8(value.streaming ? 1 : 0); });
}

bool decode(Bytes body, RequestNextFrame& out) {
  LittleReader reader(body);
  out.count = reader.u32();
  return reader.ok();
}

void append(PacketWriter& packet, const RequestNextFrame& value) {
  append_block(packet, kRequestNextFrame, [&](LittleWriter& to) { to.u32(value.count); });
}

bool Contents::is_unchanged(std::uint32_t type) const {
  return std::find(unchanged.begin(), unchanged.end(), type) != unchanged.end();
}

bool decode(Bytes body, Contents& out) {
  LittleReader reader(body);
  out.sent.resize(reader.count(2 * sizeof(std::uint32_t)));
  for (Contents::Entry& entry : out.sent) {
    entry.type = reader.u32();
    entry.blocks = reader.u32();
  }
  read_types(reader, out.unchanged);
  return reader.ok();
}

void append(PacketWriter& packet, const Contents& value) {
  append_block(packet, kContents, [&](LittleWriter& to) {
    write_count(to, value.sent.size());
    for (const Contents::Entry& entry : value.sent) {
      to.u32(entry.type);
      to.u32(entry.blocks);
    }
    write_types(to, value.unchanged);
  });
}

bool decode(Bytes body, Ping& out) {
  LittleReader reader(body);
  out.id = reader.u64();
  return reader.ok();
}

void append(PacketWriter& packet, const Ping& value) {
  append_block(packet, kPing, [&](LittleWriter& to) { to.u64(value.id); });
}

double StreamInfo::rate_hz() const {
  return period_ticks > 0 ? kTicksPerSecond / static_cast<double>(period_ticks) : 0.0;
}

bool decode(Bytes body, StreamInfo& out) {
  LittleReader reader(body);
  out.period_ticks = reader.i64();
  return reader.ok();
}

void append(PacketWriter& packet, const StreamInfo& value) {
  append_block(packet, kStreamInfo, [&](LittleWriter& to) { to.i64(value.period_ticks); });
}

bool decode(Bytes body, FrameInfo& out) {
  LittleReader reader(body);
  out.frame_number = reader.u32();
  return reader.ok();
}

void append(PacketWriter& packet, const FrameInfo& value) {
  append_block(packet, kFrameInfo, [&](LittleWriter& to) { to.u32(value.frame_number); });
}

bool decode(Bytes body, HardwareFrameInfo& out) {
  LittleReader reader(body);
  out.frame_number = reader.u32();
  return reader.ok();
}

void append(PacketWriter& packet, const HardwareFrameInfo& value) {
  append_block(packet, kHardwareFrameInfo, [&](LittleWriter& to) { to.u32(value.frame_number); });
}

bool decode(Bytes body, ApplicationInfo& out) {
  LittleReader reader(body);
  out.is_y_up = reader.u8() == 1;
  return reader.ok();
}

void append(PacketWriter& packet, const ApplicationInfo& value) {
  append_block(packet, kApplicationInfo, [&](LittleWriter& to) { to.u8(value.is_y_up ? 1 : 0); });
}

bool decode(Bytes body, Timecode& out) {
  LittleReader reader(body);
  out.hours = reader.u8();
  out.minutes = reader.u8();
  out.seconds = reader.u8();
  out.frames = reader.u8();
  out.subframe = reader.u16();
  out.subframes_per_frame = reader.u16();
  out.standard = reader.u32();
  out.user_bits = reader.u32();
  out.field = reader.u8();
  return reader.ok();
}

void append(PacketWriter& packet, const Timecode& value) {
  append_block(packet, kTimecode, [&](LittleWriter& to) {
    to.u8(value.hours);
    to.u8(value.minutes);
    to.u8(value.seconds);
    to.u8(value.frames);
    to.u16(value.subframe);
    to.u16(value.subframes_per_frame);
    to.u32(value.standard);
    to.u32(value.user_bits);
    to.u8(value.field);
  });
}

}  // namespace vantage::wire::vicon
