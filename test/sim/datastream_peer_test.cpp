#include "sim/vicon/datastream_peer.hpp"

#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "wire/vicon/datastream_blocks.hpp"

namespace vantage::sim::vicon {
namespace {

namespace wire = vantage::wire::vicon;

/// Returns the types of the blocks in a frame for a client that has requested the types
/// `requested`.
std::set<std::uint32_t> received_types(const std::vector<std::uint32_t>& requested) {
  DataStreamPeer peer{ServerSettings{}};
  peer.outgoing.clear();  // drops the server's greeting
  std::vector<std::uint8_t> bytes;
  wire::PacketWriter packet(bytes);
  append(packet, wire::ObjectEnums{requested});
  append(packet, wire::RequestFrame{true});
  packet.finish();
  EXPECT_TRUE(peer.receive(bytes));
  EmulatedFrame frame;
  frame.bodies.push_back({"Q1", {}, false});
  peer.on_frame(frame);
  std::set<std::uint32_t> out;
  wire::Bytes left(peer.outgoing);
  while (!left.empty()) {
    const wire::Framed framed = wire::next_packet(left);
    EXPECT_EQ(framed.state, wire::Framing::kWhole);
    wire::BlockCursor cursor(framed.body);
    while (const auto block = cursor.next()) {
      out.insert(block->type);
    }
    left = left.subspan(framed.bytes);
  }
  return out;
}

// The frame number is always included, because it makes a packet a frame.
TEST(DataStreamPeer, SendsOnlyRequestedBlocks) {
  using Types = std::set<std::uint32_t>;
  const std::uint32_t number = wire::kFrameInfo;
  for (const std::uint32_t type :
       {std::uint32_t{wire::kStreamInfo}, std::uint32_t{wire::kSubjectInfo},
        std::uint32_t{wire::kApplicationInfo}, std::uint32_t{wire::kGlobalSegments},
        std::uint32_t{wire::kLatencyInfo}, std::uint32_t{wire::kLightweightSegments},
        std::uint32_t{wire::kContents}}) {
    EXPECT_EQ(received_types({type}), (Types{number, type})) << type;
  }
  EXPECT_EQ(received_types({}), Types{number});
}

}  // namespace
}  // namespace vantage::sim::vicon
