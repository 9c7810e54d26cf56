// Tests flights in which mocap swaps the names of two bodies, which can happen when it loses both.

#include <cmath>

#include <gtest/gtest.h>

#include "test/drivers/vicon/filter_bench.hpp"

namespace vantage::drivers::vicon {
namespace {

/// Two bodies that fly side by side at 0.7 m/s.
struct Pair {
  explicit Pair(double separation_m) : apart_m(separation_m), bench(gate()) {}

  static GateSettings gate() {
    GateSettings settings;
    settings.predicted_max_m = 0.27;
    return settings;
  }
  /// Sends frames of both bodies; returns the number of published poses that belong to the other
  /// body.
  int fly(double seconds, bool is_seen, bool is_swapped) {
    int wrong = 0;
    for (int k = 0; k < std::lround(100.0 * seconds); ++k) {
      bench.begin();
      const double x_m = 0.7 * to_seconds(bench.elapsed);
      const Pose3 a{{x_m, 0.0, 1.0}, Eigen::Quaterniond::Identity()};
      const Pose3 b{{x_m, apart_m, 1.0}, Eigen::Quaterniond::Identity()};
      const PoseState pose_state = is_seen ? PoseState::kSeen : PoseState::kAbsent;
      bench.add("A", is_swapped ? b : a, pose_state);
      bench.add("B", is_swapped ? a : b, pose_state);
      bench.filter.accept(bench.seen);
      good = 0;
      for (const models::MocapBody& body : bench.out.bodies) {
        const Pose3& own = body.name == "A" ? a : b;
        good += body.occluded ? 0 : 1;
        wrong += !body.occluded && body.world_from_body.translation_m != own.translation_m ? 1 : 0;
      }
    }
    return wrong;
  }

  double apart_m;
  FilterBench bench;
  int good = 0;  ///< number of bodies with a pose in the newest frame
};

struct SwapRow {
  double apart_m;
  double gap_s;
};
constexpr SwapRow kRows[] = {{0.24, 0.0}, {0.24, 0.05}, {0.4, 0.1},  {0.58, 0.0},
                             {0.58, 0.3}, {1.0, 0.1},   {1.0, 0.35}, {2.0, 0.2}};

TEST(FrameFilter, PublishesNoSwappedPosesAfterAGap) {
  for (const SwapRow& row : kRows) {
    SCOPED_TRACE(testing::Message() << row.apart_m << " m apart, unseen for " << row.gap_s << " s");
    Pair pair(row.apart_m);
    EXPECT_EQ(pair.fly(3.0, true, false), 0);
    ASSERT_EQ(pair.good, 2);
    static_cast<void>(pair.fly(row.gap_s, false, false));
    EXPECT_EQ(pair.fly(3.0, true, true), 0);
    EXPECT_GT(pair.bench.filter.counts().poses_swapped, 0);
    // The names are correct again.
    EXPECT_EQ(pair.fly(3.0, true, false), 0);
    EXPECT_EQ(pair.good, 2);
  }
}

TEST(FrameFilter, AcceptsUnswappedPosesAfterAGap) {
  for (const SwapRow& row : kRows) {
    SCOPED_TRACE(testing::Message() << row.apart_m << " m apart, unseen for " << row.gap_s << " s");
    Pair pair(row.apart_m);
    EXPECT_EQ(pair.fly(3.0, true, false), 0);
    static_cast<void>(pair.fly(row.gap_s, false, false));
    EXPECT_EQ(pair.fly(3.0, true, false), 0);
    EXPECT_EQ(pair.good, 2);
    EXPECT_EQ(pair.bench.filter.counts().poses_swapped, 0);
    EXPECT_EQ(pair.bench.filter.counts().poses_outlying, 0);
  }
}

// One body passes the other at 2 m/s and a distance of 0.3 m; their names are not swapped.
TEST(FrameFilter, KeepsTheNamesOfPassingBodies) {
  for (const double gap_s : {0.0, 0.1, 0.3}) {
    FilterBench bench(Pair::gate());
    for (int k = 0; k < 400; ++k) {
      const double passed_s = to_seconds(bench.begin().arrival.steady) - 2.0;
      const PoseState pose_state =
          std::abs(passed_s) < 0.5 * gap_s ? PoseState::kAbsent : PoseState::kSeen;
      bench.add("A", {{passed_s, 0.0, 1.0}, Eigen::Quaterniond::Identity()}, pose_state);
      bench.add("B", {{-passed_s, 0.3, 1.0}, Eigen::Quaterniond::Identity()}, pose_state);
      bench.filter.accept(bench.seen);
      for (const models::MocapBody& body : bench.out.bodies) {
        EXPECT_EQ(body.occluded, pose_state == PoseState::kAbsent) << passed_s;
      }
    }
    EXPECT_EQ(bench.filter.counts().poses_swapped, 0);
  }
}

}  // namespace
}  // namespace vantage::drivers::vicon
