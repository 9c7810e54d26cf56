// Tests emulated flight controllers: arming, response to set-points, and failsafes. Poses are
// exact, and the air is calm.

#include "sim/autopilot/flight_controller.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "sim/autopilot/profile.hpp"
#include "test/sim/autopilot/pilot.hpp"

namespace vantage::sim {
namespace {

using models::AutopilotDialect;
using test::Pilot;
using test::settings;

constexpr Time kBoot = test::kPilotBoot;

constexpr AutopilotDialect kBoth[] = {AutopilotDialect::kPx4, AutopilotDialect::kArdupilot};

// Rotating the world and mirroring left and right does not change the flight.
TEST(FlightController, IsInvariantToRotationAndReflection) {
  for (const AutopilotDialect dialect : kBoth) {
    const auto fly = [&](double turn_rad, double side) {
      const Eigen::AngleAxisd turn(turn_rad, Eigen::Vector3d::UnitZ());
      const auto see = [&](const Eigen::Vector3d& v) {
        return Eigen::Vector3d(turn * Eigen::Vector3d(v.x(), side * v.y(), v.z()));
      };
      Pilot pilot(dialect, settings(), see({1.0, -2.0, 0.0}), side * 0.3 + turn_rad);
      pilot.take_off(1.5);
      pilot.target->velocity_mps = see({0.8, 0.3, 0.1});
      pilot.target->acceleration_mps2 = see({0.2, -0.4, 0.0});
      pilot.target->yaw_rad = wrap_to_pi(side * 1.5 + turn_rad);
      pilot.target->yaw_rate_radps = side * 0.2;
      pilot.run(1.0);
      pilot.target->position_m.reset();
      pilot.run(0.5);
      pilot.target->position_m = see({3.0, -1.0, -1.2});
      pilot.target->velocity_mps.reset();
      pilot.run(1.0);
      pilot.controller.set_mode(pilot.profile.land_mode, pilot.now);
      pilot.run(1.0);
      const Eigen::Vector3d place_m = turn.inverse() * pilot.place_m();
      return Eigen::Vector4d(place_m.x(), side * place_m.y(), place_m.z(),
                             wrap_to_pi(side * (pilot.controller.airframe().yaw_rad() - turn_rad)));
    };
    const Eigen::Vector4d expected = fly(0.0, 1.0);
    EXPECT_GT((expected.head<2>() - Eigen::Vector2d(1.0, -2.0)).norm(), 0.8);
    for (const double turn_rad : {1.1, -2.5}) {
      for (const double side : {1.0, -1.0}) {
        EXPECT_LT((fly(turn_rad, side) - expected).cwiseAbs().maxCoeff(), 1e-6)
            << turn_rad << ' ' << side;
      }
    }
  }
}

// The vehicle reaches each kind of set-point without exceeding its limits.
TEST(FlightController, ReachesItsSetPointWithinItsLimits) {
  for (const AutopilotDialect dialect : kBoth) {
    Pilot pilot(dialect);
    pilot.take_off(1.5);
    pilot.target->position_m = Eigen::Vector3d(8.0, -6.0, -3.5);
    pilot.target->yaw_rad = 3.0;
    Eigen::Vector3d most_mps = Eigen::Vector3d::Zero();
    double turn_radps = 0.0;
    for (int n = 0; n < 4000; ++n) {
      pilot.step();
      const Eigen::Vector3d& v = pilot.controller.airframe().velocity_mps();
      most_mps = most_mps.cwiseMax(Eigen::Vector3d(v.head<2>().norm(), -v.z(), v.z()));
      turn_radps = std::max(turn_radps, std::abs(pilot.controller.airframe().yaw_rate_radps()));
    }
    EXPECT_LT((pilot.place_m() - Eigen::Vector3d(8.0, -6.0, -3.5)).norm(), 0.05);
    EXPECT_NEAR(wrap_to_pi(pilot.controller.airframe().yaw_rad() - 3.0), 0.0, 0.01);
    EXPECT_NEAR(most_mps.x(), 1.5, 0.12) << "at the maximum speed";
    EXPECT_NEAR(most_mps.y(), 0.7, 0.1);
    EXPECT_NEAR(turn_radps, 1.0, 0.02);
    // Then the vehicle descends within the limit of the descent rate and turns back across ±π.
    pilot.target->position_m->z() = -1.5;
    pilot.target->yaw_rad = -3.0;
    double sink_mps = 0.0;
    double turned_rad = 0.0;
    for (int n = 0; n < 2000; ++n) {
      const double before_rad = pilot.controller.airframe().yaw_rad();
      pilot.step();
      turned_rad += wrap_to_pi(pilot.controller.airframe().yaw_rad() - before_rad);
      sink_mps = std::max(sink_mps, pilot.controller.airframe().velocity_mps().z());
    }
    EXPECT_NEAR(sink_mps, 0.7, 0.1);
    EXPECT_NEAR(turned_rad, 2.0 * kPi - 6.0, 0.02);
    for (const Eigen::Vector3d& wish :
         {Eigen::Vector3d(0.6, -0.5, 0.2), Eigen::Vector3d(-0.4, 0.7, -0.3)}) {
      pilot.target = FlightTarget{};
      pilot.target->velocity_mps = wish;
      pilot.target->yaw_rate_radps = -0.3;
      pilot.run(6.0);
      EXPECT_LT((pilot.controller.airframe().velocity_mps() - wish).norm(), 0.09)
          << wish.transpose();
      EXPECT_NEAR(pilot.controller.airframe().yaw_rate_radps(), -0.3, 1e-3);
    }
  }
}

// A position set-point with a feed-forward velocity is followed without lag.
TEST(FlightController, FollowsAMovingSetPoint) {
  for (const AutopilotDialect dialect : kBoth) {
    Pilot pilot(dialect);
    pilot.take_off(1.5);
    const Eigen::Vector3d velocity_mps(0.6, -0.4, -0.1);
    const Eigen::Vector3d from_m = pilot.place_m();
    const Time begin = pilot.now;
    for (int n = 0; n < 1600; ++n) {
      pilot.target->velocity_mps = velocity_mps;
      pilot.target->position_m = from_m + to_seconds(pilot.now - begin) * velocity_mps;
      pilot.step();
    }
    const Eigen::Vector3d there_m = from_m + to_seconds(pilot.now - begin) * velocity_mps;
    EXPECT_LT((pilot.place_m() - there_m).norm(), 0.05);
    EXPECT_LT((pilot.controller.airframe().velocity_mps() - velocity_mps).norm(), 0.02);
  }
}

TEST(FlightController, LandsAtItsSpeedAndStopsItsMotorsAfterDetection) {
  for (const AutopilotDialect dialect : kBoth) {
    Pilot pilot(dialect);
    pilot.take_off(1.5);
    EXPECT_EQ(pilot.controller.landed_state(), 2);
    EXPECT_EQ(pilot.controller.set_mode(pilot.profile.land_mode, pilot.now), 0);
    EXPECT_EQ(pilot.controller.landed_state(), 4);
    pilot.run(2.0);
    EXPECT_NEAR(pilot.controller.airframe().velocity_mps().z(), 0.4, 0.035);
    pilot.run_while([&] { return !pilot.controller.airframe().is_on_ground(); });
    const Time down = pilot.now;
    EXPECT_LT(pilot.place_m().head<2>().norm(), 0.05);
    pilot.run_while([&] { return pilot.controller.landed_state() == 4; });
    EXPECT_NEAR(to_seconds(pilot.now - down), pilot.profile.landed_delay_s, 0.011);
    EXPECT_TRUE(pilot.controller.is_armed());
    pilot.run_while([&] { return pilot.controller.is_armed(); });
    EXPECT_NEAR(to_seconds(pilot.now - down), pilot.profile.landed_delay_s + 0.5, 0.011);
    EXPECT_EQ(pilot.texts.back(), pilot.profile.landed_text);
    EXPECT_EQ(pilot.controller.landed_state(), 1);
    // After the landing the vehicle can take off again.
    pilot.target.reset();
    pilot.run(1.0);
    pilot.take_off(1.0);
    EXPECT_EQ(pilot.controller.landed_state(), 2);
  }
}

TEST(FlightController, KeepsMotorsRunningWithoutADisarmDelay) {
  AutopilotSettings set = settings();
  set.land_disarm_s.reset();
  set.idle_disarm_s.reset();
  Pilot pilot(AutopilotDialect::kPx4, set);
  pilot.run(1.0);
  EXPECT_EQ(pilot.controller.arm(pilot.now), 0);
  pilot.run(40.0);
  EXPECT_TRUE(pilot.controller.is_armed());
  set.idle_disarm_s = 3.0;
  Pilot idle(AutopilotDialect::kPx4, set);
  idle.run(1.0);
  EXPECT_EQ(idle.controller.arm(idle.now), 0);
  const Time armed = idle.now;
  EXPECT_EQ(idle.controller.arm(idle.now + Duration{1'000'000}), 0) << "it is armed already";
  idle.run_while([&] { return idle.controller.is_armed(); });
  EXPECT_NEAR(to_seconds(idle.now - armed), 3.005, 1e-9);
  EXPECT_EQ(idle.texts.back(), idle.profile.idle_text);
}

// The battery needs a charge of 10 % to arm and of 3 % to continue flying.
TEST(FlightController, DoesNotArmOrFlyWithAnEmptyBattery) {
  for (const AutopilotDialect dialect : kBoth) {
    Pilot pilot(dialect);
    pilot.run(25.0);
    pilot.controller.set_origin();
    pilot.controller.airframe().set_battery_share(0.099);
    EXPECT_EQ(pilot.controller.arm(pilot.now), pilot.profile.refusal);
    pilot.step();
    const bool is_px4 = dialect == AutopilotDialect::kPx4;
    EXPECT_EQ(pilot.texts.back(), is_px4 ? "Arming denied: low battery" : "Arm: Battery 1 low");
    pilot.controller.airframe().set_battery_share(0.101);
    pilot.take_off(1.5);
    pilot.controller.airframe().set_battery_share(0.031);
    pilot.run(0.1);
    EXPECT_EQ(pilot.controller.mode(), pilot.profile.follow_mode);
    pilot.controller.airframe().set_battery_share(0.029);
    pilot.step();
    EXPECT_EQ(pilot.controller.mode(), pilot.profile.land_mode);
    EXPECT_EQ(pilot.texts.back(), "Failsafe activated: battery empty");
    const std::size_t count = pilot.texts.size();
    pilot.run(pilot.profile.failsafe_pause_s);
    EXPECT_EQ(pilot.texts.size(), count) << "only one text";
    EXPECT_NEAR(pilot.place_m().z(), -1.5, 0.12) << "waits before it descends";
    pilot.run(1.0);
    EXPECT_GT(pilot.place_m().z(), -1.3);
  }
}

TEST(FlightController, ArmsOnlyWithoutFaults) {
  Pilot pilot(AutopilotDialect::kPx4);
  pilot.run(1.0);
  pilot.controller.set_fault("Preflight Fail: compass");
  EXPECT_EQ(pilot.controller.arm(pilot.now), 1);
  pilot.step();
  EXPECT_EQ(pilot.texts, std::vector<std::string>{"Preflight Fail: compass"});
  pilot.controller.set_fault("");
  EXPECT_EQ(pilot.controller.arm(pilot.now), 0);
  pilot.step();
  EXPECT_EQ(pilot.texts.back(), pilot.profile.arming_text);
}

// Compares all reasons, in order. The set of reasons depends on the time since power-up.
TEST(FlightController, ArdupilotReportsAllArmingReasons) {
  const std::string none = "Arm: Need Alt Estimate", attitude = "Arm: EKF attitude is bad",
                    odometry = "Arm: VisOdom: not healthy", accels = "Arm: Accels inconsistent",
                    gyros = "Arm: Gyros inconsistent", home = "Arm: AHRS: waiting for home";
  Pilot pilot(AutopilotDialect::kArdupilot);
  pilot.gives_poses = false;
  const auto reasons = [&] {
    pilot.texts.clear();
    EXPECT_EQ(pilot.controller.arm(pilot.now), 4);
    pilot.step();
    return pilot.texts;
  };
  using Words = std::vector<std::string>;
  pilot.run(11.99);
  EXPECT_EQ(reasons(), (Words{none, accels, attitude, home, odometry}));
  pilot.run(0.01);
  EXPECT_EQ(reasons(), (Words{none, gyros, attitude, home, odometry}));
  pilot.gives_poses = true;
  pilot.run(0.5);
  EXPECT_EQ(reasons(), (Words{gyros, home}));
  pilot.controller.set_origin();
  EXPECT_TRUE(pilot.controller.has_origin());
  EXPECT_EQ(reasons(), Words{gyros});
  pilot.run(22.485 - to_seconds(pilot.now - kBoot));
  EXPECT_EQ(reasons(), Words{gyros});
  pilot.run(0.02);
  EXPECT_EQ(pilot.controller.arm(pilot.now), 0);
}

// Offboard arming needs a stream of set-points for more than a second, without a gap of more than
// half a second.
TEST(FlightController, Px4RequiresSetPointsBeforeOffboardArming) {
  const auto is_let_in = [](int targets, int gap_ms) {
    Pilot pilot(AutopilotDialect::kPx4);
    pilot.run(1.0);
    EXPECT_EQ(pilot.controller.arm(pilot.now), 0);
    for (int n = 0; n < targets; ++n) {
      for (int k = 0; k < gap_ms; k += 5) {
        pilot.step();
      }
      pilot.controller.take_target(FlightTarget{}, pilot.now);
    }
    return pilot.controller.set_mode(pilot.profile.follow_mode, pilot.now) == 0;
  };
  EXPECT_TRUE(is_let_in(4, 500));
  EXPECT_FALSE(is_let_in(3, 500)) << "the time must exceed one second";
  EXPECT_FALSE(is_let_in(10, 505)) << "each gap restarts the time";
  EXPECT_TRUE(is_let_in(60, 20));
  Pilot pilot(AutopilotDialect::kPx4);
  pilot.target = FlightTarget{};
  pilot.run(2.0);
  EXPECT_EQ(pilot.controller.set_mode(pilot.profile.follow_mode, pilot.now), 0);
  pilot.target.reset();
  pilot.run(0.5);
  EXPECT_EQ(pilot.controller.arm(pilot.now), 1) << "the last set-point is too old";
  EXPECT_EQ(pilot.controller.set_mode(pilot.profile.start_mode, pilot.now), 0);
  EXPECT_EQ(pilot.controller.arm(pilot.now), 0) << "other modes need no set-points";
}

TEST(FlightController, TakesOffOnlyByCommandFromTheGround) {
  Pilot pilot(AutopilotDialect::kArdupilot);
  pilot.controller.set_origin();
  pilot.run(25.0);
  EXPECT_EQ(pilot.controller.take_off(1.0), 4) << "not armed";
  EXPECT_EQ(pilot.controller.arm(pilot.now), 0);
  EXPECT_EQ(pilot.controller.take_off(1.0), 4) << "wrong mode";
  EXPECT_EQ(pilot.controller.set_mode(pilot.profile.follow_mode, pilot.now), 0);
  EXPECT_EQ(pilot.controller.take_off(0.0), 4);
  EXPECT_EQ(pilot.controller.take_off(-1.0), 4);
  EXPECT_EQ(pilot.controller.landed_state(), 1);
  EXPECT_EQ(pilot.controller.take_off(1.2), 0);
  // After the take-off command, the motors spool up for a second and the vehicle climbs at 0.7 m/s
  // at most.
  const Time begin = pilot.now;
  pilot.run_while([&] { return pilot.controller.airframe().is_on_ground(); });
  EXPECT_GT(to_seconds(pilot.now - begin), 0.99);
  EXPECT_LT(to_seconds(pilot.now - begin), 1.5);
  EXPECT_EQ(pilot.controller.landed_state(), 3);
  EXPECT_EQ(pilot.controller.take_off(1.0), 4) << "already in flight";
  pilot.run(7.0);
  EXPECT_NEAR(pilot.place_m().z(), -1.2, 0.05);
  EXPECT_LT(pilot.place_m().head<2>().norm(), 0.01);
  EXPECT_EQ(pilot.controller.landed_state(), 3) << "until it receives a target";
  pilot.target = FlightTarget{};
  pilot.run(0.1);
  EXPECT_EQ(pilot.controller.landed_state(), 2);
  EXPECT_EQ(pilot.controller.disarm(false), 4);
  EXPECT_EQ(pilot.controller.disarm(true), 0);
  EXPECT_FALSE(pilot.controller.is_armed());
}

// The flags differ on the ground, in the air, without poses for more than 0.6 s, and after the loss
// of the position.
TEST(FlightController, ReportsEstimatorFlags) {
  AutopilotSettings set = settings();
  set.lands_on_pose_loss = false;
  Pilot pilot(AutopilotDialect::kPx4, set);
  EXPECT_EQ(pilot.controller.estimator_flags(pilot.now), 0x0A5);
  pilot.take_off(1.5);
  EXPECT_EQ(pilot.controller.estimator_flags(pilot.now), 0x12F);
  pilot.gives_poses = false;
  const Time last = pilot.now - Duration{(pilot.ticks - 1) % 4 * 5'000 + 5'000};
  EXPECT_EQ(pilot.controller.estimator_flags(last + Duration{600'000}), 0x12F);
  EXPECT_EQ(pilot.controller.estimator_flags(last + Duration{600'001}), 0x02F);
  EXPECT_EQ(pilot.controller.estimator_flags(last + Duration{2'000'000}), 0x02F);
  EXPECT_EQ(pilot.controller.estimator_flags(last + Duration{2'000'001}), 0x025);
  set.has_barometer = false;
  pilot.controller.set_settings(set);
  EXPECT_EQ(pilot.controller.estimator_flags(last + Duration{600'000}), 0x12F);
  EXPECT_EQ(pilot.controller.estimator_flags(last + Duration{600'001}), 0x00F);
  pilot.run(4.0);
  EXPECT_EQ(pilot.controller.mode(), pilot.profile.follow_mode) << "a landing is not configured";
  EXPECT_TRUE(pilot.texts.empty() || pilot.texts.back() == pilot.profile.arming_text);
}

// If the station is lost while the vehicle is on the ground, the motors stop. A station that is
// received again can be lost again.
TEST(FlightController, EntersFailsafeOnlyOnLossOfItsOwnStation) {
  AutopilotSettings set = settings();
  set.heartbeat_loss_s = 1.0;
  set.station_id = 250;
  Pilot pilot(AutopilotDialect::kPx4, set);
  pilot.run(1.0);
  EXPECT_EQ(pilot.controller.arm(pilot.now), 0);
  pilot.run(2.0);
  EXPECT_TRUE(pilot.controller.is_armed()) << "the station was never received";
  pilot.controller.take_heartbeat(251, pilot.now);
  pilot.run(2.0);
  EXPECT_TRUE(pilot.controller.is_armed()) << "another station";
  for (int time = 0; time < 2; ++time) {
    pilot.controller.take_heartbeat(250, pilot.now);
    pilot.run(1.0);
    EXPECT_TRUE(pilot.controller.is_armed());
    pilot.run(0.005);
    EXPECT_FALSE(pilot.controller.is_armed());
    EXPECT_EQ(pilot.texts.back(), "GCS Failsafe: Disarming");
    const std::size_t count = pilot.texts.size();
    EXPECT_EQ(pilot.controller.arm(pilot.now), 0);
    pilot.run(1.0);
    EXPECT_EQ(pilot.texts.size(), count + 1) << "one text for each";
    EXPECT_TRUE(pilot.controller.is_armed());
  }
}

}  // namespace
}  // namespace vantage::sim
