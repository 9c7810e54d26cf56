#include <utility>

#include <gtest/gtest.h>

#include "test/drivers/vicon/filter_bench.hpp"

namespace vantage::drivers::vicon {
namespace {

TEST(FrameFilter, RefusesAnOutlierAndContinues) {
  FilterBench bench;
  for (int k = 0; k < 20; ++k) {
    EXPECT_TRUE(bench.is_accepted(bench.moving_pose()));
  }
  Pose3 outlier = bench.moving_pose();
  outlier.translation_m.y() += 1.0;
  EXPECT_FALSE(bench.is_accepted(outlier));
  EXPECT_TRUE(bench.is_accepted(bench.moving_pose()));
  EXPECT_EQ(bench.filter.counts().poses_outlying, 1);
}

TEST(FrameFilter, RefusesAFlipUntilAVehicleHasLanded) {
  FilterBench bench;
  for (int k = 0; k < 20; ++k) {
    EXPECT_TRUE(bench.is_accepted(bench.moving_pose()));
  }
  const Eigen::Quaterniond half_turn(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ()));
  int refused = 0;
  for (int k = 0; k < 300; ++k) {
    Pose3 flipped = bench.moving_pose();
    flipped.rotation = half_turn;
    refused += bench.is_accepted(flipped) ? 0 : 1;
  }
  EXPECT_EQ(refused, 200) << "2 s at 100 Hz; then the markers must have been moved";
  EXPECT_EQ(bench.filter.counts().poses_flipped, 200);
}

TEST(FrameFilter, RefusesBothBodiesAfterASwap) {
  FilterBench bench;
  const Eigen::Vector3d apart(0.0, 2.0, 0.0);
  for (int k = 0; k < 1000; ++k) {
    bench.begin();
    Pose3 a = bench.moving_pose();
    Pose3 b = bench.moving_pose();
    (k < 20 ? b : a).translation_m += apart;
    bench.add("A", a);
    bench.add("B", b);
    bench.filter.accept(bench.seen);
    ASSERT_EQ(bench.out.bodies[0].occluded, k >= 20) << k;
    ASSERT_EQ(bench.out.bodies[1].occluded, k >= 20) << k;
  }
  EXPECT_EQ(bench.filter.counts().poses_swapped, 2 * 980);
  bench.begin();  // both bodies have the correct names again
  Pose3 b = bench.moving_pose();
  b.translation_m += apart;
  bench.add("A", bench.moving_pose());
  bench.add("B", b);
  bench.filter.accept(bench.seen);
  EXPECT_TRUE(bench.out.bodies[0].occluded)
      << "after 10 m unseen, five frames must confirm the body";
}

// Regression: one wrong frame was followed by a gap. During a gap a body can move from the wrong
// pose to the right one within the gate limits. The right pose was therefore refused as a swap,
// permanently.
TEST(FrameFilter, AcceptsABodyAfterAWrongFrameAndAGap) {
  const Pose3 of_other{{0.0, 1.0, 0.0}, Eigen::Quaterniond::Identity()};
  const Pose3 of_nobody{{0.0, -1.0, 0.0}, Eigen::Quaterniond::Identity()};
  const Pose3 flipped = lift({0.0, 0.0, kPi}, 0.0);
  for (const Pose3& wrong : {of_other, of_nobody, flipped}) {
    for (const int gap_frames : {10, 20, 35}) {
      FilterBench bench;
      for (int k = 0; k < 100; ++k) {
        bench.begin();
        Pose3 pose = bench.moving_pose();
        pose.rotation = k == 20 ? wrong.rotation : pose.rotation;
        pose.translation_m += (k == 20 ? 1.0 : 0.0) * wrong.translation_m;
        bench.add("A", pose,
                  k > 20 && k <= 20 + gap_frames ? PoseState::kAbsent : PoseState::kSeen);
        Pose3 other = bench.moving_pose();
        other.translation_m += of_other.translation_m;
        bench.add("B", other);
        bench.filter.accept(bench.seen);
        ASSERT_EQ(bench.out.bodies[0].occluded, k >= 20 && k <= 20 + gap_frames)
            << k << " after " << wrong.translation_m.transpose() << " and " << gap_frames;
        ASSERT_FALSE(bench.out.bodies[1].occluded);
      }
    }
  }
}

// A body at an earlier position of the tracked body may be another body under the same name. Here
// the other body follows 0.3 m to 0.8 m behind at 1 m/s and is seen in every `period_frames`-th
// frame only.
TEST(FrameFilter, RefusesAnotherBodyAtAnEarlierPosition) {
  for (const double behind_m : {0.3, 0.5, 0.8}) {
    for (const int period_frames : {1, 3, 10, 20}) {
      FilterBench bench;
      for (int k = 0; k < 400; ++k) {
        bench.begin();
        Pose3 leader = bench.moving_pose();
        Pose3 follower = bench.moving_pose();
        leader.translation_m.x() += behind_m;
        if (k >= 20) {
          std::swap(leader, follower);
        }
        const PoseState pose_state =
            k > 20 && k % period_frames != 0 ? PoseState::kAbsent : PoseState::kSeen;
        bench.add("A", leader, pose_state);
        bench.add("B", follower, pose_state);
        bench.filter.accept(bench.seen);
        ASSERT_EQ(bench.out.bodies[0].occluded, k >= 20)
            << k << ", " << behind_m << " m behind, each " << period_frames;
      }
    }
  }
}

TEST(FrameFilter, AcceptsALongLostBodyAfterFiveFrames) {
  FilterBench bench;
  EXPECT_TRUE(bench.is_accepted(bench.moving_pose()));
  bench.elapsed += std::chrono::seconds(2);
  for (int k = 0; k < 4; ++k) {
    EXPECT_FALSE(bench.is_accepted(bench.moving_pose())) << k;
  }
  EXPECT_TRUE(bench.is_accepted(bench.moving_pose()));
  EXPECT_EQ(bench.filter.counts().poses_unconfirmed, 4);
}

}  // namespace
}  // namespace vantage::drivers::vicon
