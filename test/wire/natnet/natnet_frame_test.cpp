#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "test/wire/natnet/natnet_bytes.hpp"
#include "wire/natnet/frame.hpp"

namespace vantage::wire::natnet {
namespace {

using test::NatNetBytes;

constexpr Version k30{{3, 0, 0, 0}};
constexpr Version k40{{4, 0, 0, 0}};
constexpr Version k41{{4, 1, 0, 0}};

void append_rigid_body(NatNetBytes& to, int id, float x_m, std::uint16_t flags) {
  to.i32(id).f32s({x_m, 2.0F, 3.0F, 0.5F, -0.5F, 0.5F, 0.5F, 0.001F}).u16(flags);
}

/// Frame fields that the tests change.
struct Shape {
  bool has_unknown_section = false;  ///< a section of a later version, after the known ones
  std::uint32_t bodies_count = 2;    ///< stated number of rigid bodies; two follow
};

/// Returns a payload with items in each section, written from the published table.
std::vector<std::uint8_t> full_frame(const Version& version, const Shape& shape = {}) {
  const bool is_sized = version >= kSizedSince;
  NatNetBytes out;
  out.u32(1'234);
  const auto section = [&](std::uint32_t count, const NatNetBytes& items) {
    out.u32(count);
    if (is_sized) {
      out.u32(static_cast<std::uint32_t>(items.bytes.size()));
    }
    out.append(items);
  };
  NatNetBytes sets;
  sets.text("QUAD").u32(2).f32s({1, 2, 3, 4, 5, 6});
  sets.text("all").u32(0);
  section(2, sets);
  section(1, NatNetBytes().f32s({7, 8, 9}));  // other markers
  NatNetBytes bodies;
  append_rigid_body(bodies, 2, 1.5F, 1);
  append_rigid_body(bodies, -9, std::numeric_limits<float>::quiet_NaN(), 2);
  section(shape.bodies_count, bodies);
  NatNetBytes skeleton;
  skeleton.i32(1).u32(1);
  append_rigid_body(skeleton, 65'537, 4.0F, 1);
  section(1, skeleton);
  if (is_sized) {
    NatNetBytes asset;
    asset.i32(1).u32(1);
    append_rigid_body(asset, 5, 6.0F, 1);
    asset.u32(1).i32(3).f32s({1, 2, 3, 0.01F}).u16(0).f32s({0});
    section(1, asset);
  }
  NatNetBytes markers;
  markers.i32(131'073).f32s({1, 2, 3, 0.02F}).u16(2).f32s({0.0001F});
  section(1, markers);
  NatNetBytes plate;
  plate.i32(1).u32(2).u32(1).f32s({9}).u32(0);
  section(1, plate);
  NatNetBytes device;
  device.i32(1).u32(1).u32(3).f32s({1, 2, 3});
  section(1, device);
  if (shape.has_unknown_section) {
    section(1, NatNetBytes().zeros(13));
  }
  out.u32(11).u32(12).f64(1'356.125).u64(1'000).u64(2'000).u64(3'000);
  if (is_sized) {
    out.u32(21).u32(22);
  }
  out.u16(kFlagRecording | kFlagDefinitionsChanged).u32(0);
  return out.bytes;
}

TEST(NatNetFrame, ReadsTheReferenceBytesOfEachVersion) {
  for (const Version& version : {k30, k40, k41}) {
    for (const bool has_unknown : {false, true}) {
      Frame frame;
      const auto payload = full_frame(version, {.has_unknown_section = has_unknown});
      if (has_unknown && version < kSizedSince) {
        EXPECT_FALSE(decode_frame(payload, version, frame)) << "the stated size is missing";
        continue;
      }
      ASSERT_TRUE(decode_frame(payload, version, frame)) << to_text(version);
      EXPECT_EQ(frame.number, 1'234u);
      ASSERT_EQ(frame.bodies.size(), 2u);
      EXPECT_EQ(frame.bodies[0].id, 2);
      EXPECT_EQ(frame.bodies[0].position_m, Eigen::Vector3f(1.5F, 2.0F, 3.0F));
      EXPECT_EQ(frame.bodies[0].rotation_xyzw, Eigen::Vector4f(0.5F, -0.5F, 0.5F, 0.5F));
      EXPECT_EQ(frame.bodies[0].mean_error_m, 0.001F);
      EXPECT_TRUE(frame.bodies[0].is_tracked);
      EXPECT_EQ(frame.bodies[1].id, -9);
      EXPECT_TRUE(std::isnan(frame.bodies[1].position_m.x()));
      EXPECT_FALSE(frame.bodies[1].is_tracked) << "only bit 0 counts";
      EXPECT_EQ(frame.since_start_s, 1'356.125);
      EXPECT_EQ(frame.exposed_ticks, 1'000u);
      EXPECT_EQ(frame.received_ticks, 2'000u);
      EXPECT_EQ(frame.sent_ticks, 3'000u);
      EXPECT_EQ(frame.flags, kFlagRecording | kFlagDefinitionsChanged) << to_text(version);
    }
  }
}

// Tests for an error of public readers, which read frames of version 4.1 in the layout of version
// 4.0.
TEST(NatNetFrame, RefusesALayoutOfAnotherVersion) {
  Frame frame;
  EXPECT_FALSE(decode_frame(full_frame(k41), k40, frame));
  EXPECT_FALSE(decode_frame(full_frame(k40), k41, frame));
  EXPECT_FALSE(decode_frame(full_frame(k30), {{2, 10, 0, 0}}, frame));
}

TEST(NatNetFrame, RefusesAnyOtherLength) {
  for (const Version& version : {k30, k41}) {
    const auto whole = full_frame(version);
    Frame frame;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_FALSE(decode_frame(Bytes(whole).first(size), version, frame))
          << size << " of " << whole.size() << " in " << to_text(version);
    }
  }
  auto longer = full_frame(k30);
  longer.push_back(0);
  Frame frame;
  EXPECT_FALSE(decode_frame(longer, k30, frame));
}

TEST(NatNetFrame, RefusesCountsThatContradictTheSize) {
  Frame frame;
  for (const std::uint32_t count : {0u, 1u, 3u, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
    for (const Version& version : {k30, k41}) {
      EXPECT_FALSE(decode_frame(full_frame(version, {.bodies_count = count}), version, frame))
          << count << " in " << to_text(version);
    }
  }
}

TEST(NatNetFrame, ReadsWhatItWrites) {
  for (const Version& version : {k30, k40, k41, Version{{4, 2, 0, 0}}}) {
    for (const int bodies : {0, 1, 300}) {
      Frame frame;
      frame.number = 0xFFFFFFFE;
      for (int i = 0; i < bodies; ++i) {
        frame.bodies.push_back({i,
                                {0.1F * static_cast<float>(i), -2.0F, 3.0F},
                                {0.0F, 0.6F, 0.0F, 0.8F},
                                0.002F,
                                i % 2 == 0});
      }
      frame.exposed_ticks = ~std::uint64_t{0};
      frame.sent_ticks = 5;
      frame.flags = 0xABCD;
      std::vector<std::uint8_t> bytes;
      ASSERT_TRUE(append_frame(bytes, version, frame));
      Frame read;
      ASSERT_TRUE(decode_frame(decode_packet(bytes)->payload, version, read));
      EXPECT_EQ(read.number, frame.number);
      EXPECT_EQ(read.exposed_ticks, frame.exposed_ticks);
      EXPECT_EQ(read.sent_ticks, 5u);
      EXPECT_EQ(read.flags, 0xABCD);
      ASSERT_EQ(read.bodies.size(), frame.bodies.size());
      for (std::size_t i = 0; i < read.bodies.size(); ++i) {
        EXPECT_EQ(read.bodies[i].id, frame.bodies[i].id);
        EXPECT_EQ(read.bodies[i].position_m, frame.bodies[i].position_m);
        EXPECT_EQ(read.bodies[i].rotation_xyzw, frame.bodies[i].rotation_xyzw);
        EXPECT_EQ(read.bodies[i].is_tracked, frame.bodies[i].is_tracked);
      }
    }
  }
  Frame frame;
  frame.bodies.resize(1'800);
  std::vector<std::uint8_t> bytes;
  EXPECT_FALSE(append_frame(bytes, k41, frame)) << "larger than a datagram";
  EXPECT_TRUE(bytes.empty());
}

}  // namespace
}  // namespace vantage::wire::natnet
