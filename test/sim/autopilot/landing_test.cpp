// Tests of the position at which an emulated autopilot lands.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "sim/autopilot/flight_controller.hpp"
#include "sim/autopilot/profile.hpp"
#include "test/sim/autopilot/pilot.hpp"

namespace vantage::sim {
namespace {

using models::AutopilotDialect;
using test::Pilot;
using test::settings;

constexpr AutopilotDialect kBoth[] = {AutopilotDialect::kPx4, AutopilotDialect::kArdupilot};

/// Takes off to 3 m and then flies with the velocity `velocity_mps`.
void fly_on(Pilot& pilot, const Eigen::Vector3d& velocity_mps) {
  pilot.take_off(3.0);
  pilot.target = FlightTarget{};
  pilot.target->velocity_mps = velocity_mps;
  pilot.run(5.0);
  EXPECT_LT((pilot.controller.airframe().velocity_mps() - velocity_mps).norm(), 0.09);
}

// The vehicle lands at the point that it would reach at its initial velocity within the stopping
// time of its profile. Tested in both directions.
TEST(FlightController, LandsAtThePositionReachedAfterTheStoppingTime) {
  for (const AutopilotDialect dialect : kBoth) {
    for (const double side : {1.0, -1.0}) {
      Pilot pilot(dialect);
      fly_on(pilot, side * Eigen::Vector3d(0.9, -0.5, 0.0));
      const Eigen::Vector3d from_m = pilot.place_m();
      const Eigen::Vector3d from_mps = pilot.controller.airframe().velocity_mps();
      EXPECT_EQ(pilot.controller.set_mode(pilot.profile.land_mode, pilot.now), 0);
      pilot.run_while([&] { return !pilot.controller.airframe().is_on_ground(); });
      const Eigen::Vector3d offset_m = pilot.place_m() - from_m;
      EXPECT_LT((offset_m - pilot.profile.landing_ahead_s * from_mps).head<2>().norm(), 0.03)
          << offset_m.transpose();
    }
  }
}

// Without a position estimate the vehicle stops where it can, descends there, and does not fly
// back.
TEST(FlightController, LandsWithoutPositionWhereItStops) {
  AutopilotSettings set = settings();
  set.lands_on_pose_loss = false;
  for (const double side : {1.0, -1.0}) {
    Pilot pilot(AutopilotDialect::kPx4, set);
    fly_on(pilot, {0.0, side * 1.0, 0.0});
    pilot.gives_poses = false;
    pilot.run(set.pose_loss_s + 0.1);
    ASSERT_FALSE(pilot.controller.has_position(pilot.now));
    const double from_m = pilot.place_m().y();
    EXPECT_EQ(pilot.controller.set_mode(pilot.profile.land_mode, pilot.now), 0);
    double back_mps = 0.0;
    pilot.run_while([&] {
      back_mps = std::min(back_mps, side * pilot.controller.airframe().velocity_mps().y());
      return !pilot.controller.airframe().is_on_ground();
    });
    EXPECT_GT(back_mps, -0.05);
    EXPECT_GT(side * (pilot.place_m().y() - from_m), 0.3);
  }
}

}  // namespace
}  // namespace vantage::sim
