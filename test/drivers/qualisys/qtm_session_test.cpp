#include "drivers/qualisys/qtm_session.hpp"

#include <gtest/gtest.h>

#include "test/drivers/vicon/vicon_bench.hpp"

// Tests the driver with the emulated QTM server in virtual time.

namespace vantage::drivers::qualisys {
namespace {

using scenario::MocapProtocol;
using sim::vicon::EmulatedFrame;
using wire::qualisys::PacketType;

struct QtmBench : test::CirclingBench {
  explicit QtmBench(std::size_t chunk_bytes = 0)
      : CirclingBench(test::spec_of(MocapProtocol::kQtm),
                      settings_for(test::spec_of(MocapProtocol::kQtm)), chunk_bytes) {
    pass(std::chrono::milliseconds(20));
  }
};

// A TCP stream has no packet boundaries, so a packet may arrive in pieces of any size.
TEST(QtmSession, ReadsPosesFromPiecesOfAnySize) {
  for (const std::size_t chunk_bytes : {0u, 1u, 7u, 333u}) {
    QtmBench bench(chunk_bytes);
    bench.run(50, 4);
    const EmulatedFrame frame = bench.next(4);
    bench.publish(frame);
    ASSERT_FALSE(bench.frames.empty()) << bench.driver.status();
    EXPECT_EQ(bench.frames.back().frame_number, frame.number);
    test::expect_poses(bench.frames.back(), frame);
    EXPECT_EQ(bench.driver.wire_counts().broken_blocks, 0);
    EXPECT_EQ(bench.driver.frame_counts().frames_lost, 0);
  }
}

TEST(QtmSession, MarksBodiesWithoutCoordinatesAsOccluded) {
  QtmBench bench;
  bench.run(50, 3);
  EmulatedFrame frame = bench.next(3);
  frame.bodies[1].is_occluded = true;
  bench.publish(frame);
  EXPECT_FALSE(bench.frames.back().find("BODY0")->occluded);
  EXPECT_TRUE(bench.frames.back().find("BODY1")->occluded);
  EXPECT_FALSE(bench.frames.back().find("BODY2")->occluded);
  EXPECT_EQ(bench.driver.frame_counts().poses_refused, 0);
}

// Frames identify bodies by their order only. After a change of the order, no pose may appear under
// another body's name.
TEST(QtmSession, UsesNewNamesFromTheFirstFrameAfterAnEvent) {
  QtmBench bench;
  bench.run(50, 3);
  test::expect_own_names_after_removal(bench, 4, true);
  EXPECT_EQ(bench.driver.frame_counts().poses_outlying, 0);
}

// The stamps of QTM begin at zero. A frame that waited in a queue is older by the waiting time.
TEST(QtmSession, AddsTheTimeInAQueueToTheAge) {
  QtmBench bench;
  bench.run(300, 2);
  const EmulatedFrame frame = bench.next(2);
  bench.elapsed += Duration{60'000};  // the frame arrives late
  bench.publish(frame);
  const models::MocapFrame& seen = bench.frames.back();
  EXPECT_NEAR(to_seconds(seen.arrival - seen.stamp.time), 0.005 + 0.06, 0.002);
}

TEST(QtmSession, RefusesAServerThatIsNotQtm) {
  QtmSession session(false, [](const vicon::SeenFrame&) {});
  session.open({});
  std::vector<std::uint8_t> bytes;
  append_text(bytes, PacketType::kCommand, "hello");
  EXPECT_FALSE(session.receive({}, bytes));
  EXPECT_EQ(session.counts.broken_streams, 1);
}

/// Returns the command that the session has sent since the last call.
std::string sent(QtmSession& session) {
  const wire::qualisys::Packet packet = wire::qualisys::next_packet(session.outgoing);
  const std::string text(wire::qualisys::text_of(packet.body));
  session.outgoing.clear();
  return text;
}

TEST(QtmSession, NegotiatesTheNewestVersionOfBothSides) {
  for (const bool has_old_server : {true, false}) {
    QtmSession session(false, [](const vicon::SeenFrame&) {});
    session.open({});
    const auto answer = [&](PacketType type, const std::string& text) {
      std::vector<std::uint8_t> bytes;
      append_text(bytes, type, text);
      return session.receive({}, bytes);
    };
    EXPECT_TRUE(answer(PacketType::kCommand, "QTM RT Interface connected"));
    EXPECT_EQ(sent(session), "Version 1.25");
    for (const char* older : {"1.21", "1.16", "1.12", "1.8"}) {
      EXPECT_TRUE(answer(PacketType::kError, "Version NOT supported"));
      EXPECT_EQ(sent(session), std::string("Version ") + older);
    }
    if (has_old_server) {
      EXPECT_TRUE(answer(PacketType::kCommand, "Version set to 1.8"));
      EXPECT_EQ(sent(session), "GetParameters 6D");
      EXPECT_TRUE(answer(PacketType::kXml, "<P><The_6D/></P>"));
      EXPECT_EQ(sent(session), "StreamFrames AllFrames 6DRes");
    } else {
      EXPECT_FALSE(answer(PacketType::kError, "Version NOT supported"));
      EXPECT_NE(session.refusal.find("version 1.8 or later is required"), std::string::npos);
    }
  }
}

TEST(QtmSession, CountsEveryDroppedPacket) {
  QtmBench bench;
  bench.run(20, 1);
  const auto dropped = [&](const std::vector<std::uint8_t>& bytes) {
    const auto& counts = bench.driver.wire_counts();
    const std::int64_t before = counts.broken_blocks + counts.broken_streams;
    bench.driver.receive(bench.now(), bytes);
    return counts.broken_blocks + counts.broken_streams - before;
  };
  EXPECT_EQ(dropped({8, 0, 0, 0, 3, 0, 0, 0}), 1) << "an empty frame";
  EXPECT_EQ(dropped({8, 0, 0, 0, 2, 0, 0, 0}), 1) << "empty parameters";
  EXPECT_EQ(dropped({8, 0, 0, 0, 77, 0, 0, 0}), 1) << "an unknown packet";
  EXPECT_EQ(dropped({10, 0, 0, 0, 0, 0, 0, 0, 'E', 0}), 1) << "an error";
  EXPECT_EQ(dropped({1, 0, 0, 0, 0, 0, 0, 0}), 1) << "an impossible size";
  EXPECT_TRUE(bench.driver.wants_close());
}

TEST(QtmSession, ReconnectsAfterALostConnection) {
  QtmBench bench;
  bench.run(20, 2);
  bench.cut();
  bench.pass(std::chrono::seconds(1));
  bench.frames.clear();
  bench.number = 0;
  bench.run(20, 2);
  EXPECT_GE(bench.frames.size(), 19u);
  EXPECT_EQ(bench.driver.link_counts().connections_lost, 1);
}

}  // namespace
}  // namespace vantage::drivers::qualisys
