#include "sim/quadrotor/course.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "sim/quadrotor/quadrotor.hpp"
#include "sim/random.hpp"

namespace vantage::sim {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr Duration kSecond{1'000'000};
constexpr Duration kInstant{1};

/// Returns a trajectory at 1 m/s for 10 s along `yaw_rad` from (`x_m`, 0) at `height_m`.
models::Trajectory straight(Time start, double x_m, double yaw_rad, double height_m) {
  return {start, {x_m, 0.0, yaw_rad}, height_m, {{{1.0, 0.25}, 10.0, 0.0}}};
}

TEST(Course, FollowsTheLastStartedPlan) {
  Course course(kStart, {1.0, 2.0, 0.5}, 1.5);
  EXPECT_EQ(course.newest_start(), kStart);
  course.follow(straight(kStart + kSecond, 3.0, 0.0, 2.0), 7);
  course.follow(straight(kStart + 3 * kSecond, 5.0, kPi / 2, 2.5), 8);
  struct Row {
    Time time;
    std::int64_t round;
    double height_m;
  };
  for (const Row& row : {Row{kStart - kSecond, -1, 1.5}, Row{kStart, -1, 1.5},
                         Row{kStart + kSecond - kInstant, -1, 1.5}, Row{kStart + kSecond, 7, 2.0},
                         Row{kStart + 3 * kSecond - kInstant, 7, 2.0},
                         Row{kStart + 3 * kSecond, 8, 2.5}, Row{kStart + 90 * kSecond, 8, 2.5}}) {
    EXPECT_EQ(course.round(row.time), row.round);
    EXPECT_EQ(course.height_m(row.time), row.height_m);
  }
  EXPECT_EQ(course.at(kStart).world_from_body, (Pose2{1.0, 2.0, 0.5}));
  EXPECT_EQ(course.at(kStart).velocity_world_mps, Eigen::Vector2d::Zero());
  EXPECT_EQ(course.newest_start(), kStart + 3 * kSecond);
  // The plan's heading is along the y axis, so the velocity is, too.
  const CoursePoint point = course.at(kStart + 3 * kSecond);
  EXPECT_EQ(point.world_from_body, (Pose2{5.0, 0.0, kPi / 2}));
  EXPECT_LT((point.velocity_world_mps - Eigen::Vector2d(0.0, 1.0)).norm(), 1e-12);
  EXPECT_EQ(point.yaw_rate_radps, 0.25);
}

TEST(Course, DropsPlansThatStartAtOrAfterTheNewOne) {
  Course course(kStart, {}, 1.0);
  course.follow(straight(kStart + kSecond, 1.0, 0.0, 2.0), 1);
  course.follow(straight(kStart + 2 * kSecond, 2.0, 0.0, 3.0), 2);
  course.follow(straight(kStart + 3 * kSecond, 3.0, 0.0, 4.0), 3);
  course.follow(straight(kStart + 2 * kSecond, 9.0, 0.0, 5.0), 4);
  EXPECT_EQ(course.newest_start(), kStart + 2 * kSecond);
  EXPECT_EQ(course.round(kStart + kSecond), 1);
  EXPECT_EQ(course.round(kStart + 2 * kSecond), 4);
  EXPECT_EQ(course.round(kStart + 9 * kSecond), 4);
  // This plan starts before the initial hover. At times before the plan, the hover still applies.
  course.follow(straight(kStart - kSecond, 9.0, 0.0, 6.0), 5);
  EXPECT_EQ(course.round(kStart - 2 * kSecond), -1);
  EXPECT_EQ(course.round(kStart), 5);
}

// A stop follows the velocity for v²/2b and keeps the heading, for any direction of motion and any
// heading.
TEST(Course, StopsStraightAndKeepsItsHeading) {
  for (const double direction_rad : {0.0, 0.7, 2.5, -2.5, -0.7}) {
    Course course(kStart, {}, 1.0);
    course.follow(straight(kStart, 0.0, 0.0, 1.0), 3);
    const Eigen::Vector2d ahead(std::cos(direction_rad), std::sin(direction_rad));
    course.stop(kStart + kSecond, {4.0, -1.0, 0.3}, 1.2 * ahead, 1.75, 2.0);
    EXPECT_EQ(course.newest_start(), kStart + kSecond);
    for (const double after_s : {0.0, 0.25, 0.5, 0.6, 2.0, 100.0}) {
      const Time time = kStart + kSecond + from_seconds(after_s);
      const double t = std::min(after_s, 0.6);
      const CoursePoint point = course.at(time);
      const Eigen::Vector2d offset_m =
          point.world_from_body.position_m() - Eigen::Vector2d(4.0, -1.0);
      EXPECT_LT((offset_m - (1.2 * t - t * t) * ahead).norm(), 1e-9) << direction_rad;
      EXPECT_LT((point.velocity_world_mps - (1.2 - 2.0 * t) * ahead).norm(), 1e-9);
      EXPECT_EQ(point.world_from_body.yaw_rad, 0.3);
      EXPECT_EQ(point.yaw_rate_radps, 0.0);
      EXPECT_EQ(course.round(time), -1);
      EXPECT_EQ(course.height_m(time), 1.75);
    }
  }
}

TEST(Course, StopAtZeroSpeedIsAHover) {
  Course course(kStart, {}, 1.0);
  course.stop(kStart, {4.0, -1.0, -3.0}, Eigen::Vector2d::Zero(), 1.5, 2.0);
  for (const Duration after : {Duration{0}, kSecond}) {
    EXPECT_EQ(course.at(kStart + after).world_from_body, (Pose2{4.0, -1.0, -3.0}));
    EXPECT_EQ(course.at(kStart + after).velocity_world_mps, Eigen::Vector2d::Zero());
  }
}

// The controller needs the course of the last second. Plans that applied then are kept, older ones
// are removed.
TEST(Course, PrunesOnlyPlansOlderThanLookback) {
  Course course(kStart, {}, 1.0);
  for (int k = 1; k <= 4; ++k) {
    course.follow(straight(kStart + k * kSecond, k, 0.0, 1.0), k);
  }
  course.prune(kStart + 3 * kSecond);
  EXPECT_EQ(course.round(kStart + kSecond), 1) << "the second plan began one second ago";
  course.prune(kStart + 3 * kSecond + kInstant);
  EXPECT_EQ(course.round(kStart + kSecond), 2) << "the first plan was removed";
  EXPECT_EQ(course.round(kStart + 3 * kSecond), 3);
  EXPECT_EQ(course.round(kStart + 4 * kSecond), 4);
  course.prune(kStart + 100 * kSecond);
  EXPECT_EQ(course.round(kStart + 2 * kSecond), 4) << "the last plan is always kept";
  EXPECT_EQ(course.newest_start(), kStart + 4 * kSecond);
}

// Tests every state with every command, on the ground and above it. States that are not in the
// table stay unchanged.
TEST(AfterCommand, MatchesTheTable) {
  const FlightState states[] = {FlightState::kIdle, FlightState::kFollow, FlightState::kHold,
                                FlightState::kLand, FlightState::kKilled};
  struct Row {
    FlightState from;
    OperatorAction action;
    FlightState to;
    bool needs_ground;
  };
  const Row changes[] = {
      {FlightState::kKilled, OperatorAction::kArm, FlightState::kIdle, true},
      {FlightState::kIdle, OperatorAction::kTakeOff, FlightState::kHold, false},
      {FlightState::kHold, OperatorAction::kFollow, FlightState::kFollow, false},
      {FlightState::kFollow, OperatorAction::kHold, FlightState::kHold, false},
      {FlightState::kFollow, OperatorAction::kLand, FlightState::kLand, false},
      {FlightState::kHold, OperatorAction::kLand, FlightState::kLand, false},
      {FlightState::kIdle, OperatorAction::kEmergencyStop, FlightState::kKilled, false},
      {FlightState::kFollow, OperatorAction::kEmergencyStop, FlightState::kKilled, false},
      {FlightState::kHold, OperatorAction::kEmergencyStop, FlightState::kKilled, false},
      {FlightState::kLand, OperatorAction::kEmergencyStop, FlightState::kKilled, false}};
  for (const FlightState state : states) {
    for (const OperatorAction action :
         {OperatorAction::kHeartbeat, OperatorAction::kArm, OperatorAction::kTakeOff,
          OperatorAction::kFollow, OperatorAction::kHold, OperatorAction::kLand,
          OperatorAction::kEmergencyStop}) {
      for (const bool on_ground : {false, true}) {
        FlightState expected = state;
        for (const Row& row : changes) {
          if (row.from == state && row.action == action && (on_ground || !row.needs_ground)) {
            expected = row.to;
          }
        }
        EXPECT_EQ(after_command(state, action, on_ground), expected)
            << static_cast<int>(state) << ' ' << static_cast<int>(action) << ' ' << on_ground;
      }
    }
  }
}

// The random stream is seeded with the lower half and the upper half of the seed and the letters of
// the purpose.
TEST(RandomStream, DependsOnSeedAndPurposeOnly) {
  const std::uint64_t seed = 0x0123456789ABCDEFULL;
  std::seed_seq words{0x89ABCDEFU, 0x01234567U, std::uint32_t{'a'}, 0xFFU};
  EXPECT_EQ(random_stream(seed, "a\xFF"), std::mt19937_64(words));
  EXPECT_NE(random_stream(seed, "a"), random_stream(seed, "a\xFF"));
  EXPECT_NE(random_stream(seed, "ab"), random_stream(seed, "ba"));
  for (int bit = 0; bit < 64; ++bit) {
    EXPECT_NE(random_stream(seed, "a"), random_stream(seed ^ (std::uint64_t{1} << bit), "a"))
        << bit;
  }
}

}  // namespace
}  // namespace vantage::sim
