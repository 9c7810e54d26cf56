#include <set>

#include <gtest/gtest.h>

#include "test/wire/vicon/vicon_bytes.hpp"
#include "wire/vicon/datastream_blocks.hpp"

namespace vantage::wire::vicon {
namespace {

using test::from_hex;

/// Returns a packet with `value` as its only block.
template <class Value>
std::vector<std::uint8_t> packet_of(const Value& value) {
  std::vector<std::uint8_t> bytes;
  PacketWriter packet(bytes);
  append(packet, value);
  packet.finish();
  return bytes;
}

/// Returns the only block of `packet`; the packet must outlive the returned block.
Block only_block(const std::vector<std::uint8_t>& packet) {
  const Framed framed = next_packet(packet);
  EXPECT_EQ(framed.state, Framing::kWhole);
  EXPECT_EQ(framed.bytes, packet.size());
  BlockCursor cursor(framed.body);
  const auto block = cursor.next();
  EXPECT_TRUE(block);
  EXPECT_FALSE(cursor.next());
  EXPECT_FALSE(cursor.is_broken());
  return block.value_or(Block{});
}

/// Encodes and decodes `value`; checks that every shorter body is refused.
template <class Value>
Value there_and_back(const Value& value, std::uint32_t type) {
  const std::vector<std::uint8_t> packet = packet_of(value);
  const Block block = only_block(packet);
  EXPECT_EQ(block.type, type);
  Value read;
  for (std::size_t bytes = 0; bytes < block.body.size(); ++bytes) {
    EXPECT_FALSE(decode(block.body.first(bytes), read)) << "of type " << type << " at " << bytes;
  }
  std::vector<std::uint8_t> longer(block.body.begin(), block.body.end());
  longer.insert(longer.end(), 3, 0xEE);
  EXPECT_TRUE(decode(longer, read)) << "additional bytes belong to a later version";
  EXPECT_TRUE(decode(block.body, read));
  EXPECT_EQ(packet_of(read), packet);
  return read;
}

TEST(DataStream, FirstServerPacketMatchesTheReferenceBytes) {
  const auto bytes = from_hex(
      "01 00 2B 1A | 14 00 00 00 | A1 86 01 00 | 0C 00 00 00 | 02 00 00 00 | 05 00 00 00 | 09 00 "
      "00 "
      "00");
  EXPECT_EQ(packet_of(ObjectEnums{{5, 9}}), bytes);
  const Block block = only_block(bytes);
  EXPECT_EQ(block.type, kObjectEnums);
  ObjectEnums enums;
  ASSERT_TRUE(decode(block.body, enums));
  EXPECT_EQ(enums.types, (std::vector<std::uint32_t>{5, 9}));
}

TEST(DataStream, ClientRequestMatchesTheReferenceBytes) {
  const auto bytes = from_hex("01 00 2B 1A | 09 00 00 00 | A2 86 01 00 | 01 00 00 00 | 01");
  EXPECT_EQ(packet_of(RequestFrame{true}), bytes);
  RequestFrame request;
  ASSERT_TRUE(decode(only_block(bytes).body, request));
  EXPECT_TRUE(request.streaming);
}

TEST(DataStream, BlocksRoundTrip) {
  EXPECT_EQ(there_and_back(RequestNextFrame{7}, 100008).count, 7u);
  EXPECT_EQ(there_and_back(Ping{0x0123456789ABCDEF}, 42).id, 0x0123456789ABCDEFu);
  EXPECT_EQ(there_and_back(FrameInfo{123456}, 5).frame_number, 123456u);
  EXPECT_EQ(there_and_back(HardwareFrameInfo{99}, 36).frame_number, 99u);
  EXPECT_TRUE(there_and_back(ApplicationInfo{true}, 37).is_y_up);
  EXPECT_EQ(there_and_back(StreamInfo{1'350'000}, 1).rate_hz(), 100.0);
  EXPECT_EQ(StreamInfo{0}.rate_hz(), 0.0);
  EXPECT_EQ(there_and_back(ObjectQuality{3, 0.75}, 40).quality, 0.75);
  EXPECT_EQ(there_and_back(SubjectHealth{3, 0.5, 0.25}, 29).health, 0.25);
  EXPECT_EQ(there_and_back(Timecode{1, 2, 3, 4, 5, 6, 7, 8, 9}, 23).field, 9);
  const LatencyInfo latency = there_and_back(LatencyInfo{{{"Camera", 0.002}, {"Core", 0.003}}}, 26);
  EXPECT_DOUBLE_EQ(latency.total_s(), 0.005);
  EXPECT_EQ(latency.stages[1].name, "Core");
  EXPECT_EQ(there_and_back(FrameRateInfo{{{"System", 100.0}}}, 39).rates[0].rate_hz, 100.0);
  const Contents contents = there_and_back(Contents{{{5, 1}, {9, 2}}, {2, 37}}, 100004);
  EXPECT_EQ(contents.sent[1].blocks, 2u);
  EXPECT_TRUE(contents.is_unchanged(37));
  EXPECT_FALSE(contents.is_unchanged(9));
}

TEST(DataStream, SubjectsAndPosesRoundTrip) {
  SubjectInfo subject;
  subject.subject_id = 4;
  subject.name = "drohne ä";  // UTF-8 is preserved
  subject.segments = {{0, 1, {1, 2, 3, 4, 5, 6}, "drohne ä"}, {1, 2, {}, "arm"}};
  subject.markers = {{1, "m1"}, {2, ""}};
  subject.attachments = {{1, 1}, {2, 2}};
  const SubjectInfo subject_back = there_and_back(subject, 2);
  EXPECT_EQ(subject_back.segments[1].name, "arm");
  EXPECT_EQ(subject_back.segments[0].bounds[5], 6.0F);
  EXPECT_EQ(subject_back.attachments[1].segment_id, 2u);

  Segments segments;
  segments.subject_id = 4;
  segments.poses.resize(2);
  segments.poses[1].segment_id = 2;
  segments.poses[1].translation_mm = {1.5, -2.5, 3.5};
  segments.poses[1].world_from_body << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  const Segments segments_back = there_and_back(segments, 9);
  EXPECT_EQ(segments_back.poses[1].world_from_body, segments.poses[1].world_from_body);

  LightweightSegments light;
  light.subject_id = 4;
  light.poses = {{1, {1.0F, 2.0F, 3.0F}, {0.1F, 0.2F, 0.3F}}};
  EXPECT_EQ(there_and_back(light, 901).poses[0].angle_axis_rad.z(), 0.3F);
}

TEST(DataStream, UnnamedItemsRoundTrip) {
  SubjectInfo subject;
  subject.segments.resize(5);
  EXPECT_EQ(there_and_back(subject, kSubjectInfo).segments.size(), 5u);
  subject.markers.resize(5);
  EXPECT_EQ(there_and_back(subject, kSubjectInfo).markers.size(), 5u);
  EXPECT_EQ(there_and_back(LatencyInfo{{{"", 0.002}, {"", 0.003}}}, 26).stages.size(), 2u);
}

TEST(DataStream, RotationsAreRowMajor) {
  Segments segments;
  segments.poses.resize(1);
  segments.poses[0].world_from_body << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  const std::vector<std::uint8_t> packet = packet_of(segments);
  Reader<std::endian::little> reader(only_block(packet).body);
  static_cast<void>(reader.take(4 + 4 + 4 + 3 * 8));
  for (int k = 1; k <= 9; ++k) {
    EXPECT_EQ(reader.f64(), k);
  }
}

TEST(NextPacket, DetectsAWrongStreamAtItsFirstWrongByte) {
  EXPECT_EQ(next_packet({}).state, Framing::kNeedMore);
  EXPECT_EQ(next_packet(from_hex("01")).state, Framing::kNeedMore);
  EXPECT_EQ(next_packet(from_hex("0100 2B1A 0000")).state, Framing::kNeedMore);
  EXPECT_EQ(next_packet(from_hex("76")).state, Framing::kBroken);
  EXPECT_EQ(next_packet(from_hex("0100 2C")).state, Framing::kBroken);
  EXPECT_EQ(next_packet(from_hex("0100 2B1A ffffffff")).state, Framing::kBroken) << "4 GiB";
  const auto empty = from_hex("0100 2B1A 00000000");
  EXPECT_EQ(next_packet(empty).state, Framing::kWhole);
  EXPECT_EQ(next_packet(empty).bytes, 8u);
}

TEST(BlockCursor, StopsAtABlockThatExceedsThePacket) {
  const auto body = from_hex("05000000 04000000 01020304 | 09000000 ff000000 00");
  BlockCursor cursor(body);
  const auto first = cursor.next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->type, 5u);
  EXPECT_FALSE(cursor.next());
  EXPECT_TRUE(cursor.is_broken());
  EXPECT_FALSE(cursor.next());
}

TEST(Decode, RefusesImpossibleCountsWithoutAllocating) {
  SubjectInfo subject;
  EXPECT_FALSE(decode(from_hex("01000000 ffffffff"), subject));
  EXPECT_FALSE(decode(from_hex("01000000 00000000 ffffffff"), subject));
  Segments segments;
  EXPECT_FALSE(decode(from_hex("01000000 ffffff7f"), segments));
  EXPECT_TRUE(segments.poses.empty());
  ObjectEnums enums;
  EXPECT_FALSE(decode(from_hex("00000040"), enums)) << "4 · count overflows 32 bits";
  Contents contents;
  EXPECT_FALSE(decode(from_hex("00000020 00000000"), contents)) << "8 · count overflows 32 bits";
}

TEST(IsStatic, ClassifiesTypesLikeTheSdk) {
  for (const std::uint32_t type : {1u, 2u, 29u, 37u, 40u}) {
    EXPECT_TRUE(is_static(type) && !is_dynamic(type)) << type;
  }
  for (const std::uint32_t type : {5u, 8u, 9u, 23u, 26u, 36u, 39u, 901u}) {
    EXPECT_TRUE(is_dynamic(type) && !is_static(type)) << type;
  }
  for (const std::uint32_t type : {42u, 100001u, 100003u, 100004u}) {
    EXPECT_TRUE(!is_dynamic(type) && !is_static(type)) << type;
  }
}

// The SDK divides types into classes: types that describe the scene, types of a frame, and others.
TEST(IsStatic, ClassifiesEveryTypeLikeTheSdk) {
  const std::set<std::uint32_t> scene{1,  2,  3,  4,  14, 19, 20,   27,   28,
                                      29, 33, 34, 37, 38, 40, 1401, 28001};
  for (std::uint32_t type = 0; type < 100'020; ++type) {
    ASSERT_EQ(is_static(type), scene.contains(type)) << type;
    const bool is_said_beside = type == 42 || type > 100'000;
    ASSERT_EQ(is_dynamic(type), !scene.contains(type) && !is_said_beside) << type;
  }
}

TEST(PacketWriter, WritesBlocksIntoSeveralPackets) {
  std::vector<std::uint8_t> bytes{9, 9, 9};  // earlier content must be preserved
  std::vector<std::size_t> ends;
  for (const std::uint32_t first : {1u, 4u}) {
    PacketWriter packet(bytes);
    for (std::uint32_t k = 0; k < 3; ++k) {
      packet.begin_block(first + k);
      packet.body().zeros(first * k);
      packet.end_block();
    }
    packet.finish();
    ends.push_back(bytes.size());
  }
  ASSERT_EQ(bytes.size(), 3u + (8 + 3 * 8 + 3 * 1) + (8 + 3 * 8 + 3 * 4));
  Bytes rest = Bytes(bytes).subspan(3);
  for (const std::uint32_t first : {1u, 4u}) {
    const Framed framed = next_packet(rest);
    ASSERT_EQ(framed.state, Framing::kWhole);
    EXPECT_EQ(framed.bytes, framed.body.size() + 8);
    BlockCursor cursor(framed.body);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto block = cursor.next();
      ASSERT_TRUE(block);
      EXPECT_EQ(block->type, first + k);
      EXPECT_EQ(block->body.size(), first * k);
    }
    EXPECT_FALSE(cursor.next());
    EXPECT_FALSE(cursor.is_broken());
    for (std::size_t part = 0; part < framed.bytes; ++part) {
      EXPECT_EQ(next_packet(rest.first(part)).state, Framing::kNeedMore) << part;
    }
    rest = rest.subspan(framed.bytes);
  }
  EXPECT_TRUE(rest.empty());
}

