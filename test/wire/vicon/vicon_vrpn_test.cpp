#include <cmath>
#include <string>
#include <utility>
#include <vector>

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

TEST(VrpnCookie, MatchesTheReferenceBytes) {
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

TEST(VrpnCookie, RefusesOtherBytes) {
  EXPECT_FALSE(decode_vrpn_cookie({}));
  EXPECT_FALSE(decode_vrpn_cookie(from_text("vrpn: ver. 07.35  0")));  // 19 of the 24 bytes
  EXPECT_FALSE(decode_vrpn_cookie(from_text("vrpn: ver. ab.cd  0     ")));
  EXPECT_FALSE(decode_vrpn_cookie(from_text("SSH-2.0-OpenSSH_9.2p1 De")));
}

TEST(VrpnCookie, HasTwoDigitVersionNumbers) {
  std::vector<std::uint8_t> cookies;
  for (int minor = 0; minor < 100; ++minor) {  // all versions in sequence
    append_vrpn_cookie(cookies, minor);
    ASSERT_EQ(cookies.size(), 24U * (static_cast<std::size_t>(minor) + 1));
    const auto version = decode_vrpn_cookie(Bytes(cookies).last(24));
    ASSERT_TRUE(version);
    EXPECT_EQ(version->major, kVrpnMajor);
    EXPECT_EQ(version->minor, minor);
  }
  const auto other = decode_vrpn_cookie(from_text("vrpn: ver. 12.34  0     "));
  ASSERT_TRUE(other);
  EXPECT_EQ(other->major, 12);
  EXPECT_EQ(other->minor, 34);
  for (std::size_t at = 0; at < 16; ++at) {
    for (const char c : {'/', ':', 'v'}) {  // characters next to the digits in ASCII, and a letter
      std::string text = "vrpn: ver. 12.34  0     ";
      const bool is_same = text[at] == c;
      text[at] = c;
      EXPECT_EQ(decode_vrpn_cookie(from_text(text)).has_value(), is_same) << text;
    }
  }
  for (const char* edge : {"vrpn: ver. 00.00  0     ", "vrpn: ver. 99.99  0     "}) {
    EXPECT_TRUE(decode_vrpn_cookie(from_text(edge))) << edge;
  }
}

TEST(VrpnMessage, PoseMatchesTheReferenceBytes) {
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
  EXPECT_FALSE(decode_vrpn_pose(std::vector<std::uint8_t>(72))) << "a velocity message";
}

TEST(VrpnMessage, LengthOfANameExcludesItsPadding) {
  std::vector<std::uint8_t> bytes;
  append_vrpn_name(bytes, kVrpnSenderDescription, 9, "quad1");
  // The payload is 4 + 5 + NUL = 10 bytes, padded to 16.
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

TEST(VrpnMessage, PlainMessagesRoundTrip) {
  std::vector<std::uint8_t> bytes;
  append_vrpn_message(bytes, {0, 0, 1, 2}, {});
  append_vrpn_message(bytes, {0, 0, 1, 3}, from_hex("abcdef"));
  VrpnHeader header;
  Bytes rest(bytes);
  Framed framed = next_vrpn_message(rest, header);
  EXPECT_EQ(framed.bytes, 24u);
  EXPECT_TRUE(framed.body.empty());
  rest = rest.subspan(framed.bytes);
  framed = next_vrpn_message(rest, header);
  EXPECT_EQ(framed.bytes, 32u);
  EXPECT_EQ(framed.body.size(), 3u);
  EXPECT_EQ(header.type, 3);
}

TEST(VrpnMessage, InvalidLengthsEndTheStream) {
  VrpnHeader header;
  EXPECT_EQ(next_vrpn_message(from_hex("000000"), header).state, Framing::kNeedMore);
  EXPECT_EQ(next_vrpn_message(from_hex("00000017"), header).state, Framing::kBroken);
  EXPECT_EQ(next_vrpn_message(from_hex("7fffffff"), header).state, Framing::kBroken);
  EXPECT_EQ(next_vrpn_message(from_hex("01002b1a"), header).state, Framing::kBroken);
  EXPECT_EQ(next_vrpn_message(from_hex("00000018"), header).state, Framing::kNeedMore);
}

TEST(VrpnMessage, LimitsItsSizeTo64Kibibytes) {
  VrpnHeader header;
  EXPECT_EQ(next_vrpn_message(from_hex("00010000"), header).state, Framing::kNeedMore);
  EXPECT_EQ(next_vrpn_message(from_hex("00010001"), header).state, Framing::kBroken);
}

// Names of every length in sequence: each is padded to a multiple of 8 bytes.
TEST(VrpnMessage, NamesRoundTripInSequence) {
  std::vector<std::uint8_t> bytes;
  for (int length = 1; length <= 129; ++length) {
    append_vrpn_name(bytes, kVrpnTypeDescription, length,
                     std::string(static_cast<std::size_t>(length), 'n'));
  }
  Bytes rest(bytes);
  for (int length = 1; length <= 129; ++length) {
    VrpnHeader header;
    const Framed framed = next_vrpn_message(rest, header);
    ASSERT_EQ(framed.state, Framing::kWhole);
    EXPECT_EQ(header.sender, length);
    EXPECT_EQ(header.type, kVrpnTypeDescription);
    EXPECT_EQ(framed.body.size(), static_cast<std::size_t>(length) + 5);
    EXPECT_EQ(framed.bytes, (framed.body.size() + 24 + 7) / 8 * 8);
    EXPECT_EQ(next_vrpn_message(rest.first(framed.bytes - 1), header).state, Framing::kNeedMore);
    const auto name = decode_vrpn_name(framed.body);
    ASSERT_EQ(name.has_value(), length <= 128) << length;
    if (name) {
      EXPECT_EQ(*name, std::string(static_cast<std::size_t>(length), 'n'));
    }
    rest = rest.subspan(framed.bytes);
  }
  EXPECT_TRUE(rest.empty());
  EXPECT_EQ(decode_vrpn_name(from_hex("00000003 616263")), "abc") << "also without a NUL";
}

TEST(VrpnMessage, PlainMessageMatchesTheReferenceBytes) {
  std::vector<std::uint8_t> bytes{0xEE};
  append_vrpn_message(bytes, {1, 2, 3, -4}, from_hex("abcdef"));
  EXPECT_EQ(bytes, from_hex("EE 0000001b 00000001 00000002 00000003 fffffffc 00000000"
                            "abcdef 0000000000"));
}

TEST(VrpnCallback, RequiresAValidPort) {
  for (const int port : {1, 65'535}) {
    const auto callback = decode_vrpn_callback(from_text("host " + std::to_string(port)));
    ASSERT_TRUE(callback) << port;
    EXPECT_EQ(callback->port, port);
  }
  EXPECT_FALSE(decode_vrpn_callback(from_text("host -1")));
  const auto of_a_name_of = [](std::size_t letters) {
    std::string text(letters, 'h');
    text.append(" 40123");
    return decode_vrpn_callback(from_text(text));
  };
  EXPECT_TRUE(of_a_name_of(74)) << "80 bytes are checked";
  EXPECT_FALSE(of_a_name_of(80));
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

TEST(VrpnCallback, ContainsTheFullHostName) {
  const std::string host = "motion-capture-room-two.robotics.example.org";
  std::vector<std::uint8_t> bytes;
  append_vrpn_callback(bytes, {host, 40123});
  const auto callback = decode_vrpn_callback(bytes);
  ASSERT_TRUE(callback);
  EXPECT_EQ(callback->address, host);
  EXPECT_EQ(callback->port, 40123);
}

TEST(IdentifyStream, RecognisesPrintableText) {
  for (int c = 0; c < 256; ++c) {
    const std::string text(8, static_cast<char>(c));
    const bool is_text = (c >= 0x20 && c <= 0x7e) || c == '\r' || c == '\n' || c == '\t';
    EXPECT_EQ(identify_stream(from_text(text)), is_text ? ServerType::kText : ServerType::kUnknown)
        << c;
  }
}

TEST(IdentifyStream, DistinguishesTheServers) {
  std::vector<std::uint8_t> datastream;
  PacketWriter packet(datastream);
  append(packet, ObjectEnums{{5, 9}});
  packet.finish();
  EXPECT_EQ(identify_stream(datastream), ServerType::kDataStream);
  EXPECT_EQ(identify_stream(Bytes(datastream).first(3)), ServerType::kTooFewBytes);
  std::vector<std::uint8_t> cookie;
  append_vrpn_cookie(cookie);
  EXPECT_EQ(identify_stream(cookie), ServerType::kVrpn);
  EXPECT_EQ(identify_stream(Bytes(cookie).first(5)), ServerType::kTooFewBytes);
  EXPECT_EQ(identify_stream(from_text("SSH-2.0-OpenSSH")), ServerType::kText);
  std::vector<std::uint8_t> qualisys = from_hex("0000002b 00000001");
  for (const char c : std::string("QTM RT Interface connected")) {
    qualisys.push_back(static_cast<std::uint8_t>(c));
  }
  EXPECT_EQ(identify_stream(qualisys), ServerType::kQualisys);
  EXPECT_EQ(identify_stream(from_hex("ff00ff00ff00ff00")), ServerType::kUnknown);
  EXPECT_EQ(identify_stream({}), ServerType::kTooFewBytes);
}

TEST(IdentifyStream, WaitsForEnoughBytes) {
  const auto magic = from_hex("0100 2B1A");
  EXPECT_EQ(identify_stream(magic), ServerType::kDataStream);
  const std::string cookie = "vrpn: ver. ";
  for (std::size_t bytes = 1; bytes <= cookie.size(); ++bytes) {
    EXPECT_EQ(identify_stream(from_text(cookie.substr(0, bytes))),
              bytes < cookie.size() ? ServerType::kTooFewBytes : ServerType::kVrpn)
        << bytes;
  }
  for (std::size_t bytes = 1; bytes < 12; ++bytes) {
    EXPECT_EQ(identify_stream(std::vector<std::uint8_t>(bytes, 0xff)),
              bytes < 8 ? ServerType::kTooFewBytes : ServerType::kUnknown)
        << bytes;
    std::string text(12, 't');
    text[bytes] = '\x7f';  // only the beginning must be text
    EXPECT_EQ(identify_stream(from_text(text)),
              bytes < 8 ? ServerType::kUnknown : ServerType::kText)
        << bytes;
  }
  std::vector<std::uint8_t> qualisys = from_hex("0000002b 00000001");
  EXPECT_EQ(identify_stream(qualisys), ServerType::kUnknown) << "a header of an unknown type";
  qualisys.push_back('Q');
  EXPECT_EQ(identify_stream(qualisys), ServerType::kQualisys);
  qualisys.push_back('R');
  EXPECT_EQ(identify_stream(qualisys), ServerType::kUnknown);
}

TEST(IdentifyDatagram, RefusesOtherDatagrams) {
  ObjectBlock block;
  block.objects.resize(3);
  for (TrackerObject& object : block.objects) {
    object.set_name("object");
  }
  const auto identified = [](const ObjectBlock& changed) {
    std::vector<std::uint8_t> datagram;
    encode_object_block(changed, 0, datagram);
    return identify_datagram(datagram);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        ObjectBlock changed = block;
        changed.objects[k].translation_mm(axis) = sign * 0.9e7;
        EXPECT_EQ(identified(changed), ServerType::kObjectStream);
        changed.objects[k].translation_mm(axis) = sign * 1.1e7;
        EXPECT_EQ(identified(changed), ServerType::kUnknown);
      }
      ObjectBlock changed = block;
      changed.objects[k].translation_mm(axis) = std::nan("");
      EXPECT_EQ(identified(changed), ServerType::kUnknown);
      changed = block;
      changed.objects[k].euler_xyz_rad(axis) = std::nan("");
      EXPECT_EQ(identified(changed), ServerType::kUnknown);
    }
    ObjectBlock changed = block;
    changed.objects[k].set_name("");
    EXPECT_EQ(identified(changed), ServerType::kUnknown) << "without a name";
  }
  std::vector<std::uint8_t> datagram;
  encode_object_block(block, 0, datagram);
  EXPECT_EQ(identify_datagram(Bytes(datagram).first(datagram.size() - 1)), ServerType::kUnknown);
  EXPECT_EQ(identify_datagram(from_hex("01000000 00")), ServerType::kUnknown)
      << "without an object";
  EXPECT_EQ(identify_datagram(from_hex("0100 2B1A")), ServerType::kDataStream);
  EXPECT_EQ(identify_datagram(from_hex("0100 2B")), ServerType::kUnknown);
}

TEST(IdentifyDatagram, DistinguishesTheStreams) {
  ObjectBlock block;
  block.objects.resize(2);
  block.objects[0].set_name("a");
  block.objects[1].set_name("b");
  std::vector<std::uint8_t> datagram;
  encode_object_block(block, 256, datagram);
  EXPECT_EQ(identify_datagram(datagram), ServerType::kObjectStream);
  for (const double far_mm : {1.1e7, -1.1e7}) {  // implausible: larger than any room
    ObjectBlock far = block;
    far.objects[1].translation_mm.y() = far_mm;
    datagram.clear();
    encode_object_block(far, 256, datagram);
    EXPECT_EQ(identify_datagram(datagram), ServerType::kUnknown) << far_mm;
  }
  EXPECT_EQ(identify_datagram(from_text("10.0.0.7 4000")), ServerType::kVrpn);
  EXPECT_EQ(identify_datagram(from_hex("0100 2B1A 00000000")), ServerType::kDataStream);
  EXPECT_EQ(identify_datagram(from_hex("00 01 02 03 04 05 06 07")), ServerType::kUnknown);
}

// The name of each server type contains a distinct word.
TEST(ServerTypes, HaveDistinctNames) {
  const std::vector<std::pair<ServerType, std::string>> words{
      {ServerType::kUnknown, "unknown"},
      {ServerType::kTooFewBytes, "sends too few bytes"},
      {ServerType::kDataStream, "DataStream"},
      {ServerType::kVrpn, "VRPN"},
      {ServerType::kObjectStream, "object stream"},
      {ServerType::kQualisys, "Qualisys"},
      {ServerType::kText, "text"}};
  for (const auto& [server_type, own] : words) {
    const std::string name = name_of(server_type);
    for (const auto& [other, word] : words) {
      EXPECT_EQ(name.find(word) != std::string::npos, server_type == other) << name << ": " << word;
    }
  }
}

}  // namespace
}  // namespace vantage::wire::vicon
