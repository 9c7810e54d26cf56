#include <gtest/gtest.h>

#include "test/wire/vicon/vicon_bytes.hpp"
#include "wire/vicon/datastream_blocks.hpp"
#include "wire/vicon/identify.hpp"
#include "wire/vicon/object_stream.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::wire::vicon {
namespace {

using test::from_hex;
using test::from_text;

TEST(VrpnCookie, HasTheWorkedBytes) {
  std::vector<std::uint8_t> cookie;
  append_vrpn_cookie(cookie);
  std::vector<std::uint8_t> expected = from_text("vrpn: ver. 07.35  0");
  expected.resize(24, 0);
  EXPECT_EQ(cookie, expected);
  const auto version = decode_vrpn_cookie(cookie);
  ASSERT_TRUE(version);
  EXPECT_EQ(version->major, 7);
  EXPECT_EQ(version->minor, 35);
}

TEST(VrpnCookie, IsRefusedWhenItIsNone) {
  EXPECT_FALSE(decode_vrpn_cookie({}));
  EXPECT_FALSE(decode_vrpn_cookie(from_text("vrpn: ver. 07.35  0")));  // 19 of 24 bytes
  EXPECT_FALSE(decode_vrpn_cookie(from_text("vrpn: ver. ab.cd  0     ")));
  EXPECT_FALSE(decode_vrpn_cookie(from_text("SSH-2.0-OpenSSH_9.2p1 De")));
}

TEST(VrpnMessage, PoseHasItsBytes) {
  std::vector<std::uint8_t> bytes;
  append_vrpn_pose(bytes, {1, 2, 3, 4}, {5, {1.0, -2.0, 0.5}, {0.0, 0.0, 0.6, 0.8}});
  EXPECT_EQ(bytes, from_hex("00000058 00000001 00000002 00000003 00000004 00000000"
                            "00000005 00000000"
                            "3ff0000000000000 c000000000000000 3fe0000000000000"
                            "0000000000000000 0000000000000000 3fe3333333333333 3fe999999999999a"));
  VrpnHeader header;
  const Framed framed = next_vrpn_message(bytes, header);
  ASSERT_EQ(framed.state, Framing::kWhole);
  EXPECT_EQ(framed.bytes, bytes.size());
  EXPECT_EQ(header.seconds, 1u);
  EXPECT_EQ(header.microseconds, 2u);
  EXPECT_EQ(header.sender, 3);
  EXPECT_EQ(header.type, 4);
  const auto pose = decode_vrpn_pose(framed.body);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->sensor, 5);
  EXPECT_EQ(pose->position_m, Eigen::Vector3d(1.0, -2.0, 0.5));
  EXPECT_EQ(pose->quaternion_xyzw, Eigen::Vector4d(0.0, 0.0, 0.6, 0.8));
  EXPECT_FALSE(decode_vrpn_pose(framed.body.first(56)));
}

TEST(VrpnMessage, NamesArePaddedButNotCountedSo) {
  std::vector<std::uint8_t> bytes;
  append_vrpn_name(bytes, kVrpnSenderDescription, 9, "quad1");
  // 4 + 5 + NUL = 10 bytes of payload, padded to 16.
  EXPECT_EQ(bytes, from_hex("00000022 00000000 00000000 00000009 ffffffff 00000000"
                            "00000006 7175616431 00 000000000000"));
  VrpnHeader header;
  const Framed framed = next_vrpn_message(bytes, header);
  ASSERT_EQ(framed.state, Framing::kWhole);
  EXPECT_EQ(framed.body.size(), 10u);
  EXPECT_EQ(framed.bytes, 40u);
  EXPECT_EQ(header.type, kVrpnSenderDescription);
  EXPECT_EQ(decode_vrpn_name(framed.body), "quad1");
  EXPECT_FALSE(decode_vrpn_name(from_hex("00000001 00"))) << "empty";
  EXPECT_FALSE(decode_vrpn_name(from_hex("00000007 717561"))) << "longer than its message";
}

TEST(VrpnMessage, VelocityAndPlainOnesComeBackAsTheyWere) {
  std::vector<std::uint8_t> bytes;
  append_vrpn_velocity(bytes, {1, 2, 3, 4}, {0, {0.1, 0.2, 0.3}, {0, 0, 0, 1}, 0.01});
  append_vrpn_message(bytes, {0, 0, 1, 2}, {});
  append_vrpn_message(bytes, {0, 0, 1, 3}, from_hex("abcdef"));
  VrpnHeader header;
  Bytes rest(bytes);
  Framed framed = next_vrpn_message(rest, header);
  const auto velocity = decode_vrpn_velocity(framed.body);
  ASSERT_TRUE(velocity);
  EXPECT_EQ(velocity->interval_s, 0.01);
  EXPECT_EQ(velocity->velocity_mps.y(), 0.2);
  rest = rest.subspan(framed.bytes);
  framed = next_vrpn_message(rest, header);
  EXPECT_EQ(framed.bytes, 24u);
  EXPECT_TRUE(framed.body.empty());
  rest = rest.subspan(framed.bytes);
  framed = next_vrpn_message(rest, header);
  EXPECT_EQ(framed.bytes, 32u);
  EXPECT_EQ(framed.body.size(), 3u);
  EXPECT_EQ(header.type, 3);
}

