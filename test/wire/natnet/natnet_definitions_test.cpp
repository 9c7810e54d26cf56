#include <gtest/gtest.h>

#include "test/wire/natnet/natnet_bytes.hpp"
#include "wire/natnet/definitions.hpp"

namespace vantage::wire::natnet {
namespace {

using test::NatNetBytes;

constexpr Version kAll[] = {
    {{3, 0, 0, 0}}, {{3, 1, 0, 0}}, {{4, 0, 0, 0}}, {{4, 1, 0, 0}}, {{4, 2, 0, 0}}};

/// Appends a rigid body with `markers` markers, in the layout of `version`.
void append_body(NatNetBytes& to, const Version& version, const std::string& name, int id,
                 std::uint32_t markers) {
  to.text(name).i32(id).i32(-1).f32s({0.1F, 0.2F, 0.3F});
  if (version >= Version{{4, 2, 0, 0}}) {
    to.f32s({0.0F, 0.0F, 0.0F, 1.0F});
  }
  to.u32(markers);
  for (std::uint32_t i = 0; i < markers; ++i) {
    to.f32s({1.0F, 2.0F, 3.0F});
  }
  for (std::uint32_t i = 0; i < markers; ++i) {
    to.u32(0);
  }
  if (version >= Version{{4, 0, 0, 0}}) {
    for (std::uint32_t i = 0; i < markers; ++i) {
      to.text("marker");
    }
  }
}

/// Returns a payload with a definition of each type, and a rigid body first and last.
std::vector<std::uint8_t> all_types(const Version& version) {
  const bool is_sized = version >= kSizedSince;
  NatNetBytes out;
  out.u32(is_sized ? 8 : 7);
  const auto add = [&](std::uint32_t type, const NatNetBytes& body) {
    out.u32(type);
    if (is_sized) {
      out.u32(static_cast<std::uint32_t>(body.bytes.size()));
    }
    out.append(body);
  };
  NatNetBytes first;
  append_body(first, version, "QUAD", 2, 3);
  NatNetBytes set;
  set.text("all").u32(2).text("QUAD_1").text("QUAD_2");
  NatNetBytes skeleton;
  skeleton.text("Fred").i32(7).u32(1);
  append_body(skeleton, version, "Hip", 1, 2);
  NatNetBytes plate;
  plate.i32(1).text("FP1").zeros(4 * (2 + 3 + 144 + 12 + 2)).u32(2).text("Fx").text("Fy");
  NatNetBytes device;
  device.i32(1).text("Glove").text("S1").zeros(8).u32(1).text("bend");
  NatNetBytes camera;
  camera.text("Prime").zeros(28);
  NatNetBytes last;
  append_body(last, version, "ROVER", 11, 0);
  add(1, first);
  add(0, set);
  add(2, skeleton);
  add(3, plate);
  add(4, device);
  add(5, camera);
  if (is_sized) {
    add(77, NatNetBytes().zeros(5));  // a type of a later version
  }
  add(1, last);
  return out.bytes;
}

TEST(NatNetDefinitions, ReadsRigidBodiesAmongAllTypes) {
  for (const Version& version : kAll) {
    Definitions out;
    decode_definitions(all_types(version), version, out);
    EXPECT_TRUE(out.is_complete) << to_text(version);
    ASSERT_EQ(out.bodies.size(), 2u) << to_text(version);
    EXPECT_EQ(out.bodies[0].name, "QUAD");
    EXPECT_EQ(out.bodies[0].id, 2);
    EXPECT_EQ(out.bodies[1].name, "ROVER");
    EXPECT_EQ(out.bodies[1].id, 11);
  }
}

TEST(NatNetDefinitions, KeepsBodiesBeforeAnUnknownTypeWithoutSize) {
  for (const Version& version : kAll) {
    NatNetBytes body;
    append_body(body, version, "QUAD", 2, 1);
    const bool is_sized = version >= kSizedSince;
    NatNetBytes out;
    out.u32(2).u32(1);
    if (is_sized) {
      out.u32(static_cast<std::uint32_t>(body.bytes.size()));
    }
    out.append(body).u32(99).u32(0);
    Definitions read;
    decode_definitions(out.bytes, version, read);
    EXPECT_EQ(read.is_complete, is_sized) << to_text(version);
    EXPECT_EQ(read.bodies.size(), 1u);
  }
}

TEST(NatNetDefinitions, IsIncompleteAtAnyShorterLength) {
  for (const Version& version : kAll) {
    const std::vector<std::uint8_t> whole = all_types(version);
    Definitions out;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      decode_definitions(Bytes(whole).first(size), version, out);
      EXPECT_FALSE(out.is_complete) << size << " in " << to_text(version);
      EXPECT_LE(out.bodies.size(), 1u);
    }
  }
}

TEST(NatNetDefinitions, RefusesImpossibleCounts) {
  for (const Version& version : kAll) {
    Definitions out;
    decode_definitions(NatNetBytes().u32(0xFFFFFFFF).bytes, version, out);
    EXPECT_FALSE(out.is_complete);
    NatNetBytes body;
    append_body(body, version, "Q", 1, 0);
    body.bytes.resize(body.bytes.size() - 4);
    body.u32(0xFFFFFFFF);  // number of markers
    NatNetBytes payload;
    payload.u32(1).u32(1);
    if (version >= kSizedSince) {
      payload.u32(static_cast<std::uint32_t>(body.bytes.size()));
    }
    payload.append(body);
    decode_definitions(payload.bytes, version, out);
    EXPECT_FALSE(out.is_complete) << to_text(version);
    EXPECT_TRUE(out.bodies.empty());
  }
}

TEST(NatNetDefinitions, ReadsWhatItWrites) {
  for (const Version& version : kAll) {
    std::vector<std::uint8_t> bytes;
    ASSERT_TRUE(append_definitions(bytes, version, {{1, "A"}, {30, "Bö"}}));
    const auto packet = decode_packet(bytes);
    ASSERT_TRUE(packet && packet->id == PacketId::kDefinitions);
    Definitions out;
    decode_definitions(packet->payload, version, out);
    EXPECT_TRUE(out.is_complete);
    ASSERT_EQ(out.bodies.size(), 2u);
    EXPECT_EQ(out.bodies[1].name, "Bö");
    EXPECT_EQ(out.bodies[1].id, 30);
  }
  std::vector<std::uint8_t> bytes;
  EXPECT_FALSE(
      append_definitions(bytes, kAll[0], std::vector<BodyDefinition>(2'000, {1, "too many"})));
  EXPECT_TRUE(bytes.empty());
}

}  // namespace
}  // namespace vantage::wire::natnet
