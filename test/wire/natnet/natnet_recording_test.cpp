#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "wire/natnet/definitions.hpp"
#include "wire/natnet/frame.hpp"

// Datagrams that the real Motive 2.1 sent (NatNet 3.0). VANTAGE_NATNET_RECORDING is the folder
// `test_data` of the public repository mje-nz/python_natnet; the tests are skipped without it.

namespace vantage::wire::natnet {
namespace {

constexpr Version k30{{3, 0, 0, 0}};

std::filesystem::path recording() {
  const char* const folder = std::getenv("VANTAGE_NATNET_RECORDING");
  return folder == nullptr ? "" : folder;
}

std::vector<std::uint8_t> file_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Returns the UDP payloads of a pcapng file of Ethernet packets; IPv4 fragments are dropped.
std::vector<std::vector<std::uint8_t>> datagrams_of(const std::vector<std::uint8_t>& file) {
  constexpr std::uint32_t kEnhancedPacket = 6;
  constexpr std::size_t kEthernetBytes = 14;
  std::vector<std::vector<std::uint8_t>> out;
  Bytes rest(file);
  while (rest.size() >= 12) {
    Reader block(rest);
    const std::uint32_t type = block.u32();
    const std::uint32_t size = block.u32();
    if (size < 12 || size > rest.size()) {
      break;
    }
    if (type == kEnhancedPacket) {
      block.take(12);  // skips interface and time
      const std::uint32_t captured = block.u32();
      block.u32();
      const Bytes packet = block.take(captured);
      const bool is_ip = packet.size() > kEthernetBytes + 28 && packet[12] == 8 && packet[13] == 0;
      const Bytes ip = is_ip ? packet.subspan(kEthernetBytes) : Bytes();
      const bool is_udp = is_ip && ip[9] == 17 && (ip[6] & 0x3F) == 0 && ip[7] == 0;
      const std::size_t header = is_udp ? 4 * std::size_t{static_cast<unsigned>(ip[0] & 0xF)} : 0;
      if (is_udp && ip.size() >= header + 8) {
        const Bytes udp = ip.subspan(header);
        const std::size_t length = 256 * std::size_t{udp[4]} + udp[5];
        if (length >= 8 && length <= udp.size()) {
          out.emplace_back(udp.begin() + 8, udp.begin() + static_cast<std::ptrdiff_t>(length));
        }
      }
    }
    rest = rest.subspan(size);
  }
  return out;
}

TEST(NatNetRecording, ContainsOnlyReadableFrames) {
  if (recording().empty()) {
    GTEST_SKIP() << "VANTAGE_NATNET_RECORDING is not set";
  }
  std::map<PacketId, int> read;
  int unread = 0;
  std::uint32_t last_number = 0;
  for (const auto& datagram : datagrams_of(file_bytes(recording() / "raw" / "traffic.pcapng"))) {
    const auto packet = decode_packet(datagram);
    if (!packet || datagram.size() != 4 + packet->payload.size()) {
      continue;  // another protocol
    }
    Frame frame;
    Definitions definitions;
    bool is_read = true;
    switch (packet->id) {
      case PacketId::kFrame:
        is_read = decode_frame(packet->payload, k30, frame) && frame.bodies.size() == 1 &&
                  frame.bodies[0].id == 2 && frame.exposed_ticks <= frame.received_ticks &&
                  frame.received_ticks <= frame.sent_ticks;
        EXPECT_GE(frame.number, last_number);
        last_number = frame.number;
        break;
      case PacketId::kDefinitions:
        decode_definitions(packet->payload, k30, definitions);
        is_read = definitions.is_complete && definitions.bodies.size() == 1 &&
                  definitions.bodies[0].name == "RaceQuad" && definitions.bodies[0].id == 2;
        break;
      case PacketId::kServerInfo: {
        const auto info = decode_server_info(packet->payload);
        is_read =
            info && info->name == "Motive" && info->natnet == k30 && info->ticks_per_s == 3'312'787;
        break;
      }
      case PacketId::kEchoResponse:
        is_read = decode_echo_response(packet->payload).has_value();
        break;
      case PacketId::kConnect:
      case PacketId::kDiscovery:
        is_read = decode_connect(packet->payload).has_value();
        break;
      default:
        break;
    }
    (is_read ? read[packet->id] : unread)++;
  }
  EXPECT_EQ(unread, 0);
  EXPECT_EQ(read[PacketId::kFrame], 518);
  for (const auto& [id, count] : read) {
    std::printf("packets with id %d: %d\n", static_cast<int>(id), count);
  }
}

TEST(NatNetRecording, FilesHaveTheValuesOfTheOfficialClient) {
  if (recording().empty()) {
    GTEST_SKIP() << "VANTAGE_NATNET_RECORDING is not set";
  }
  Frame frame;
  const auto visible = file_bytes(recording() / "mocapframe_packet_v3.bin");
  ASSERT_TRUE(decode_frame(decode_packet(visible)->payload, k30, frame));
  ASSERT_EQ(frame.bodies.size(), 1u);
  EXPECT_TRUE(frame.bodies[0].is_tracked);
  EXPECT_NEAR(frame.bodies[0].rotation_xyzw.norm(), 1.0, 1e-5);
  const auto occluded = file_bytes(recording() / "mocapframe_packet_occluded_v3.bin");
  ASSERT_TRUE(decode_frame(decode_packet(occluded)->payload, k30, frame));
  ASSERT_EQ(frame.bodies.size(), 1u);
  EXPECT_TRUE(frame.bodies[0].is_tracked) << "only markers are occluded";
  Definitions definitions;
  const auto models = file_bytes(recording() / "modeldef_packet_v3.bin");
  decode_definitions(decode_packet(models)->payload, k30, definitions);
  EXPECT_TRUE(definitions.is_complete);
  ASSERT_EQ(definitions.bodies.size(), 1u);
  EXPECT_EQ(definitions.bodies[0].name, "RaceQuad");
}

}  // namespace
}  // namespace vantage::wire::natnet