TEST(VrpnMessage, LengthsThatCannotBeBreakTheStream) {
  VrpnHeader header;
  EXPECT_EQ(next_vrpn_message(from_hex("000000"), header).state, Framing::kNeedMore);
  EXPECT_EQ(next_vrpn_message(from_hex("00000017"), header).state, Framing::kBroken);
  EXPECT_EQ(next_vrpn_message(from_hex("7fffffff"), header).state, Framing::kBroken);
  EXPECT_EQ(next_vrpn_message(from_hex("01002b1a"), header).state, Framing::kBroken);
  EXPECT_EQ(next_vrpn_message(from_hex("00000018"), header).state, Framing::kNeedMore);
}

TEST(VrpnCallback, IsTextOfAddressAndPort) {
  std::vector<std::uint8_t> bytes;
  append_vrpn_callback(bytes, {"10.0.0.7", 40123});
  std::vector<std::uint8_t> expected = from_text("10.0.0.7 40123");
  expected.push_back(0);
  EXPECT_EQ(bytes, expected);
  const auto callback = decode_vrpn_callback(bytes);
  ASSERT_TRUE(callback);
  EXPECT_EQ(callback->address, "10.0.0.7");
  EXPECT_EQ(callback->port, 40123);
  for (const char* bad : {"", " 1", "host", "host ", "host 0", "host 65536", "host 1x", "h 1 2"}) {
    EXPECT_FALSE(decode_vrpn_callback(from_text(bad))) << bad;
  }
}

TEST(VrpnCallback, NamesItsHostInFull) {
  const std::string host = "motion-capture-room-two.robotics.example.org";
  std::vector<std::uint8_t> bytes;
  append_vrpn_callback(bytes, {host, 40123});
  const auto callback = decode_vrpn_callback(bytes);
  ASSERT_TRUE(callback);
  EXPECT_EQ(callback->address, host);
  EXPECT_EQ(callback->port, 40123);
}

TEST(IdentifyStream, TakesWhatPrintsForTextAndNothingElse) {
  for (int c = 0; c < 256; ++c) {
    const std::string text(8, static_cast<char>(c));
    const bool is_text = (c >= 0x20 && c <= 0x7e) || c == '\r' || c == '\n' || c == '\t';
    EXPECT_EQ(identify_stream(from_text(text)), is_text ? Speaker::kText : Speaker::kUnknown) << c;
  }
}

TEST(IdentifyStream, TellsTheServersApart) {
  std::vector<std::uint8_t> datastream;
  PacketWriter packet(datastream);
  append(packet, ObjectEnums{{5, 9}});
  packet.finish();
  EXPECT_EQ(identify_stream(datastream), Speaker::kDataStream);
  EXPECT_EQ(identify_stream(Bytes(datastream).first(3)), Speaker::kTooFewBytes);
  std::vector<std::uint8_t> cookie;
  append_vrpn_cookie(cookie);
  EXPECT_EQ(identify_stream(cookie), Speaker::kVrpn);
  EXPECT_EQ(identify_stream(Bytes(cookie).first(5)), Speaker::kTooFewBytes);
  EXPECT_EQ(identify_stream(from_text("SSH-2.0-OpenSSH")), Speaker::kText);
  std::vector<std::uint8_t> qualisys = from_hex("0000002b 00000001");
  for (const char c : std::string("QTM RT Interface connected")) {
    qualisys.push_back(static_cast<std::uint8_t>(c));
  }
  EXPECT_EQ(identify_stream(qualisys), Speaker::kQualisys);
  EXPECT_EQ(identify_stream(from_hex("ff00ff00ff00ff00")), Speaker::kUnknown);
  EXPECT_EQ(identify_stream({}), Speaker::kTooFewBytes);
}

TEST(IdentifyDatagram, TellsTheStreamsApart) {
  ObjectBlock block;
  block.objects.resize(2);
  block.objects[0].set_name("a");
  block.objects[1].set_name("b");
  std::vector<std::uint8_t> datagram;
  encode_object_block(block, 256, datagram);
  EXPECT_EQ(identify_datagram(datagram), Speaker::kObjectStream);
  for (const double far_mm : {1.1e7, -1.1e7}) {  // nonsense; no room is as large
    ObjectBlock far = block;
    far.objects[1].translation_mm.y() = far_mm;
    datagram.clear();
    encode_object_block(far, 256, datagram);
    EXPECT_EQ(identify_datagram(datagram), Speaker::kUnknown) << far_mm;
  }
  EXPECT_EQ(identify_datagram(from_text("10.0.0.7 4000")), Speaker::kVrpn);
  EXPECT_EQ(identify_datagram(from_hex("0100 2B1A 00000000")), Speaker::kDataStream);
  EXPECT_EQ(identify_datagram(from_hex("00 01 02 03 04 05 06 07")), Speaker::kUnknown);
}

}  // namespace
}  // namespace vantage::wire::vicon
