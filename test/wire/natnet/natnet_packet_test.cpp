#include <gtest/gtest.h>

#include "test/wire/vicon/vicon_bytes.hpp"
#include "wire/natnet/packet.hpp"

// Bytes from the public description of the protocol: header u16 id, u16 payload size,
// little-endian.

namespace vantage::wire::natnet {
namespace {

using test::from_hex;
using Buffer = std::vector<std::uint8_t>;

/// Returns `text` as a name field of 256 bytes, in hexadecimal.
std::string name_hex(const std::string& text_hex) {
  return text_hex + std::string(2 * kNameBytes - text_hex.size(), '0');
}

const std::string kLibrary = name_hex("4e61744e65744c6962");  // NatNetLib

TEST(NatNetPacket, ReadsNoMoreThanItsHeaderStates) {
  const Buffer echo = from_hex("0c00 0800 0102030405060708");
  const auto packet = decode_packet(echo);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->id, PacketId::kEchoRequest);
  EXPECT_EQ(decode_echo_request(packet->payload), 0x0807060504030201u);
  for (std::size_t bytes = 0; bytes < echo.size(); ++bytes) {
    EXPECT_FALSE(decode_packet(Bytes(echo).first(bytes))) << bytes;
  }
  Buffer longer = echo;
  longer.push_back(9);
  EXPECT_EQ(decode_packet(longer)->payload.size(), 8u);
}

TEST(NatNetPacket, HasThePublishedBytes) {
  struct Row {
    std::string hex;
    Buffer written;
  };
  Connect old_client;
  old_client.natnet = {{3, 0, 0, 0}};
  Connect client;
  client.natnet = {{4, 1, 0, 0}};
  ServerInfo info;
  info.name = "M";
  info.application = {{2, 1, 0, 0}};
  info.natnet = {{3, 0, 0, 0}};
  info.ticks_per_s = 3'312'787;
  info.is_multicast = true;
  std::vector<Row> rows{
      {"0000 0801" + kLibrary + "00000000 03000000", {}},
      {"0000 0d01" + kLibrary + "00000000 04010000 00 00000000", {}},
      {"0e00 0801" + kLibrary + "00000000 03000000", {}},
      {"0100 1701" + name_hex("4d") + "02010000 03000000 938c320000000000 e705 01 efff2a63", {}},
      {"0200 0a00 4672616d655261746500", {}},
      {"0300 0400 0000f042", {}},
      {"0400 0000", {}},
      {"0a00 0000", {}},
      {"0c00 0800 0500000000000000", {}},
      {"0d00 1000 0500000000000000 0700000000000000", {}},
  };
  append_connect(rows[0].written, PacketId::kConnect, old_client);
  append_connect(rows[1].written, PacketId::kConnect, client);
  append_connect(rows[2].written, PacketId::kDiscovery, old_client);
  append_server_info(rows[3].written, info);
  append_request(rows[4].written, "FrameRate");
  append_response(rows[5].written, 120.0F);
  append_empty(rows[6].written, PacketId::kDefinitionsRequest);
  append_empty(rows[7].written, PacketId::kKeepAlive);
  append_echo_request(rows[8].written, 5);
  append_echo_response(rows[9].written, {5, 7});
  for (const Row& row : rows) {
    EXPECT_EQ(row.written, from_hex(row.hex)) << row.hex.substr(0, 10);
  }
}

TEST(NatNetPacket, ReadsWhatItWrites) {
  Connect client;
  client.name = std::string(300, 'x');
  client.application = {{1, 2, 3, 4}};
  client.natnet = {{4, 0, 0, 0}};
  client.bitstream = {{4, 1, 0, 0}};
  client.is_subscriber = true;
  Buffer bytes;
  append_connect(bytes, PacketId::kConnect, client);
  const auto connect = decode_connect(decode_packet(bytes)->payload);
  ASSERT_TRUE(connect);
  EXPECT_EQ(connect->name, std::string(255, 'x')) << "cut to leave room for the NUL";
  EXPECT_EQ(connect->application, client.application);
  EXPECT_EQ(connect->natnet, client.natnet);
  EXPECT_EQ(connect->bitstream, client.bitstream);
  EXPECT_TRUE(connect->is_subscriber);

  ServerInfo info;
  info.name = "Motive";
  info.natnet = {{4, 1, 0, 0}};
  info.ticks_per_s = 10'000'000;
  info.data_port = 4'567;
  info.is_multicast = true;
  info.group = {239, 1, 2, 3};
  bytes.clear();
  append_server_info(bytes, info);
  bytes[20] = 0xEE;  // after the name's NUL: servers do not clear these bytes
  const Bytes payload = decode_packet(bytes)->payload;
  const auto read = decode_server_info(payload);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->name, "Motive");
  EXPECT_EQ(read->natnet, info.natnet);
  EXPECT_EQ(read->ticks_per_s, info.ticks_per_s);
  EXPECT_EQ(read->data_port, info.data_port);
  EXPECT_TRUE(read->is_multicast);
  EXPECT_EQ(read->group, info.group);
  for (std::size_t size = 0; size < payload.size(); ++size) {
    EXPECT_FALSE(decode_server_info(payload.first(size)));
  }
  EXPECT_EQ(decode_request(test::from_text("Bitstream,4.0")), std::nullopt) << "without NUL";
  EXPECT_EQ(decode_response(from_hex("000040")), std::nullopt);
  EXPECT_EQ(decode_echo_response(from_hex("00")), std::nullopt);
}

TEST(NatNetVersion, IsOrderedByItsNumbers) {
  EXPECT_LT((Version{{3, 1, 0, 0}}), kSizedSince);
  EXPECT_LT((Version{{4, 0, 9, 0}}), kSizedSince);
  EXPECT_GE((Version{{4, 1, 0, 0}}), kSizedSince);
  EXPECT_LT((Version{{2, 10, 0, 0}}), kVersionMin);
  EXPECT_EQ(to_text({{2, 10, 0, 0}}), "2.10");
}

}  // namespace
}  // namespace vantage::wire::natnet
