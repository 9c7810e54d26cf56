#include "planner/app/pose_fill.hpp"

#include <gtest/gtest.h>

namespace vantage::planner {
namespace {

const Time kStart = from_utime(1'700'000'000'000'000);

scenario::Scenario one_robot() {
  scenario::Scenario scenario;
  scenario.robots.resize(1);
  scenario.robots[0].name = "Q1";
  scenario.robots[0].height_m = 1.5;
  return scenario;
}

/// Moves at 1 m/s along its heading.
models::PoseEstimate estimate() {
  models::PoseEstimate out;
  out.stamp.time = kStart;
  out.robot = "Q1";
  out.source = models::PoseSource::kLocalizer;
  out.world_from_body = {1.0, 2.0, kPi / 2};
  out.increment = Duration{100'000};
  out.increments = {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}};
  return out;
}

models::MocapFrame frame_after(double s, bool occluded) {
  models::MocapFrame frame;
  frame.stamp.time = kStart + from_seconds(s);
  frame.bodies = {{"Q1", lift(Pose2{9.0, 9.0, 0.0}, 1.0), occluded}};
  return frame;
}

TEST(PoseFill, MovesThePoseToTheTimeOfTheFrame) {
  models::MocapFrame frame = frame_after(0.2, true);
  EXPECT_TRUE(show_robot(one_robot(), estimate(), frame));
  EXPECT_FALSE(frame.bodies[0].occluded);
  EXPECT_NEAR(frame.bodies[0].world_from_body.translation_m.x(), 1.0, 1e-12);
  EXPECT_NEAR(frame.bodies[0].world_from_body.translation_m.y(), 2.2, 1e-12);
  EXPECT_EQ(frame.bodies[0].world_from_body.translation_m.z(), 1.5);
}

TEST(PoseFill, AddsABodyThatTheFrameLacks) {
  models::MocapFrame frame;
  frame.stamp.time = kStart;
  EXPECT_TRUE(show_robot(one_robot(), estimate(), frame));
  ASSERT_EQ(frame.bodies.size(), 1U);
  EXPECT_EQ(frame.bodies[0].name, "Q1");
}

TEST(PoseFill, LeavesFramesUnchangedThatShowTheRobotOrDifferTooMuchInTime) {
  models::MocapFrame seen = frame_after(0.1, false);
  EXPECT_FALSE(show_robot(one_robot(), estimate(), seen));
  EXPECT_EQ(seen.bodies[0].world_from_body.translation_m.x(), 9.0);
  models::MocapFrame late = frame_after(0.51, true);
  EXPECT_FALSE(show_robot(one_robot(), estimate(), late));
  EXPECT_TRUE(late.bodies[0].occluded);
}

TEST(PoseFill, RefusesUnknownPosesAndRobots) {
  models::MocapFrame frame = frame_after(0.0, true);
  models::PoseEstimate unknown = estimate();
  unknown.source = models::PoseSource::kNone;
  EXPECT_FALSE(show_robot(one_robot(), unknown, frame));
  models::PoseEstimate still = estimate();
  still.increments.clear();
  EXPECT_FALSE(show_robot(one_robot(), still, frame));
  models::PoseEstimate other = estimate();
  other.robot = "Q9";
  EXPECT_FALSE(show_robot(one_robot(), other, frame));
}

}  // namespace
}  // namespace vantage::planner
