#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/drivers/vicon/filter_bench.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"

namespace vantage::drivers::vicon {
namespace {

using test::is_near;

TEST(FrameFilter, SubtractsLatencyFromTheArrival) {
  FilterBench bench;
  bench.begin();
  bench.add("A", {});
  bench.filter.accept(bench.seen);
  EXPECT_EQ(bench.out.arrival, bench.seen.arrival.utime);
  EXPECT_EQ(bench.out.arrival - bench.out.stamp.time, Duration{4'000});
}

TEST(FrameFilter, RefusesImpossibleLatencies) {
  FilterBench bench;
  for (const double latency_s :
       {1.8e35, -0.001, 10.001, std::nan(""), std::numeric_limits<double>::infinity()}) {
    bench.begin().latency_s = latency_s;
    bench.filter.accept(bench.seen);
    EXPECT_EQ(bench.out.arrival - bench.out.stamp.time, Duration{5'000}) << latency_s;
  }
  EXPECT_EQ(bench.filter.counts().latencies_refused, 5);
  bench.begin().latency_s.reset();  // as with a protocol that does not report latency
  bench.filter.accept(bench.seen);
  EXPECT_EQ(bench.out.arrival - bench.out.stamp.time, Duration{5'000});
  EXPECT_EQ(bench.filter.counts().latencies_refused, 5);
}

// A server that cannot keep up reports a long latency. The capture time must be at least that much
// earlier than the arrival.
TEST(FrameFilter, AppliesUnusuallyLongLatencies) {
  for (const double latency_s : {0.2, 0.3, 0.34, 0.4, 1.0, 10.0}) {
    for (const double rise_s : {0.0, 0.4, 20.0}) {
      FilterBench bench;
      Duration silent_since = bench.elapsed;
      double passed_s = 0.0;
      while ((passed_s = to_seconds(bench.elapsed)) < 30.0) {
        bench.begin();
        const double share = rise_s > 0.0 ? std::clamp((passed_s - 3.0) / rise_s, 0.0, 1.0)
                                          : (passed_s < 3.0 ? 0.0 : 1.0);
        bench.seen.latency_s = 0.004 + share * (latency_s - 0.004);
        const Duration arrival = bench.elapsed + from_seconds(*bench.seen.latency_s);
        bench.seen.arrival = {kEpoch + arrival, arrival};
        const std::int64_t before = bench.filter.counts().frames;
        bench.filter.accept(bench.seen);
        if (bench.filter.counts().frames == before) {
          continue;
        }
        const double age_s = to_seconds(bench.out.arrival - bench.out.stamp.time);
        ASSERT_GE(age_s, *bench.seen.latency_s - 1e-6) << passed_s;
        ASSERT_LE(age_s, *bench.seen.latency_s + 0.022) << passed_s;
        ASSERT_LE(arrival - silent_since, from_seconds(latency_s) + Duration{200'000});
        silent_since = arrival;
      }
      EXPECT_GT(bench.filter.counts().frames, 2'900) << latency_s << " " << rise_s;
      EXPECT_EQ(bench.filter.counts().latencies_refused, 0);
    }
  }
}

TEST(FrameFilter, CaptureTimesIncreaseAndNeverExceedTheArrival) {
  FilterBench bench;
  Time last{};
  for (int k = 0; k < 50; ++k) {
    bench.begin();
    // Twenty queued frames arrive at the same instant, with a reported latency that alternates by
    // 30 ms.
    if (k >= 20 && k < 40) {
      bench.seen.arrival.utime = kEpoch + 40 * kPeriod;
    }
    bench.seen.latency_s = k % 3 == 0 ? 0.034 : 0.004;
    bench.filter.accept(bench.seen);
    EXPECT_GT(bench.out.stamp.time, last) << k;
    EXPECT_LE(bench.out.stamp.time, bench.out.arrival) << k;
    last = bench.out.stamp.time;
  }
}

TEST(FrameFilter, FollowsAClockThatIsSetBackByAnHour) {
  FilterBench bench;
  bench.begin();
  bench.filter.accept(bench.seen);
  bench.begin().arrival.utime -= std::chrono::hours(1);
  bench.filter.accept(bench.seen);
  EXPECT_EQ(bench.out.arrival - bench.out.stamp.time, Duration{4'000});
}

TEST(FrameFilter, CountsGapsRepetitionsAndLateFrames) {
  FilterBench bench;
  const auto send = [&](std::uint32_t number) {
    bench.begin().number = number;
    bench.filter.accept(bench.seen);
  };
  for (const std::uint32_t number : {10u, 11u, 11u, 14u, 13u, 15u}) {
    send(number);
  }
  EXPECT_EQ(bench.filter.counts().frames, 4);
  EXPECT_EQ(bench.filter.counts().frames_lost, 2);
  EXPECT_EQ(bench.filter.counts().frames_repeated, 1);
  EXPECT_EQ(bench.filter.counts().frames_late, 1);
  send(0);  // far lower: the server has restarted
  send(1);
  EXPECT_EQ(bench.filter.counts().frames, 6);
  EXPECT_EQ(bench.filter.counts().server_restarts, 1);
  EXPECT_EQ(bench.filter.counts().frames_lost, 2);
  send(0x7FFF0000);
  EXPECT_EQ(bench.filter.counts().server_restarts, 2)
      << "such a number of frames is not lost at once";
}

TEST(FrameFilter, ContinuesWhenFrameNumbersWrap) {
  FilterBench bench;
  for (const std::uint32_t number : {0xFFFFFFFEu, 0xFFFFFFFFu, 0u, 2u}) {
    bench.begin().number = number;
    bench.filter.accept(bench.seen);
  }
  EXPECT_EQ(bench.filter.counts().frames, 4);
  EXPECT_EQ(bench.filter.counts().frames_lost, 1);
  EXPECT_EQ(bench.filter.counts().server_restarts, 0);
}

TEST(FrameFilter, DetectsARestartFromSlightlyLowerNumbers) {
  FilterBench bench;
  for (const std::uint32_t number : {5u, 0u, 1u, 2u, 3u}) {
    bench.begin().number = number;
    bench.filter.accept(bench.seen);
  }
  EXPECT_EQ(bench.filter.counts().frames_late, 2);
  EXPECT_EQ(bench.filter.counts().server_restarts, 1);
  EXPECT_EQ(bench.out.frame_number, 3);
}

TEST(FrameFilter, KeepsBodiesByNameInAnyOrder) {
  FilterBench bench;
  const Pose3 a{{1, 2, 3}, Eigen::Quaterniond::Identity()};
  const Pose3 b{{4, 5, 6}, Eigen::Quaterniond::Identity()};
  for (int k = 0; k < 4; ++k) {
    Pose3 a_now = a;
    Pose3 b_now = b;
    a_now.translation_m.x() += 1e-3 * k;
    b_now.translation_m.x() += 1e-3 * k;
    bench.begin();
    if (k % 2 == 0) {
      bench.add("A", a_now);
      bench.add("B", b_now);
    } else {
      bench.add("B", b_now);
      bench.add("A", a_now);
    }
    bench.filter.accept(bench.seen);
    ASSERT_EQ(bench.out.bodies.size(), 2u);
    EXPECT_EQ(bench.out.bodies[0].name, "A");
    EXPECT_EQ(bench.out.bodies[0].world_from_body.translation_m, a_now.translation_m);
    EXPECT_EQ(bench.out.bodies[1].world_from_body.translation_m, b_now.translation_m);
  }
}

TEST(FrameFilter, MarksAMissingBodyOccludedUntilForgotten) {
  FilterBench bench;
  EXPECT_TRUE(bench.is_accepted(bench.moving_pose()));
  for (int second = 0; second < 59; ++second) {
    bench.elapsed += std::chrono::seconds(1);
    bench.begin();
    bench.filter.accept(bench.seen);
    ASSERT_EQ(bench.out.bodies.size(), 1u);
    EXPECT_TRUE(bench.out.bodies[0].occluded);
  }
  bench.elapsed += std::chrono::seconds(2);
  bench.next_number += 2;
  bench.begin();
  bench.filter.accept(bench.seen);
  EXPECT_TRUE(bench.out.bodies.empty());
}

TEST(FrameFilter, RemovesABodyThatTheServerNoLongerLists) {
  FilterBench bench;
  EXPECT_TRUE(bench.is_accepted(bench.moving_pose()));
  bench.begin().is_complete_list = true;
  bench.add("B", bench.moving_pose());
  bench.filter.accept(bench.seen);
  ASSERT_EQ(bench.out.bodies.size(), 1u);
  EXPECT_EQ(bench.out.bodies[0].name, "B");
}

TEST(FrameFilter, RefusesZeroAndImpossiblePoses) {
  FilterBench bench;
  bench.begin();
  bench.add("A", bench.moving_pose(), PoseState::kZero);
  bench.add("B", bench.moving_pose(), PoseState::kNotAPose);
  bench.add("C", bench.moving_pose(), PoseState::kAbsent);
  bench.add("D", bench.moving_pose());
  bench.filter.accept(bench.seen);
  ASSERT_EQ(bench.out.bodies.size(), 4u);
  EXPECT_TRUE(bench.out.bodies[0].occluded && bench.out.bodies[1].occluded &&
              bench.out.bodies[2].occluded);
  EXPECT_FALSE(bench.out.bodies[3].occluded);
  EXPECT_EQ(bench.out.bodies[0].world_from_body.translation_m, Eigen::Vector3d::Zero());
  EXPECT_EQ(bench.filter.counts().poses_zero, 1);
  EXPECT_EQ(bench.filter.counts().poses_refused, 1);
}

TEST(FrameFilter, RefusesARepeatedPoseFromTheThirdRepetitionOn) {
  FilterBench bench;
  const Pose3 pose = bench.moving_pose();
  EXPECT_TRUE(bench.is_accepted(pose));
  EXPECT_TRUE(bench.is_accepted(pose));
  EXPECT_TRUE(bench.is_accepted(pose));
  EXPECT_FALSE(bench.is_accepted(pose));
  EXPECT_FALSE(bench.is_accepted(pose));
  EXPECT_EQ(bench.filter.counts().poses_stuck, 2);
  Pose3 alive = pose;
  alive.translation_m.x() += 1e-12;
  EXPECT_TRUE(bench.is_accepted(alive));
  GateSettings lenient;
  lenient.stuck_frames = 0;
  FilterBench patient(lenient);
  for (int k = 0; k < 100; ++k) {
    EXPECT_TRUE(patient.is_accepted(pose));
  }
}

TEST(FrameFilter, RefusesInvalidNames) {
  FilterBench bench;
  bench.begin();
  for (const std::string& name :
       {std::string("good"), std::string(), std::string("tab\t"), std::string("\xFF\xFE"),
        std::string("cut \xC3"), std::string("\xC0\xAF"), std::string("drohne \xC3\xA4"),
        std::string("good")}) {
    Pose3 pose = bench.moving_pose();
    bench.add(name, pose);
  }
  bench.filter.accept(bench.seen);
  ASSERT_EQ(bench.out.bodies.size(), 2u);
  EXPECT_EQ(bench.out.bodies[1].name, "drohne \xC3\xA4");
  EXPECT_EQ(bench.filter.counts().names_refused, 5);
  EXPECT_EQ(bench.filter.counts().names_twice, 1);
}

TEST(FrameFilter, LimitsItsMemory) {
  FilterBench bench;
  bench.begin();
  for (int i = 0; i < 2000; ++i) {
    bench.add("BODY" + std::to_string(i), bench.moving_pose());
  }
  bench.filter.accept(bench.seen);
  EXPECT_EQ(bench.out.bodies.size(), FrameFilter::kBodiesMax);
  int published = 0;
  FrameFilter quiet({}, Duration{0}, [&](const models::MocapFrame&) { ++published; });
  const auto accept = [&] {
    bench.begin();
    for (int i = 0; i < 100; ++i) {
      SeenBody& body = bench.seen.add();
      body.pose_state = PoseState::kSeen;
      body.world_from_body = bench.moving_pose();
      body.name.assign("BODY");
      body.name.push_back(static_cast<char>('0' + i / 10));
      body.name.push_back(static_cast<char>('0' + i % 10));
    }
    quiet.accept(bench.seen);
  };
  accept();
  const test::AllocationCounter allocations;
  for (int k = 0; k < 100; ++k) {
    accept();
  }
  EXPECT_EQ(allocations.count(), 0u);
  EXPECT_EQ(published, 101);
}

}  // namespace
}  // namespace vantage::drivers::vicon
