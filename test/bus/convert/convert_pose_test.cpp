#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "core/angle.hpp"
#include "test/bus/convert/changed_message.hpp"

// Limits of the fields of ODOMETRY_R and POSE_R: the last valid value is accepted and the first
// invalid one is rejected.

namespace vantage::bus {
namespace {

using test::Changed;

TEST(PoseLimits, AreEnforcedForOdometry) {
  models::OdometryReport odometry;
  odometry.interval = Duration{1};
  const Changed<models::OdometryReport> message(odometry);
  message.text("robot", VANTAGE_FIELD(robot));
  message.whole("interval", 1, VANTAGE_FIELD(interval_us), 10'000'000);
  message.between("forward", -1e3, 1e3, VANTAGE_FIELD(motion_body[0]));
  message.between("left", -1e3, 1e3, VANTAGE_FIELD(motion_body[1]));
  message.between("turn", -1e3, 1e3, VANTAGE_FIELD(motion_body[2]));
  message.refused("variance 0", [](auto& w) { w.covariance_motion[2][2] = 0.0; });
  message.refused("asymmetric", [](auto& w) { w.covariance_motion[0][1] = 1e-3; });
  message.refused("command with an interval", [](auto& w) { w.kind = 1; });
  message.taken("command without an interval", [](auto& w) {
    w.kind = 1;
    w.interval_us = 0;
  });
  message.refused("unknown kind", [](auto& w) {
    w.kind = 2;
    w.interval_us = 0;
  });
}

TEST(PoseLimits, AreEnforcedForSightingReports) {
  models::SightingReport report;
  report.sightings = {{from_utime(10), 6, 1.0, 0.5}, {from_utime(20), 7, 2.0, -0.5}};
  const Changed<models::SightingReport> message(report);
  message.text("robot", VANTAGE_FIELD(robot));
  message.count("sightings", VANTAGE_FIELD(num_sightings));
  message.whole("id", -1, VANTAGE_FIELD(sightings[1].id));
  message.between("bearing", -kPi, kPi, VANTAGE_FIELD(sightings[1].bearing_rad));
  message.refused("range 0", [](auto& w) { w.sightings[1].range_m = 0.0; });
  message.refused("descending times", [](auto& w) { w.sightings[1].utime = 9; });
}

TEST(PoseLimits, AreEnforcedForPoseEstimates) {
  models::PoseEstimate estimate;
  estimate.increment = Duration{100'000};
  estimate.increments = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  estimate.sightings = {{from_utime(10), 6, 1.0, 0.5}, {from_utime(20), 7, 2.0, -0.5}};
  const Changed<models::PoseEstimate> message(estimate);
  message.text("robot", VANTAGE_FIELD(robot));
  message.whole("source", 0, VANTAGE_FIELD(source), 2);
  message.finite("x", VANTAGE_FIELD(x_world_m));
  message.finite("y", VANTAGE_FIELD(y_world_m));
  message.finite("yaw", VANTAGE_FIELD(yaw_world_rad));
  message.amount("age", VANTAGE_FIELD(age_s));
  message.refused("variance 0", [](auto& w) { w.covariance_pose[1][1] = 0.0; });
  message.utime("increments' start", VANTAGE_FIELD(increments_from_utime));
  message.whole("increment", 1, VANTAGE_FIELD(increment_us), 10'000'000);
  message.count("increments", VANTAGE_FIELD(num_increments));
  message.count("sightings", VANTAGE_FIELD(num_sightings));
  message.whole("step", 0, VANTAGE_FIELD(step));
  message.count("inputs", VANTAGE_FIELD(num_inputs));
  message.between("forward", -1e3, 1e3, VANTAGE_FIELD(increments[1].forward_m));
  message.between("left", -1e3, 1e3, VANTAGE_FIELD(increments[1].left_m));
  message.between("turn", -1e3, 1e3, VANTAGE_FIELD(increments[1].turn_rad));
  message.whole("id", -1, VANTAGE_FIELD(sightings[1].id));
  message.between("bearing", -kPi, kPi, VANTAGE_FIELD(sightings[1].bearing_rad));
  message.refused("range 0", [](auto& w) { w.sightings[1].range_m = 0.0; });
  message.taken("range 10 km", [](auto& w) { w.sightings[1].range_m = 1e4; });
  message.refused("range above 10 km", [](auto& w) { w.sightings[1].range_m = 1.0001e4; });
  message.taken("equal times", [](auto& w) { w.sightings[1].utime = 10; });
  message.refused("descending times", [](auto& w) { w.sightings[1].utime = 9; });
  message.refused("more than 256 increments", [](auto& w) {
    w.increments.resize(257, w.increments[0]);
    w.num_increments = 257;
  });
}

}  // namespace
}  // namespace vantage::bus
