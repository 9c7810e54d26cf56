#include "drivers/natnet/natnet_session.hpp"

#include <deque>
#include <utility>

#include <gtest/gtest.h>

#include "test/drivers/vicon/vicon_bench.hpp"

// Tests the driver with the emulated NatNet server in virtual time.

namespace vantage::drivers::natnet {
namespace {

using scenario::MocapProtocol;
using sim::vicon::EmulatedFrame;
using test::kPeriod;
using test::ViconBench;

struct NatNetBench : test::CirclingBench {
  explicit NatNetBench(const scenario::MocapSpec& spec = test::spec_of(MocapProtocol::kNatNet))
      : NatNetBench(spec, settings_for(spec)) {}
  NatNetBench(const scenario::MocapSpec& spec, const sim::vicon::ServerSettings& settings)
      : CirclingBench(spec, settings) {
    latency_s = 0.0055;
    pass(std::chrono::milliseconds(20));
  }

  [[nodiscard]] double age_s() const {
    return to_seconds(frames.back().arrival - frames.back().stamp.time);
  }
};

TEST(NatNetSession, ReadsPosesOfEachVersionAndAxis) {
  for (const std::array<std::uint8_t, 2> version :
       {std::array<std::uint8_t, 2>{3, 0}, {3, 1}, {4, 0}, {4, 1}, {4, 2}}) {
    for (const bool is_z_up : {false, true}) {
      scenario::MocapSpec spec = test::spec_of(MocapProtocol::kNatNet);
      spec.up_axis = is_z_up ? scenario::UpAxis::kZ : scenario::UpAxis::kAsTold;
      sim::vicon::ServerSettings settings = ViconBench::settings_for(spec);
      EXPECT_EQ(settings.is_y_up, !is_z_up);
      settings.natnet_version = version;
      NatNetBench bench(spec, settings);
      bench.run(100, 4);
      const EmulatedFrame frame = bench.next(4);
      bench.publish(frame);
      bench.pass(kPeriod);
      ASSERT_FALSE(bench.frames.empty()) << bench.driver.status();
      const models::MocapFrame& seen = bench.frames.back();
      EXPECT_EQ(seen.frame_number, frame.number);
      ASSERT_EQ(seen.bodies.size(), 4u);
      for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(seen.bodies[i].name, frame.bodies[i].name);
      }
      test::expect_poses(seen, frame);
      EXPECT_EQ(bench.driver.wire_counts().broken_blocks, 0);
      EXPECT_EQ(bench.driver.wire_counts().unnamed_bodies, 0);
    }
  }
}

TEST(NatNetSession, MarksUntrackedBodiesAsOccluded) {
  NatNetBench bench;
  bench.run(50, 3);
  EmulatedFrame frame = bench.next(3);
  frame.bodies[1].is_occluded = true;
  bench.publish(frame);
  bench.pass(kPeriod);  // a frame that reports changed definitions waits for the names
  const models::MocapFrame& seen = bench.frames.back();
  EXPECT_FALSE(seen.find("BODY0")->occluded);
  EXPECT_TRUE(seen.find("BODY1")->occluded);
  EXPECT_FALSE(seen.find("BODY2")->occluded);
  EXPECT_EQ(bench.driver.frame_counts().poses_stuck, 0) << "its last pose is not used";
}

// The ids of the emulated server are positions in its list, so a removed body gives its id to the
// next one. No frame may have a pose under another body's name.
TEST(NatNetSession, UsesNewNamesFromTheFirstFrameAfterAChange) {
  NatNetBench bench;
  bench.run(250, 3);
  test::expect_own_names_after_removal(bench, 3, false);
  EXPECT_EQ(bench.frames.back().find("BODY0"), nullptr) << "the body was removed";
}

// The capture time is the instant of exposure, as measured by the server's clock, for any offset
// between the two clocks.
TEST(NatNetSession, StampsFramesAtTheExposure) {
  for (const Duration offset : {Duration{1'000'000}, Duration{std::chrono::hours(24 * 365)}}) {
    NatNetBench bench;
    bench.cut();
    bench.server_clock_offset = offset;
    bench.pass(std::chrono::seconds(1));
    bench.run(100, 2);
    ASSERT_FALSE(bench.frames.empty());
    EXPECT_NEAR(bench.age_s(), 0.0055, 2e-6);
    EXPECT_EQ(bench.driver.frame_counts().latencies_refused, 0);
  }
}

/// Publishes frames whose datagrams arrive `delay` later; echo replies are not delayed.
void run_delayed(NatNetBench& bench, int frames_count, Duration delay) {
  std::deque<std::pair<Duration, std::vector<std::uint8_t>>> queue;
  for (int k = 0; k < frames_count * 10; ++k) {
    if (k % 10 == 0 && bench.peer) {
      bench.peer->now = bench.elapsed + bench.server_clock_offset;
      bench.peer->on_frame(bench.next(2));
      queue.emplace_back(bench.elapsed + delay, std::exchange(bench.peer->outgoing, {}));
    }
    while (!queue.empty() && queue.front().first <= bench.elapsed) {
      bench.driver.receive(bench.now(), queue.front().second);
      queue.pop_front();
    }
    bench.pass(Duration{1'000});
  }
}

TEST(NatNetSession, ReportsADelayFromTheFirstFrameAsAge) {
  NatNetBench bench;
  run_delayed(bench, 100, Duration{60'000});
  ASSERT_FALSE(bench.frames.empty());
  EXPECT_NEAR(bench.age_s(), 0.0655, 1e-3);
  for (const models::MocapFrame& frame : bench.frames) {
    EXPECT_NEAR(to_seconds(frame.arrival - frame.stamp.time), 0.0655, 1e-3);
  }
  EXPECT_EQ(bench.driver.frame_counts().frames_queued, 0);
}

TEST(NatNetSession, ReconnectsToClearAConstantQueue) {
  NatNetBench bench;
  run_delayed(bench, 200, Duration{400'000});
  EXPECT_GE(bench.driver.link_counts().backlogs, 1);
  EXPECT_GT(bench.driver.frame_counts().frames_waited, 0);
  for (const models::MocapFrame& frame : bench.frames) {
    EXPECT_NEAR(to_seconds(frame.arrival - frame.stamp.time), 0.4055, 2e-3)
        << "no frame appears newer than it is";
  }
}

TEST(NatNetSession, IgnoresFramesUntilTheServerReportsItsVersion) {
  NatNetSession session(false, [](const vicon::SeenFrame&) { FAIL(); });
  session.open({ViconBench::kEpoch, Duration{0}});
  std::vector<std::uint8_t> bytes;
  wire::natnet::append_frame(bytes, {{4, 1, 0, 0}}, {});
  EXPECT_TRUE(session.receive({ViconBench::kEpoch, Duration{1}}, bytes));
  EXPECT_EQ(session.counts.frames_before_set, 1);
}

TEST(NatNetSession, RefusesVersionsBefore3) {
  const scenario::MocapSpec spec = test::spec_of(MocapProtocol::kNatNet);
  sim::vicon::ServerSettings settings = ViconBench::settings_for(spec);
  settings.natnet_version = {2, 10};
  const NatNetBench bench(spec, settings);
  EXPECT_FALSE(bench.driver.is_open());
  EXPECT_NE(bench.driver.status().find("speaks NatNet 2.10; version 3.0 or later is required"),
            std::string::npos)
      << bench.driver.status();
}

TEST(NatNetSession, CountsEveryDroppedDatagram) {
  NatNetBench bench;
  bench.run(20, 1);
  const auto dropped = [&](const std::vector<std::uint8_t>& datagram) {
    const auto& counts = bench.driver.wire_counts();
    const std::int64_t before = counts.broken_streams + counts.broken_blocks;
    bench.driver.receive(bench.now(), datagram);
    return counts.broken_streams + counts.broken_blocks - before;
  };
  EXPECT_EQ(dropped({1, 2, 3}), 1) << "not a packet";
  EXPECT_EQ(dropped({7, 0, 0, 0}), 1) << "an empty frame";
  EXPECT_EQ(dropped({5, 0, 0, 0}), 1) << "empty definitions";
  EXPECT_EQ(dropped({1, 0, 0, 0}), 1) << "an empty server info";
  EXPECT_EQ(dropped({13, 0, 0, 0}), 1) << "an empty echo";
  EXPECT_EQ(dropped({12, 0, 0, 0}), 1) << "a client's packet";
  EXPECT_EQ(dropped({0x55, 0, 0, 0}), 1) << "an unknown packet";
  bench.run(2, 1);
  EXPECT_TRUE(bench.driver.has_frames());
}

TEST(NatNetSession, ReconnectsWhenTheServerReturns) {
  NatNetBench bench;
  bench.run(20, 2);
  bench.is_server_up = false;
  bench.peer.reset();
  bench.pass(std::chrono::seconds(5));
  EXPECT_FALSE(bench.driver.has_frames()) << "3 s without data close the connection";
  EXPECT_EQ(bench.driver.link_counts().silences, 1);
  bench.is_server_up = true;
  bench.pass(std::chrono::seconds(3));
  const std::size_t before = bench.frames.size();
  bench.run(50, 2);
  EXPECT_GT(bench.frames.size(), before + 40);
}

// A server that was restarted answers echoes but sends no frames to clients that it does not know.
TEST(NatNetSession, ConnectsAgainWhenFramesStop) {
  NatNetBench bench;
  bench.run(20, 2);
  bench.peer = test::make_peer(ViconBench::settings_for(test::spec_of(MocapProtocol::kNatNet)));
  bench.server_clock_offset = Duration{5};  // the server's clock restarts
  bench.pass(std::chrono::seconds(1));
  bench.number = 0;
  bench.frames.clear();
  bench.run(20, 2);
  EXPECT_GE(bench.frames.size(), 17u);
  EXPECT_NEAR(bench.age_s(), 0.0055, 1e-4);
  EXPECT_EQ(bench.driver.link_counts().silences, 0);
}

}  // namespace
}  // namespace vantage::drivers::natnet
