#include "wire/natnet/definitions.hpp"

namespace vantage::wire::natnet {
namespace {

enum class Type : std::uint32_t {
  kMarkerSet = 0,
  kRigidBody = 1,
  kSkeleton = 2,
  kForcePlate = 3,
  kDevice = 4,
  kCamera = 5,
};

constexpr Version kMarkerNamesSince{{4, 0, 0, 0}};
constexpr Version kRotationSince{{4, 2, 0, 0}};
constexpr std::size_t kQuaternionBytes = 16;
constexpr std::size_t kLabelBytes = 4;
/// Size of width, length, origin, calibration (12 × 12), corners (4 × 3), plate type and data type.
constexpr std::size_t kPlateBytes = 4 * (2 + 3 + 12 * 12 + 4 * 3 + 2);
/// Size of the smallest rigid body: empty name, id, parent, offset, number of markers.
constexpr std::size_t kRigidBodyBytesMin = 1 + 4 + 4 + kVectorBytes + 4;
constexpr std::size_t kEmulatedMarkers = 4;  ///< markers per body that append_definitions() writes

void skip_names(Reader& from, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count && from.ok(); ++i) {
    from.terminated_text();
  }
}

BodyDefinition read_rigid_body(Reader& from, const Version& version) {
  BodyDefinition out;
  out.name = from.terminated_text();
  out.id = from.i32();
  from.i32();  // skips the parent's id
  from.take(kVectorBytes);
  if (version >= kRotationSince) {
    from.take(kQuaternionBytes);
  }
  const std::uint32_t markers = from.count(kVectorBytes + kLabelBytes);
  from.take(std::size_t{markers} * (kVectorBytes + kLabelBytes));
  if (version >= kMarkerNamesSince) {
    skip_names(from, markers);
  }
  return out;
}

/// Skips the body of a definition other than a rigid body. Returns false for an unknown type.
bool skip_other(Reader& from, Type type, const Version& version) {
  switch (type) {
    case Type::kMarkerSet:
      from.terminated_text();
      skip_names(from, from.count(1));
      return true;
    case Type::kSkeleton: {
      from.terminated_text();
      from.i32();
      const std::uint32_t bones = from.count(kRigidBodyBytesMin);
      for (std::uint32_t i = 0; i < bones && from.ok(); ++i) {
        read_rigid_body(from, version);
      }
      return true;
    }
    case Type::kForcePlate:
      from.i32();
      from.terminated_text();
      from.take(kPlateBytes);
      skip_names(from, from.count(1));
      return true;
    case Type::kDevice:
      from.i32();
      from.terminated_text();
      from.terminated_text();
      from.take(8);  // skips the type and the data type
      skip_names(from, from.count(1));
      return true;
    case Type::kCamera:
      from.terminated_text();
      from.take(kVectorBytes + kQuaternionBytes);
      return true;
    case Type::kRigidBody:
      break;
  }
  return false;
}

void write_text(Writer& to, std::string_view text) {
  to.text(text);
  to.u8(0);
}

void write_marker_names(Writer& to, std::string_view body) {
  for (std::size_t i = 1; i <= kEmulatedMarkers; ++i) {
    write_text(to, std::string(body) + "_" + std::to_string(i));
  }
}

void write_rigid_body(Writer& to, const Version& version, const BodyDefinition& body) {
  write_text(to, body.name);
  to.i32(body.id);
  to.i32(-1);
  to.zeros(kVectorBytes);
  if (version >= kRotationSince) {
    to.zeros(kQuaternionBytes - 4);
    to.f32(1.0F);
  }
  to.u32(kEmulatedMarkers);
  for (std::size_t i = 0; i < kEmulatedMarkers; ++i) {
    to.f32(0.05F * static_cast<float>(i));  // m
    to.f32(0.0F);
    to.f32(i % 2 == 0 ? 0.03F : -0.02F);
  }
  to.zeros(kEmulatedMarkers * kLabelBytes);
  if (version >= kMarkerNamesSince) {
    write_marker_names(to, body.name);
  }
}

/// Appends one definition, with its size if the version has sizes.
template <class Write>
void write_definition(std::vector<std::uint8_t>& out, Writer& to, const Version& version, Type type,
                      const Write& write) {
  to.u32(static_cast<std::uint32_t>(type));
  const std::size_t at = out.size();
  if (version >= kSizedSince) {
    to.u32(0);
  }
  const std::size_t begin = out.size();
  write();
  if (version >= kSizedSince) {
    to.patch_u32(at, static_cast<std::uint32_t>(out.size() - begin));
  }
}

}  // namespace

void decode_definitions(Bytes payload, const Version& version, Definitions& out) {
  out.bodies.clear();
  const bool is_sized = version >= kSizedSince;
  Reader from(payload);
  const std::uint32_t count = from.count(is_sized ? 8 : 4);
  out.is_complete = from.ok();
  for (std::uint32_t i = 0; i < count && out.is_complete; ++i) {
    const auto type = static_cast<Type>(from.u32());
    if (is_sized) {
      Reader body(from.take(from.u32()));
      if (from.ok() && type == Type::kRigidBody) {
        BodyDefinition definition = read_rigid_body(body, version);
        if (body.ok()) {
          out.bodies.push_back(std::move(definition));
        }
        out.is_complete = body.ok();
      }
    } else if (type == Type::kRigidBody) {
      BodyDefinition definition = read_rigid_body(from, version);
      if (from.ok()) {
        out.bodies.push_back(std::move(definition));
      }
    } else if (!skip_other(from, type, version)) {
      out.is_complete = false;
    }
    out.is_complete = out.is_complete && from.ok();
  }
}

bool append_definitions(std::vector<std::uint8_t>& out, const Version& version,
                        const std::vector<BodyDefinition>& bodies) {
  PacketWriter packet(out, PacketId::kDefinitions);
  Writer& to = packet.write();
  to.u32(static_cast<std::uint32_t>(2 * bodies.size()));
  for (const BodyDefinition& body : bodies) {
    write_definition(out, to, version, Type::kMarkerSet, [&] {
      write_text(to, body.name);
      to.u32(kEmulatedMarkers);
      write_marker_names(to, body.name);
    });
    write_definition(out, to, version, Type::kRigidBody,
                     [&] { write_rigid_body(to, version, body); });
  }
  return packet.finish();
}

}  // namespace vantage::wire::natnet
