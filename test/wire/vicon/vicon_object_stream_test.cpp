#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/support/random.hpp"
#include "test/wire/vicon/vicon_bytes.hpp"
#include "wire/vicon/object_stream.hpp"

namespace vantage::wire::vicon {
namespace {

using test::from_hex;

// A datagram with frame 1234 and "quad1" at (1000.5, −250.25, 800) mm, turned by 90° about z.
const std::vector<std::uint8_t> kWorked =
    from_hex("d2040000 01 00 4800 7175616431" + std::string(38, '0') +
             "0000000000448f40 0000000000486fc0 0000000000008940"
             "0000000000000000 0000000000000000 182d4454fb21f93f");

ObjectBlock worked_block() {
  ObjectBlock block;
  block.frame_number = 1234;
  block.objects.resize(1);
  block.objects[0].set_name("quad1");
  block.objects[0].translation_mm = {1000.5, -250.25, 800.0};
  block.objects[0].euler_xyz_rad = {0.0, 0.0, kPi / 2.0};
  return block;
}

TEST(DecodeObjectBlock, ReadsTheReferenceBytes) {
  ASSERT_EQ(kWorked.size(), 80u);
  ObjectBlock block;
  ASSERT_TRUE(decode_object_block(kWorked, block));
  EXPECT_EQ(block.frame_number, 1234u);
  ASSERT_EQ(block.objects.size(), 1u);
  EXPECT_EQ(block.objects[0].name(), "quad1");
  EXPECT_EQ(block.objects[0].translation_mm, Eigen::Vector3d(1000.5, -250.25, 800.0));
  EXPECT_EQ(block.objects[0].euler_xyz_rad, Eigen::Vector3d(0.0, 0.0, kPi / 2.0));
  EXPECT_EQ(block.skipped_items, 0);
  EXPECT_FALSE(block.is_truncated);
}

TEST(EncodeObjectBlock, WritesTheReferenceBytesAndPads) {
  std::vector<std::uint8_t> datagram;
  encode_object_block(worked_block(), 0, datagram);
  EXPECT_EQ(datagram, kWorked);
  encode_object_block(worked_block(), 256, datagram);
  ASSERT_EQ(datagram.size(), 256u);
  EXPECT_TRUE(std::equal(kWorked.begin(), kWorked.end(), datagram.begin()));
  EXPECT_TRUE(std::all_of(datagram.begin() + 80, datagram.end(), [](auto b) { return b == 0; }));
}

TEST(ObjectsPerBlock, EqualsTheDocumentedNumbers) {
  EXPECT_EQ(objects_per_block(256), 3u);
  EXPECT_EQ(objects_per_block(512), 6u);
  EXPECT_EQ(objects_per_block(1024), 13u);
  EXPECT_EQ(objects_per_block(0), 0u);
}

TEST(ObjectsPerBlock, IsLimitedBySizeAndCountField) {
  for (std::size_t objects = 0; objects < 300; ++objects) {
    const std::size_t bytes = 5 + 75 * objects;
    EXPECT_EQ(objects_per_block(bytes), std::min<std::size_t>(objects, 255)) << objects;
    EXPECT_EQ(objects_per_block(bytes + 74), std::min<std::size_t>(objects, 255)) << objects;
  }
  EXPECT_EQ(objects_per_block(4), 0u);
}

TEST(EncodeObjectBlock, HasMinimalLength) {
  ObjectBlock block = worked_block();
  std::vector<std::uint8_t> datagram;
  for (const std::size_t block_bytes : {79u, 80u, 81u}) {
    encode_object_block(block, block_bytes, datagram);
    EXPECT_EQ(datagram.size(), std::max<std::size_t>(block_bytes, 80u));
  }
  block.objects.clear();
  encode_object_block(block, 0, datagram);
  EXPECT_EQ(datagram.size(), kObjectHeaderBytes);
}

// The output object is reused; no data of the previous datagram may remain.
TEST(DecodeObjectBlock, KeepsNothingOfThePreviousDatagram) {
  ObjectBlock block;
  std::vector<std::uint8_t> spoiled = kWorked;
  spoiled[4] = 3;
  spoiled.insert(spoiled.end(), {7, 0, 0});  // an unknown kind, then a premature end
  ASSERT_TRUE(decode_object_block(spoiled, block));
  EXPECT_EQ(block.skipped_items, 1);
  EXPECT_TRUE(block.is_truncated);
  EXPECT_EQ(block.objects.size(), 1u);
  ASSERT_TRUE(decode_object_block(kWorked, block));
  EXPECT_EQ(block.skipped_items, 0);
  EXPECT_FALSE(block.is_truncated);
  EXPECT_EQ(block.objects.size(), 1u);
  EXPECT_FALSE(decode_object_block(Bytes(kWorked).first(4), block));
  EXPECT_TRUE(block.objects.empty());
}

TEST(DecodeObjectBlock, InvertsEncoding) {
  test::Random random(4);
  std::vector<std::uint8_t> datagram;
  ObjectBlock read;
  for (int i = 0; i < 500; ++i) {
    ObjectBlock block;
    block.frame_number = static_cast<std::uint32_t>(random.engine()());
    block.objects.resize(static_cast<std::size_t>(random.integer(0, 13)));
    for (TrackerObject& object : block.objects) {
      object.set_name(std::string(static_cast<std::size_t>(random.integer(1, 30)), 'n'));
      object.translation_mm = random.vector<3>(-1e5, 1e5);
      object.euler_xyz_rad = random.vector<3>(-4.0, 4.0);
    }
    encode_object_block(block, 1024, datagram);
    ASSERT_EQ(datagram.size(), 1024u);
    ASSERT_TRUE(decode_object_block(datagram, read));
    EXPECT_EQ(read.frame_number, block.frame_number);
    ASSERT_EQ(read.objects.size(), block.objects.size());
    for (std::size_t k = 0; k < read.objects.size(); ++k) {
      EXPECT_EQ(read.objects[k].padded_name, block.objects[k].padded_name);
      EXPECT_EQ(read.objects[k].translation_mm, block.objects[k].translation_mm);
      EXPECT_EQ(read.objects[k].euler_xyz_rad, block.objects[k].euler_xyz_rad);
    }
  }
}

TEST(DecodeObjectBlock, SkipsUnknownItemsAndReads24ByteNames) {
  std::vector<std::uint8_t> datagram = from_hex("01000000 04 07 0300 aabbcc 00 0200 ffff");
  const std::vector<std::uint8_t> nameless(75 - 3, 0);
  datagram.insert(datagram.end(), {0, 72, 0});
  datagram.insert(datagram.end(), nameless.begin(), nameless.end());
  datagram.insert(datagram.end(), {0, 72, 0});
  datagram.insert(datagram.end(), 24, 'x');
  datagram.insert(datagram.end(), 48, 0);
  ObjectBlock block;
  ASSERT_TRUE(decode_object_block(datagram, block));
  EXPECT_EQ(block.skipped_items, 3) << "another kind, a short item, an item without a name";
  ASSERT_EQ(block.objects.size(), 1u);
  EXPECT_EQ(block.objects[0].name(), std::string(24, 'x'));
}

TEST(DecodeObjectBlock, ReturnsTheObjectsBeforeATruncation) {
  ObjectBlock block = worked_block();
  block.objects.push_back(block.objects[0]);
  block.objects[1].set_name("quad2");
  std::vector<std::uint8_t> datagram;
  encode_object_block(block, 0, datagram);
  for (std::size_t bytes = 0; bytes < datagram.size(); ++bytes) {
    ObjectBlock read;
    const bool is_block = decode_object_block(Bytes(datagram).first(bytes), read);
    EXPECT_EQ(is_block, bytes >= 5);
    EXPECT_EQ(read.objects.size(), bytes < 80 ? 0u : 1u);
    EXPECT_EQ(read.is_truncated, is_block);
  }
}

}  // namespace
}  // namespace vantage::wire::vicon
