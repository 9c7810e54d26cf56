#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/vicon/datastream_session.hpp"
#include "test/drivers/vicon/vicon_bench.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/wire/vicon/vicon_bytes.hpp"
#include "wire/vicon/datastream_blocks.hpp"

namespace vantage::drivers::vicon {
namespace {

using scenario::MocapProtocol;
using scenario::MocapSpec;
using test::circling;
using test::from_hex;
using test::from_text;
using test::kPeriod;
using test::spec_of;
using test::ViconBench;

class ViconLink : public ::testing::TestWithParam<MocapProtocol> {
 protected:
  ViconLink() : spec(spec_of(GetParam())), bench(spec, ViconBench::settings_for(spec)) {
    bench.pass(Duration{2'000});
  }
  /// Publishes `count` frames of two bodies at 100 Hz; returns the number that the driver
  /// published.
  std::size_t fly(int count) {
    const std::size_t before = bench.frames.size();
    for (int k = 0; k < count; ++k) {
      sim::vicon::EmulatedFrame frame = circling(2, 0.01 * static_cast<double>(number));
      frame.captured = bench.now().utime;
      frame.number = number++;
      bench.publish(frame);
      bench.pass(kPeriod);
    }
    return bench.frames.size() - before;
  }
  MocapSpec spec;
  ViconBench bench;
  std::uint32_t number = 100;
};

TEST_P(ViconLink, ReconnectsAfterEveryCut) {
  for (int cut = 0; cut < 30; ++cut) {
    ASSERT_EQ(fly(20), 20u) << "after cut " << cut << ": " << bench.driver.status();
    bench.cut();
    bench.pass(Duration{150'000});  // the first retry is after 0.1 s
  }
  EXPECT_EQ(bench.driver.link_counts().connections, 31);
  EXPECT_EQ(bench.driver.link_counts().connections_lost, 30);
  EXPECT_EQ(bench.driver.frame_counts().frames_lost, 0);
}

TEST_P(ViconLink, BacksOffAndReconnects) {
  ASSERT_EQ(fly(10), 10u);
  bench.is_server_up = false;
  bench.cut();
  bench.pass(std::chrono::seconds(100));
  EXPECT_GE(bench.driver.link_counts().connections_failed, 48) << "the pause is at most 2 s";
  EXPECT_LE(bench.driver.link_counts().connections_failed, 56)
      << "the pause grows with each attempt";
  EXPECT_NE(bench.driver.status().find("connection refused"), std::string::npos);
  bench.is_server_up = true;
  bench.pass(std::chrono::seconds(2) + Duration{10'000});
  number = 0;  // the server restarted
  // The bodies moved two metres in two minutes, so their poses must be confirmed; no frame may be
  // lost.
  EXPECT_EQ(fly(10), 10u);
  EXPECT_FALSE(bench.frames.back().bodies[0].occluded);
  EXPECT_TRUE(bench.driver.has_frames());
}

TEST_P(ViconLink, ReportsAServerOfAnotherProduct) {
  bench.cut();
  bench.driver.on_opening(bench.now());
  bench.driver.on_opened(bench.now());
  const bool is_vrpn = GetParam() == MocapProtocol::kVrpn;
  const bool is_datagram = GetParam() == MocapProtocol::kObjectStream;
  const std::vector<std::uint8_t> foreign =
      is_vrpn || is_datagram
          ? from_hex(
                "01 00 2B 1A 14 00 00 00 A1 86 01 00 0C 00 00 00 02 00 00 00 05 00 00 00 09 "
                "00 00 00")
          : from_text("vrpn: ver. 07.35  0");
  bench.driver.receive(bench.now(), foreign);
  EXPECT_EQ(bench.driver.wants_close(), !is_datagram);
  const std::string expected =
      is_vrpn || is_datagram ? "is a Vicon DataStream server, not" : "is a VRPN server, not";
  EXPECT_NE(bench.driver.status().find(expected), std::string::npos) << bench.driver.status();
  EXPECT_NE(bench.driver.status().find("set mocap.protocol"), std::string::npos);
  EXPECT_EQ(bench.driver.wire_counts().broken_streams, 1);
}

TEST_P(ViconLink, ClosesASilentConnection) {
  ASSERT_EQ(fly(10), 10u);
  const auto connections = bench.driver.link_counts().connections;
  if (bench.peer) {
    // Neither frames nor ping replies arrive, as with an unplugged cable.
    for (int ms = 0; ms < 5000; ++ms) {
      bench.driver.on_time({bench.now().utime, bench.now().steady + Duration{1'000} * ms});
    }
    EXPECT_TRUE(bench.driver.wants_close());
    EXPECT_EQ(bench.driver.link_counts().silences, 1);
    EXPECT_NE(bench.driver.status().find("stopped sending"), std::string::npos);
  } else {
    bench.pass(std::chrono::seconds(4));
    EXPECT_NE(bench.driver.status().find("no data received"), std::string::npos);
    EXPECT_EQ(bench.driver.link_counts().connections, connections)
        << "UDP has no connection to reopen";
  }
}

TEST_P(ViconLink, StaysConnectedToALiveServerThatHasNoFrames) {
  ASSERT_EQ(fly(10), 10u);
  if (GetParam() != MocapProtocol::kObjectStream) {
    bench.pass(std::chrono::seconds(30));
    EXPECT_EQ(bench.driver.link_counts().connections, 1) << "pings are answered";
    EXPECT_EQ(fly(10), 10u);
  }
}

TEST_P(ViconLink, AllocatesNothingForKnownBodies) {
  const MocapSpec here = spec;
  std::size_t published = 0;
  ViconDriver driver(here,
                     [&](const models::MocapFrame& frame) { published += frame.bodies.size(); });
  // The bytes of all frames, prepared in advance.
  std::vector<std::vector<std::uint8_t>> bytes;
  const auto settings = ViconBench::settings_for(here);
  sim::vicon::ObjectStreamServer object_stream(settings);
  std::unique_ptr<sim::vicon::Peer> peer;
  if (GetParam() == MocapProtocol::kDataStream) {
    peer = std::make_unique<sim::vicon::DataStreamPeer>(settings);
  } else if (GetParam() == MocapProtocol::kVrpn) {
    peer = std::make_unique<sim::vicon::VrpnPeer>(settings);
  }
  driver.on_opening(bench.now());
  driver.on_opened(bench.now());
  for (std::uint32_t k = 0; k < 300; ++k) {
    sim::vicon::EmulatedFrame frame = circling(3, 0.01 * k);
    frame.number = k;
    if (peer) {
      peer->on_frame(frame);
      bytes.push_back(std::exchange(peer->outgoing, {}));
      if (k < 10) {
        driver.receive(bench.now(), bytes.back());
        static_cast<void>(peer->receive(std::exchange(driver.outgoing(), {})));
      }
    } else {
      bytes.push_back(object_stream.encode(frame).front());
      if (k < 10) {
        driver.receive(bench.now(), bytes.back());
      }
    }
  }
  const std::size_t before = published;
  Moment now = bench.now();
  const test::AllocationCounter allocations;
  for (std::size_t k = 10; k < bytes.size(); ++k) {
    now = {now.utime + kPeriod, now.steady + kPeriod};
    driver.receive(now, bytes[k]);
  }
  EXPECT_EQ(allocations.count(), 0u);
  EXPECT_EQ(published - before, 3u * 290u);
}

INSTANTIATE_TEST_SUITE_P(Protocols, ViconLink,
                         testing::Values(MocapProtocol::kDataStream, MocapProtocol::kObjectStream,
                                         MocapProtocol::kVrpn),
                         [](const auto& protocol) { return std::string(protocol.param.name()); });

/// A DataStream server that sends the packets of the test one by one.
struct HandServer {
  explicit HandServer(scenario::UpAxis up_axis = scenario::UpAxis::kAsTold)
      : session(scenario::StreamMode::kPush, up_axis, [this](const SeenFrame& frame) {
          numbers.push_back(*frame.number);
          bodies.assign(frame.bodies().begin(), frame.bodies().end());
        }) {
    session.open({});
    send([](wire::vicon::PacketWriter& packet) {
      append(packet, wire::vicon::ObjectEnums{{1, 2, 5, 9, 26, 37, 100004}});
    });
  }
  template <class Fill>
  void send(const Fill& fill) {
    std::vector<std::uint8_t> bytes;
    wire::vicon::PacketWriter packet(bytes);
    fill(packet);
    packet.finish();
    EXPECT_TRUE(session.receive({}, bytes));
  }
  static wire::vicon::SubjectInfo subject(std::uint32_t id, const std::string& name) {
    return {id, name, {{0, 1, {}, name}}, {}, {}};
  }
  static wire::vicon::Segments pose(std::uint32_t id, double x_mm, std::uint32_t segment = 1) {
    return {id, {{segment, {x_mm, 0.0, 1000.0}, Eigen::Matrix3d::Identity()}}};
  }
  std::vector<std::uint32_t> numbers;
  std::vector<SeenBody> bodies;
  DataStreamSession session;
};

TEST(DataStreamSession, RequestsTheContentThatPosesNeed) {
  const HandServer server;
  const wire::vicon::Framed first = wire::vicon::next_packet(server.session.outgoing);
  ASSERT_EQ(first.state, wire::vicon::Framing::kWhole);
  wire::vicon::BlockCursor cursor(first.body);
  wire::vicon::ObjectEnums request;
  ASSERT_TRUE(decode(cursor.next()->body, request));
  EXPECT_EQ(request.types, (std::vector<std::uint32_t>{1, 2, 5, 9, 26, 37, 100004}));
  const wire::vicon::Bytes second =
      wire::vicon::Bytes(server.session.outgoing).subspan(first.bytes);
  const std::vector<std::uint8_t> expected =
      from_hex("01 00 2B 1A | 09 00 00 00 | A2 86 01 00 | 01 00 00 00 | 01");
  EXPECT_TRUE(std::equal(second.begin(), second.end(), expected.begin(), expected.end()));
}

TEST(DataStreamSession, KeepsStaticContentUntilItIsReplaced) {
  HandServer server;
  server.send([](wire::vicon::PacketWriter& packet) {
    append(packet, HandServer::subject(7, "A"));
    append(packet, wire::vicon::FrameInfo{1});
    append(packet, HandServer::pose(7, 1000.0));
  });
  ASSERT_EQ(server.bodies.size(), 1u);
  EXPECT_EQ(server.bodies[0].world_from_body.translation_m, Eigen::Vector3d(1.0, 0.0, 1.0));
  server.send([](wire::vicon::PacketWriter& packet) {  // static content is not sent again
    append(packet, wire::vicon::FrameInfo{2});
    append(packet, HandServer::pose(7, 1001.0));
  });
  ASSERT_EQ(server.bodies.size(), 1u);
  server.send([](wire::vicon::PacketWriter& packet) {  // partly new; the rest declared unchanged
    append(packet, wire::vicon::Contents{{}, {wire::vicon::kSubjectInfo}});
    append(packet, wire::vicon::StreamInfo{1'350'000});
    append(packet, wire::vicon::FrameInfo{3});
    append(packet, HandServer::pose(7, 1002.0));
  });
  ASSERT_EQ(server.bodies.size(), 1u);
  EXPECT_EQ(server.session.rate_hz(), 100.0);
  server.send([](wire::vicon::PacketWriter& packet) {  // partly new; the rest is not included
    append(packet, wire::vicon::StreamInfo{1'350'000});
    append(packet, wire::vicon::FrameInfo{4});
    append(packet, HandServer::pose(7, 1003.0));
  });
  EXPECT_TRUE(server.bodies.empty());
  EXPECT_EQ(server.session.counts.unnamed_bodies, 1);
  EXPECT_EQ(server.numbers, (std::vector<std::uint32_t>{1, 2, 3, 4}));
}

TEST(DataStreamSession, ReusesOnlyUnchangedPoses) {
  HandServer server;
  server.send([](wire::vicon::PacketWriter& packet) {
    append(packet, HandServer::subject(7, "A"));
    append(packet, wire::vicon::FrameInfo{1});
    append(packet, HandServer::pose(7, 1000.0));
  });
  server.send([](wire::vicon::PacketWriter& packet) {
    append(packet, wire::vicon::Contents{{}, {wire::vicon::kGlobalSegments}});
    append(packet, wire::vicon::FrameInfo{2});
  });
  EXPECT_EQ(server.bodies[0].pose_state, PoseState::kSeen);
  server.send([](wire::vicon::PacketWriter& packet) { append(packet, wire::vicon::FrameInfo{3}); });
  EXPECT_EQ(server.bodies[0].pose_state, PoseState::kAbsent);
}

TEST(DataStreamSession, DropsFramesWithoutTheRequestedContent) {
  HandServer server;
  server.send([](wire::vicon::PacketWriter& packet) {
    append(packet, HandServer::subject(7, "A"));
    append(packet, wire::vicon::FrameInfo{1});
  });
  EXPECT_TRUE(server.numbers.empty());
  EXPECT_EQ(server.session.counts.frames_before_set, 1);
  server.send([](wire::vicon::PacketWriter& packet) {  // the poses are present but all occluded
    append(packet, wire::vicon::Contents{{{wire::vicon::kGlobalSegments, 0}}, {}});
    append(packet, wire::vicon::FrameInfo{2});
  });
  EXPECT_EQ(server.numbers, (std::vector<std::uint32_t>{2}));
  EXPECT_EQ(server.bodies[0].pose_state, PoseState::kAbsent);
}

TEST(DataStreamSession, UsesTheRootSegmentOrTheSegmentNamedAsTheSubject) {
  HandServer server;
  server.send([](wire::vicon::PacketWriter& packet) {
    wire::vicon::SubjectInfo skeleton = HandServer::subject(1, "Man");
    skeleton.segments = {{3, 2, {}, "Hand"}, {0, 3, {}, "Pelvis"}};
    append(packet, skeleton);
    wire::vicon::SubjectInfo object = HandServer::subject(2, "Quad");
    object.segments = {{0, 4, {}, "Frame"}, {4, 5, {}, "Quad"}};
    append(packet, object);
    append(packet, wire::vicon::FrameInfo{1});
    append(packet, wire::vicon::Segments{1,
                                         {{2, {1.0, 0.0, 0.0}, Eigen::Matrix3d::Identity()},
                                          {3, {3000.0, 0.0, 0.0}, Eigen::Matrix3d::Identity()}}});
    append(packet, HandServer::pose(2, 4000.0, 4));
    append(packet, HandServer::pose(2, 5000.0, 5));
  });
  ASSERT_EQ(server.bodies.size(), 2u);
  EXPECT_EQ(server.bodies[0].world_from_body.translation_m.x(), 3.0);
  EXPECT_EQ(server.bodies[1].world_from_body.translation_m.x(), 5.0);
}

TEST(DataStreamSession, ConvertsYUpByDefault) {
  for (const auto up_axis : {scenario::UpAxis::kAsTold, scenario::UpAxis::kZ}) {
    HandServer server(up_axis);
    server.send([](wire::vicon::PacketWriter& packet) {
      append(packet, HandServer::subject(7, "A"));
      append(packet, wire::vicon::ApplicationInfo{true});
      append(packet, wire::vicon::FrameInfo{1});
      append(packet,
             wire::vicon::Segments{7, {{1, {989.0, 145.0, 1020.0}, Eigen::Matrix3d::Identity()}}});
    });
    ASSERT_EQ(server.bodies.size(), 1u);
    const Eigen::Vector3d expected = up_axis == scenario::UpAxis::kAsTold
                                         ? Eigen::Vector3d(0.989, -1.020, 0.145)
                                         : Eigen::Vector3d(0.989, 0.145, 1.020);
    EXPECT_LT((server.bodies[0].world_from_body.translation_m - expected).norm(), 1e-12);
  }
}

TEST(DataStreamSession, SkipsBrokenBlocks) {
  HandServer server;
  server.send([](wire::vicon::PacketWriter& packet) {
    append(packet, HandServer::subject(7, "A"));
    packet.begin_block(wire::vicon::kLatencyInfo);
    packet.body().u32(0xFFFFFFFF);
    packet.end_block();
    packet.begin_block(4711);  // block id of a later protocol version
    packet.body().u32(0);
    packet.end_block();
    append(packet, wire::vicon::FrameInfo{1});
    append(packet, HandServer::pose(7, 1000.0));
  });
  ASSERT_EQ(server.bodies.size(), 1u);
  EXPECT_EQ(server.bodies[0].pose_state, PoseState::kSeen);
  EXPECT_EQ(server.session.counts.broken_blocks, 1);
}

}  // namespace
}  // namespace vantage::drivers::vicon
