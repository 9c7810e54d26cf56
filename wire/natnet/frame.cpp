#include "wire/natnet/frame.hpp"

namespace vantage::wire::natnet {
namespace {

constexpr std::size_t kRigidBodyBytes = 4 + 12 + 16 + 4 + 2;
constexpr std::size_t kLabelledMarkerBytes = 4 + 12 + 4 + 2 + 4;
/// Size of timecode, time since start, three tick counts, flags and end mark.
constexpr std::size_t kLastBytes = 8 + 8 + 24 + 2 + 4;
/// size of a field after the tick counts, since version 4.1
constexpr std::size_t kPrecisionTimeBytes = 8;
constexpr std::uint16_t kTrackedBit = 1;

RigidBody read_body(Reader& from) {
  RigidBody out;
  out.id = from.i32();
  for (float& value : out.position_m) {
    value = from.f32();
  }
  for (float& value : out.rotation_xyzw) {
    value = from.f32();
  }
  out.mean_error_m = from.f32();
  out.is_tracked = (from.u16() & kTrackedBit) != 0;
  return out;
}

void read_bodies(Reader& from, Frame& out) {
  const std::uint32_t count = from.count(kRigidBodyBytes);
  for (std::uint32_t i = 0; i < count; ++i) {
    out.bodies.push_back(read_body(from));
  }
}

/// Skips items of a fixed size.
void skip_items(Reader& from, std::size_t item_bytes) {
  from.take(std::size_t{from.count(item_bytes)} * item_bytes);
}

/// Skips force plates or devices: channels of samples.
void skip_channels(Reader& from) {
  const std::uint32_t items = from.count(8);
  for (std::uint32_t i = 0; i < items && from.ok(); ++i) {
    from.i32();
    const std::uint32_t channels = from.count(4);
    for (std::uint32_t k = 0; k < channels && from.ok(); ++k) {
      skip_items(from, 4);
    }
  }
}

/// Reads the sections before version 4.1, which do not contain their sizes.
void read_plain_sections(Reader& from, Frame& out) {
  const std::uint32_t sets = from.count(5);
  for (std::uint32_t i = 0; i < sets && from.ok(); ++i) {
    from.terminated_text();
    skip_items(from, kVectorBytes);
  }
  skip_items(from, kVectorBytes);  // other markers
  read_bodies(from, out);
  const std::uint32_t skeletons = from.count(8);
  for (std::uint32_t i = 0; i < skeletons && from.ok(); ++i) {
    from.i32();
    skip_items(from, kRigidBodyBytes);
  }
  skip_items(from, kLabelledMarkerBytes);
  skip_channels(from);  // force plates
  skip_channels(from);  // devices
}

/// Reads the rigid bodies of a frame since version 4.1, and skips the sections before them by their
/// sizes. Skips the sections after them as well.
void read_sized_sections(Reader& from, Frame& out) {
  for (int section = 0; section < 2; ++section) {  // marker sets, other markers
    from.u32();
    from.take(from.u32());
  }
  const std::uint32_t count = from.count(kRigidBodyBytes);
  Reader bodies(from.take(from.u32()));
  if (!from.ok() || bodies.left() != std::size_t{count} * kRigidBodyBytes) {
    from.take(from.left() + 1);  // the section's size contradicts its count
    return;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    out.bodies.push_back(read_body(bodies));
  }
  for (int section = 0; section < 5; ++section) {  // skeletons, assets, markers, plates, devices
    from.u32();
    from.take(from.u32());
  }
}

void write_body(Writer& to, const RigidBody& body) {
  to.i32(body.id);
  for (const float value : body.position_m) {
    to.f32(value);
  }
  for (const float value : body.rotation_xyzw) {
    to.f32(value);
  }
  to.f32(body.mean_error_m);
  to.u16(body.is_tracked ? kTrackedBit : 0);
}

void write_section_head(Writer& to, bool is_sized, std::size_t count, std::size_t bytes) {
  to.u32(static_cast<std::uint32_t>(count));
  if (is_sized) {
    to.u32(static_cast<std::uint32_t>(bytes));
  }
}

}  // namespace

bool decode_frame(Bytes payload, const Version& version, Frame& out) {
  const bool is_sized = version >= kSizedSince;
  const std::size_t last_bytes = kLastBytes + (is_sized ? kPrecisionTimeBytes : 0);
  out.bodies.clear();
  if (version < kVersionMin || payload.size() < last_bytes) {
    return false;
  }
  Reader from(payload.first(payload.size() - last_bytes));
  out.number = from.u32();
  if (is_sized) {
    read_sized_sections(from, out);
  } else {
    read_plain_sections(from, out);
  }
  if (!from.ok() || (!is_sized && from.left() > 0)) {
    return false;
  }
  Reader last(payload.last(last_bytes));
  last.u64();  // skips the timecode
  out.since_start_s = last.f64();
  out.exposed_ticks = last.u64();
  out.received_ticks = last.u64();
  out.sent_ticks = last.u64();
  if (is_sized) {
    last.take(kPrecisionTimeBytes);
  }
  out.flags = last.u16();
  return true;
}

bool append_frame(std::vector<std::uint8_t>& out, const Version& version, const Frame& frame) {
  const bool is_sized = version >= kSizedSince;
  PacketWriter packet(out, PacketId::kFrame);
  Writer& to = packet.write();
  to.u32(frame.number);
  write_section_head(to, is_sized, 0, 0);  // marker sets
  write_section_head(to, is_sized, 0, 0);  // other markers
  write_section_head(to, is_sized, frame.bodies.size(), frame.bodies.size() * kRigidBodyBytes);
  for (const RigidBody& body : frame.bodies) {
    write_body(to, body);
  }
  const int others = is_sized ? 5 : 4;  // skeletons, assets, markers, plates, devices
  for (int section = 0; section < others; ++section) {
    write_section_head(to, is_sized, 0, 0);
  }
  to.u64(0);  // timecode
  to.f64(frame.since_start_s);
  to.u64(frame.exposed_ticks);
  to.u64(frame.received_ticks);
  to.u64(frame.sent_ticks);
  if (is_sized) {
    to.zeros(kPrecisionTimeBytes);
  }
  to.u16(frame.flags);
  to.u32(0);  // end mark
  return packet.finish();
}

}  // namespace vantage::wire::natnet
