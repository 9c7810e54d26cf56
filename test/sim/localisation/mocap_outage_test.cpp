#include "sim/localisation/mocap_outage.hpp"

#include <gtest/gtest.h>

namespace vantage::sim {
namespace {

const Time kStart = from_utime(1'700'000'000'000'000);

std::vector<scenario::RobotSpec> one_robot() {
  scenario::RobotSpec robot;
  robot.name = "Q1";
  robot.height_m = 1.0;
  return {robot};
}

models::TruthFrame truth_at(double after_s, double height_m) {
  models::TruthFrame truth;
  truth.stamp.time = kStart + from_seconds(after_s);
  truth.bodies = {{"Q1", -1, lift(Pose2{0.5, 0.5, 0.0}, height_m), Eigen::Vector3d::Zero()},
                  {"R1", 0, lift(Pose2{-3.0, 0.0, 0.0}, 0.0), Eigen::Vector3d::Zero()}};
  return truth;
}

struct Row {
  const char* name;
  scenario::MocapOutageSpec outage;
  double at_s;
  Eigen::Vector2d position_m;
  bool hidden;
};

// The robot reaches its height after 2 s.
TEST(MocapOutage, HidesBodiesInItsTimeAndArea) {
  scenario::MocapOutageSpec always;
  scenario::MocapOutageSpec interval;
  interval.from_s = 3.0;
  interval.to_s = 5.0;
  scenario::MocapOutageSpec flying;
  flying.after_take_off = true;
  flying.from_s = 1.0;
  scenario::MocapOutageSpec corner;
  corner.area = models::Rectangle{{0.0, 0.0}, {1.0, 1.0}};
  for (const Row& row : {Row{"always", always, 0.0, {0.5, 0.5}, true},
                         Row{"interval, before", interval, 2.9, {0.5, 0.5}, false},
                         Row{"interval, begin", interval, 3.0, {0.5, 0.5}, true},
                         Row{"interval, end", interval, 5.0, {0.5, 0.5}, false},
                         Row{"after take-off, before", flying, 2.9, {0.5, 0.5}, false},
                         Row{"after take-off", flying, 3.0, {0.5, 0.5}, true},
                         Row{"area, inside", corner, 1.0, {0.5, 0.5}, true},
                         Row{"area, outside", corner, 1.0, {1.1, 0.5}, false}}) {
    MocapOutage outage({row.outage}, one_robot(), kStart);
    for (int i = 0; i <= 100; ++i) {
      outage.update(truth_at(0.1 * i, 0.1 * i >= 1.95 ? 1.0 : 0.1));
    }
    EXPECT_EQ(outage.hides(row.position_m, kStart + from_seconds(row.at_s)), row.hidden)
        << row.name;
  }
}

TEST(MocapOutage, MarksHiddenBodiesAsOccluded) {
  scenario::MocapOutageSpec corner;
  corner.area = models::Rectangle{{0.0, 0.0}, {1.0, 1.0}};
  const MocapOutage outage({corner}, one_robot(), kStart);
  const models::TruthFrame truth = truth_at(1.0, 1.0);
  models::MocapFrame frame;
  frame.stamp.time = truth.stamp.time;
  frame.bodies = {{"Q1", truth.bodies[0].world_from_body}, {"R1", truth.bodies[1].world_from_body}};
  outage.hide(frame, truth);
  EXPECT_TRUE(frame.bodies[0].occluded);
  EXPECT_FALSE(frame.bodies[1].occluded);
}

TEST(MocapOutage, HidesNothingWithoutEntries) {
  const MocapOutage outage({}, one_robot(), kStart);
  EXPECT_FALSE(outage.hides({0.0, 0.0}, kStart));
}

}  // namespace
}  // namespace vantage::sim