TEST(NextPacket, LimitsPacketsToTwoMebibytes) {
  const auto state_of = [](std::uint32_t body_bytes) {
    std::vector<std::uint8_t> header;
    Writer<std::endian::little> writer(header);
    writer.u32(kPacketMagic);
    writer.u32(body_bytes);
    return next_packet(header).state;
  };
  EXPECT_EQ(state_of((2u << 20u) - 8), Framing::kNeedMore);
  EXPECT_EQ(state_of((2u << 20u) - 7), Framing::kBroken);
  for (std::size_t at = 0; at < 4; ++at) {
    auto header = from_hex("0100 2B1A 00000000");
    header[at] ^= 0x40;
    EXPECT_EQ(next_packet(header).state, Framing::kBroken) << at;
    EXPECT_EQ(next_packet(Bytes(header).first(at + 1)).state, Framing::kBroken) << at;
  }
}

TEST(Decode, ReadsBooleansFromAnyByte) {
  RequestFrame request;
  ApplicationInfo application;
  for (int byte = 0; byte < 256; ++byte) {
    const std::vector<std::uint8_t> body{static_cast<std::uint8_t>(byte)};
    ASSERT_TRUE(decode(body, request) && decode(body, application));
    EXPECT_EQ(request.streaming, byte != 0) << byte;
    EXPECT_EQ(application.is_y_up, byte == 1) << byte;
  }
  EXPECT_FALSE(there_and_back(RequestFrame{false}, kRequestFrame).streaming);
  EXPECT_FALSE(there_and_back(ApplicationInfo{false}, kApplicationInfo).is_y_up);
  EXPECT_EQ(StreamInfo{-1}.rate_hz(), 0.0);
  EXPECT_EQ(StreamInfo{1}.rate_hz(), 135e6);
  EXPECT_EQ(RequestNextFrame{}.count, 1u);
}

