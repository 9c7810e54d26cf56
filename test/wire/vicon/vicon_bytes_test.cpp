#include "test/wire/vicon/vicon_bytes.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "test/support/random.hpp"
#include "wire/vicon/bytes.hpp"
#include "wire/vicon/stream_buffer.hpp"

namespace vantage::wire::vicon {
namespace {

using test::from_hex;

TEST(WriterAndReader, UseTheGivenByteOrder) {
  std::vector<std::uint8_t> little;
  std::vector<std::uint8_t> big;
  Writer<std::endian::little> to_little(little);
  Writer<std::endian::big> to_big(big);
  const auto write = [](auto& to) {
    to.u8(0x01);
    to.u16(0x0203);
    to.u32(0x04050607);
    to.u64(0x08090A0B0C0D0E0F);
    to.i32(-2);
    to.text("az");
    to.zeros(3);
    to.patch_u32(3, 0x14151617);
  };
  write(to_little);
  write(to_big);
  EXPECT_EQ(little, from_hex("01 0302 17161514 0F0E0D0C0B0A0908 FEFFFFFF 617A 000000"));
  EXPECT_EQ(big, from_hex("01 0203 14151617 08090A0B0C0D0E0F FFFFFFFE 617A 000000"));
  EXPECT_EQ(to_little.size(), 24U);
}

template <std::endian kOrder>
void expect_there_and_back() {
  test::Random random(11);
  for (int i = 0; i < 200; ++i) {
    const std::uint64_t bits = random.engine()();
    const double real = random.uniform(-1e9, 1e9);
    std::vector<std::uint8_t> bytes;
    Writer<kOrder> writer(bytes);
    writer.u8(static_cast<std::uint8_t>(bits));
    writer.u16(static_cast<std::uint16_t>(bits));
    writer.u32(static_cast<std::uint32_t>(bits));
    writer.u64(bits);
    writer.i32(static_cast<std::int32_t>(bits));
    writer.i64(static_cast<std::int64_t>(bits));
    writer.f32(static_cast<float>(real));
    writer.f64(real);
    Reader<kOrder> reader(bytes);
    EXPECT_EQ(reader.left(), 39U);
    EXPECT_EQ(reader.u8(), static_cast<std::uint8_t>(bits));
    EXPECT_EQ(reader.u16(), static_cast<std::uint16_t>(bits));
    EXPECT_EQ(reader.u32(), static_cast<std::uint32_t>(bits));
    EXPECT_EQ(reader.u64(), bits);
    EXPECT_EQ(reader.i32(), static_cast<std::int32_t>(bits));
    EXPECT_EQ(reader.i64(), static_cast<std::int64_t>(bits));
    EXPECT_EQ(reader.f32(), static_cast<float>(real));
    EXPECT_EQ(reader.f64(), real);
    EXPECT_TRUE(reader.ok());
    EXPECT_EQ(reader.left(), 0U);
  }
}

TEST(WriterAndReader, RoundTrip) {
  expect_there_and_back<std::endian::little>();
  expect_there_and_back<std::endian::big>();
}

// After a failed read every further read returns zeros, even if bytes remain.
TEST(Reader, ReturnsZerosAfterReadingBeyondTheEnd) {
  const auto bytes = from_hex("03000000 010203");
  Reader<std::endian::little> number(bytes);
  EXPECT_EQ(number.u64(), 0U);
  EXPECT_FALSE(number.ok());
  EXPECT_EQ(number.left(), 0U);
  EXPECT_EQ(number.u8(), 0);
  EXPECT_FALSE(number.ok());
  Reader<std::endian::little> counted(bytes);
  EXPECT_EQ(counted.count(2), 0U) << "three elements of two bytes each";
  EXPECT_FALSE(counted.ok());
  EXPECT_EQ(counted.left(), 0U);
  EXPECT_EQ(counted.u8(), 0);
  EXPECT_FALSE(counted.ok());
}

TEST(Reader, ReadsToTheEnd) {
  const auto bytes = from_hex("03000000 616263");
  Reader<std::endian::little> reader(bytes);
  EXPECT_EQ(reader.count(1), 3U);
  EXPECT_EQ(reader.text(3), "abc");
  EXPECT_TRUE(reader.take(0).empty());
  EXPECT_TRUE(reader.ok());
  EXPECT_TRUE(reader.take(1).empty());
  EXPECT_FALSE(reader.ok());
}

TEST(Reader, RefusesCountsBeyondTheRemainingBytes) {
  for (std::uint32_t elements = 0; elements < 5; ++elements) {
    for (std::size_t rest = 0; rest < 30; ++rest) {
      std::vector<std::uint8_t> bytes;
      Writer<std::endian::big> writer(bytes);
      writer.u32(elements);
      writer.zeros(rest);
      Reader<std::endian::big> reader(bytes);
      const bool has_room = elements * 6 <= rest;
      EXPECT_EQ(reader.count(6), has_room ? elements : 0U);
      EXPECT_EQ(reader.ok(), has_room);
    }
  }
}

TEST(StreamBuffer, IsEmptyAfterConsumeOrClear) {
  const std::vector<std::uint8_t> bytes{1, 2, 3, 4, 5, 6, 7, 8};
  StreamBuffer buffer(8);
  for (const bool is_consumed : {true, false}) {
    EXPECT_EQ(buffer.push(bytes), 8U);
    EXPECT_EQ(buffer.push(bytes), 0U) << "the buffer is full";
    is_consumed ? buffer.consume(8) : buffer.clear();
    EXPECT_TRUE(buffer.view().empty());
  }
  EXPECT_EQ(buffer.push(Bytes(bytes).first(6)), 6U);
  buffer.consume(4);
  EXPECT_EQ(buffer.push(bytes), 6U) << "including the four free bytes at the front";
  const std::vector<std::uint8_t> expected{5, 6, 1, 2, 3, 4, 5, 6};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), buffer.view().begin()));
  EXPECT_EQ(buffer.view().size(), 8U);
}

}  // namespace
}  // namespace vantage::wire::vicon