/// Expects that a count of elements of `element_bytes` each, after the bytes `head`, is accepted if
/// the bytes are present. If one byte is missing, nothing may be allocated. `elements` returns the
/// number of decoded elements.
template <class Value, class Elements>
void expect_room_for_all(const std::vector<std::uint8_t>& head, std::size_t element_bytes,
                         const Elements& elements) {
  for (const std::uint32_t count : {1u, 2u, 5u, 40u}) {
    std::vector<std::uint8_t> body = head;
    Writer<std::endian::little> writer(body);
    writer.u32(count);
    writer.zeros(count * element_bytes - 1);
    Value value;
    EXPECT_FALSE(decode(body, value));
    EXPECT_EQ(elements(value), 0u) << count << " of " << element_bytes;
    writer.zeros(1 + 8);  // the missing byte, and a count of zero for any following list
    EXPECT_TRUE(decode(body, value));
    EXPECT_EQ(elements(value), count) << count << " of " << element_bytes;
  }
}

TEST(Decode, AllocatesNothingForImpossibleCounts) {
  const auto id = from_hex("01000000");
  expect_room_for_all<Segments>(id, 100, [](const auto& v) { return v.poses.size(); });
  expect_room_for_all<LightweightSegments>(id, 28, [](const auto& v) { return v.poses.size(); });
  expect_room_for_all<LatencyInfo>({}, 12, [](const auto& v) { return v.stages.size(); });
  expect_room_for_all<FrameRateInfo>({}, 12, [](const auto& v) { return v.rates.size(); });
  expect_room_for_all<ObjectEnums>({}, 4, [](const auto& v) { return v.types.size(); });
  expect_room_for_all<Contents>({}, 8, [](const auto& v) { return v.sent.size(); });
  expect_room_for_all<SubjectInfo>(from_hex("01000000 00000000"), 36,
                                   [](const auto& v) { return v.segments.size(); });
  expect_room_for_all<SubjectInfo>(from_hex("01000000 00000000 00000000"), 8,
                                   [](const auto& v) { return v.markers.size(); });
  expect_room_for_all<SubjectInfo>(from_hex("01000000 00000000 00000000 00000000"), 8,
                                   [](const auto& v) { return v.attachments.size(); });
}

TEST(StreamBuffer, KeepsItsCapacityWithoutLoss) {
  StreamBuffer buffer(16);
  std::uint8_t next_in = 0;
  std::uint8_t next_out = 0;
  for (int i = 0; i < 1000; ++i) {
    std::vector<std::uint8_t> bytes;
    for (int k = 0; k < i % 23; ++k) {
      bytes.push_back(static_cast<std::uint8_t>(next_in + k));
    }
    next_in = static_cast<std::uint8_t>(next_in + buffer.push(bytes));
    ASSERT_LE(buffer.view().size(), 16u);
    const std::size_t taken = buffer.view().size() / 2;
    for (std::size_t k = 0; k < taken; ++k) {
      ASSERT_EQ(buffer.view()[k], next_out++);
    }
    buffer.consume(taken);
  }
}

}  // namespace
}  // namespace vantage::wire::vicon
