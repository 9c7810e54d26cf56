// Compares the airframe and the pose estimate of an emulated vehicle with closed forms.

#include "sim/autopilot/airframe.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "sim/autopilot/pose_estimator.hpp"
#include "sim/autopilot/profile.hpp"
#include "sim/autopilot/settings.hpp"

namespace vantage::sim {
namespace {

using models::AutopilotDialect;

constexpr double kGravityMps2 = 9.81;
constexpr double kDtS = 0.005;

AirframeParameters still_air() {
  AirframeParameters out;
  out.wind_sigma_mps = 0.0;
  return out;
}

const Eigen::Vector3d kPlace(1.0, 2.0, -0.1);

/// Returns an airframe that hovers some metres above its start.
Airframe in_the_air(const AirframeParameters& p, double yaw_rad = 0.0) {
  Airframe body(p, 1, kPlace, yaw_rad);
  for (int n = 0; n < 400; ++n) {
    body.step(true, {0.0, 0.0, n < 200 ? -4.0 : 0.0}, 0.0, kDtS);
  }
  EXPECT_LT(body.position_m().z(), -1.5);
  return body;
}

void run(Airframe& body, double seconds, const Eigen::Vector3d& wish_mps2,
         double turn_radps = 0.0) {
  for (int n = 0; n < std::lround(seconds / kDtS); ++n) {
    body.step(true, wish_mps2, turn_radps, kDtS);
  }
}

// Once tilt and thrust have settled, the airframe reaches the commanded acceleration minus drag in
// every direction.
TEST(Airframe, ReachesCommandedAccelerationInEveryDirection) {
  const AirframeParameters p = still_air();
  for (const Eigen::Vector3d& wish :
       {Eigen::Vector3d(2.0, 0.0, 0.0), Eigen::Vector3d(-2.0, 1.0, 0.0),
        Eigen::Vector3d(0.0, -1.5, 2.0), Eigen::Vector3d(1.0, 1.0, -3.0)}) {
    Airframe body = in_the_air(p);
    run(body, 1.0, wish);
    const Eigen::Vector3d before_mps = body.velocity_mps();
    body.step(true, wish, 0.0, kDtS);
    const Eigen::Vector3d expected = wish - p.drag_per_s * before_mps;
    EXPECT_LT(((body.velocity_mps() - before_mps) / kDtS - expected).norm(), 1e-3)
        << wish.transpose();
    // The body's z axis is opposite to the thrust direction, which is that of the commanded force.
    const Eigen::Vector3d force = wish - Eigen::Vector3d(0.0, 0.0, kGravityMps2);
    const Eigen::Vector3d down = body.local_from_body() * Eigen::Vector3d::UnitZ();
    EXPECT_LT((down + force.normalized()).norm(), 1e-3);
    EXPECT_NEAR(body.thrust_share(), force.norm() / p.thrust_max_mps2, 1e-4);
  }
}

TEST(Airframe, LimitsTiltThrustAndDescentRate) {
  const AirframeParameters p = still_air();
  Airframe tilted = in_the_air(p);
  run(tilted, 1.0, {30.0, -40.0, 0.0});
  const Eigen::Vector3d down = tilted.local_from_body() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::acos(down.z()), 0.6, 1e-3);
  EXPECT_NEAR(std::atan2(down.y(), down.x()), std::atan2(40.0, -30.0), 1e-6);
  Airframe pushed = in_the_air(p);
  run(pushed, 0.5, {0.0, 0.0, -50.0});
  EXPECT_NEAR(pushed.thrust_share(), 1.0, 1e-3);
  // At any commanded sink rate, the thrust is at least a fifth of the weight.
  Airframe sinking = in_the_air(p);
  run(sinking, 0.5, {0.0, 0.0, 40.0});
  EXPECT_NEAR(sinking.thrust_share(), 0.2 * kGravityMps2 / 20.0, 1e-3);
  Airframe off = in_the_air(p);
  for (int n = 0; n < 100; ++n) {
    off.step(false, {3.0, 3.0, -3.0}, 2.0, kDtS);
  }
  EXPECT_NEAR(off.thrust_share(), 0.0, 1e-3);
  EXPECT_NEAR(off.yaw_rate_radps(), 0.0, 1e-9);
  EXPECT_GT(off.velocity_mps().z(), 1.0);
}

TEST(Airframe, DelaysTurnAndThrustByTheirLags) {
  const AirframeParameters p = still_air();
  for (const double side : {1.0, -1.0}) {
    Airframe body = in_the_air(p, side * 3.0);
    const double before = body.thrust_share();
    double expected_rad = side * 3.0;
    for (int n = 1; n <= 200; ++n) {
      body.step(true, {0.0, 0.0, -side * 4.0}, side * 1.5, kDtS);
      const double rate = side * 1.5 * (1.0 - std::exp(-n * kDtS / p.yaw_rate_lag_s));
      expected_rad += kDtS * rate;
      EXPECT_NEAR(body.yaw_rate_radps(), rate, 1e-9);
      EXPECT_NEAR(wrap_to_pi(body.yaw_rad() - expected_rad), 0.0, 1e-9);
      EXPECT_LE(std::abs(body.yaw_rad()), kPi);
      const double gap = (kGravityMps2 + side * 4.0) / 20.0 - before;
      EXPECT_NEAR(body.thrust_share(), before + gap * (1.0 - std::exp(-n * kDtS / p.thrust_lag_s)),
                  1e-9);
    }
    // When the vehicle is level, its nose points along its yaw.
    const Eigen::Vector3d nose = body.local_from_body() * Eigen::Vector3d::UnitX();
    EXPECT_LT(
        (nose - Eigen::Vector3d(std::cos(body.yaw_rad()), std::sin(body.yaw_rad()), 0.0)).norm(),
        1e-9);
  }
  // When the vehicle is tilted, its nose stays on the same side.
  Airframe body = in_the_air(p, kPi / 2);
  run(body, 1.0, {0.0, 5.0, 0.0});
  const Eigen::Vector3d nose = body.local_from_body() * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(nose.x(), 0.0, 1e-6);
  EXPECT_GT(nose.y(), 0.8);
  EXPECT_GT(nose.z(), 0.4) << "the nose points down during acceleration";
}

TEST(Airframe, IsStationaryOnTheGroundBeforeLiftAndAfterAFall) {
  AirframeParameters windy = still_air();
  windy.wind_mean_mps = {5.0, -4.0, 0.0};
  Airframe body(windy, 1, kPlace, 0.5);
  run(body, 1.0, {1.0, 1.0, 0.5}, 1.0);
  EXPECT_TRUE(body.is_on_ground());
  EXPECT_EQ(body.position_m(), kPlace);
  EXPECT_EQ(body.velocity_mps(), Eigen::Vector3d::Zero());
  EXPECT_EQ(body.yaw_rate_radps(), 0.0);
  EXPECT_EQ(body.yaw_rad(), 0.5);
  EXPECT_EQ(body.local_from_body() * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ());
  Airframe falls = in_the_air(windy);
  run(falls, 1.0, Eigen::Vector3d::Zero());
  double place_m = 0.0;
  for (int n = 0; n < 1000; ++n) {
    falls.step(false, Eigen::Vector3d::Zero(), 0.0, kDtS);
    place_m = n == 900 ? falls.position_m().x() : place_m;
  }
  EXPECT_TRUE(falls.is_on_ground());
  EXPECT_EQ(falls.position_m().z(), kPlace.z());
  EXPECT_EQ(falls.position_m().x(), place_m);
  EXPECT_GT(place_m, kPlace.x() + 1.0);
  EXPECT_LT(falls.position_m().y(), kPlace.y() - 1.0);
}

// If v̇ = d (w − v), and the wind w has the standard deviation σ and the decay rate β, then the
// speed v has the variance σ² d/(d + β).
TEST(Airframe, GustsCauseTheExpectedSpeedVariance) {
  AirframeParameters p;
  p.wind_sigma_mps = 0.5;
  p.wind_memory_s = 0.5;
  p.drag_per_s = 2.0;
  p.wind_mean_mps = {0.3, -0.6, 0.0};
  Airframe body = in_the_air(p);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  constexpr int kSteps = 160'000;
  for (int n = 0; n < kSteps; ++n) {
    body.step(true, {0.0, 0.0, -0.2}, 0.0, kDtS);
    const Eigen::Vector2d v = (body.velocity_mps() - p.wind_mean_mps).head<2>();
    mean += v / kSteps;
    squares += v.cwiseAbs2() / kSteps;
  }
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(mean(axis), 0.0, 0.05);
    EXPECT_NEAR(squares(axis), 0.25 * 2.0 / (2.0 + 2.0), 0.025);
  }
}

TEST(Airframe, DischargesItsBatteryByThrust) {
  AirframeParameters p = still_air();
  p.battery_endurance_s = 100.0;
  p.battery_start_share = 0.5;
  Airframe body(p, 1, kPlace, 0.0);
  EXPECT_EQ(body.battery_share(), 0.5);
  EXPECT_NEAR(body.battery_v(), 10.5 + 0.5 * 2.1, 1e-12);
  run(body, 1.0, {0.0, 0.0, -kGravityMps2});
  const double before = body.battery_share();
  run(body, 5.0, {0.0, 0.0, -kGravityMps2});  // a thrust of twice the weight
  EXPECT_NEAR(before - body.battery_share(), 0.1, 1e-4);
  EXPECT_NEAR(body.battery_v(), 10.5 + 2.1 * body.battery_share() - 2.0 * 0.8, 1e-4);
  body.set_battery_share(0.001);
  run(body, 1.0, {0.0, 0.0, -kGravityMps2});
  EXPECT_EQ(body.battery_share(), 0.0);
  const Eigen::Vector3d before_mps = body.velocity_mps();
  body.push({0.1, -0.2, 0.3});
  EXPECT_EQ(body.velocity_mps(), before_mps + Eigen::Vector3d(0.1, -0.2, 0.3));
}

// --- pose estimate

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr Duration kMs{1'000};
const Eigen::Vector3d kHere(3.0, -2.0, -1.0);

/// Pose estimator of a vehicle that is stationary at kHere. The test supplies the poses.
struct Belief {
  explicit Belief(const PoseEstimatorTraits& traits, double loss_s = 1.0) : estimator(traits) {
    estimator.set_loss(loss_s);
    estimator.move(now, kHere, 0.0);
  }
  void wait(int ms) {
    for (int k = 0; k < ms; ++k) {
      now += kMs;
      estimator.move(now, kHere, 1e-3);
    }
  }
  void see(const Eigen::Vector3d& off_m = Eigen::Vector3d::Zero(), std::uint8_t resets = 0) {
    estimator.fuse(now, now, kHere + off_m, resets);
  }
  /// Sends a pose every 10 ms for `ms` milliseconds.
  void watch(int ms, const Eigen::Vector3d& off_m = Eigen::Vector3d::Zero(),
             std::uint8_t resets = 0) {
    for (int k = 0; k < ms; k += 10) {
      wait(10);
      see(off_m, resets);
    }
  }
  [[nodiscard]] double off_m() const { return (estimator.position_m() - kHere).norm(); }
  PoseEstimator estimator;
  Time now = kStart;
};

PoseEstimatorTraits traits_of(double converge_s) {
  PoseEstimatorTraits out;
  out.converge_s = converge_s;
  out.wander_mps3 = 0.5;
  out.gate_m = 0.8;
  out.reset_after_s = 0.3;
  out.rejected_loss_s = 0.2;
  return out;
}

TEST(PoseEstimator, IsReadyAfterContinuousPosesAndLostWithoutThem) {
  Belief belief(traits_of(0.5));
  EXPECT_FALSE(belief.estimator.is_ready(belief.now));
  EXPECT_FALSE(belief.estimator.is_lost(belief.now));
  belief.watch(400);
  EXPECT_FALSE(belief.estimator.is_ready(belief.now));
  belief.wait(201);  // a gap restarts the timer
  belief.watch(500);
  EXPECT_FALSE(belief.estimator.is_ready(belief.now));
  belief.watch(10);
  EXPECT_TRUE(belief.estimator.is_ready(belief.now));
  EXPECT_EQ(belief.estimator.poses(), 91);
  belief.wait(1000);
  EXPECT_TRUE(belief.estimator.is_ready(belief.now));
  EXPECT_FALSE(belief.estimator.is_lost(belief.now));
  belief.wait(1);
  EXPECT_FALSE(belief.estimator.is_ready(belief.now));
  EXPECT_TRUE(belief.estimator.is_lost(belief.now));
  belief.see();
  EXPECT_TRUE(belief.estimator.is_ready(belief.now)) << "the estimator remains ready";
  EXPECT_TRUE(belief.estimator.is_fed(belief.now + 100 * kMs, 0.1));
  EXPECT_FALSE(belief.estimator.is_fed(belief.now + 101 * kMs, 0.1));
}

TEST(PoseEstimator, IgnoresGapsBelowAFifthOfASecond) {
  Belief belief(traits_of(0.5));
  belief.see();
  for (int k = 0; k < 2; ++k) {
    belief.wait(200);
    belief.see();
  }
  belief.wait(100);
  belief.see();
  EXPECT_TRUE(belief.estimator.is_ready(belief.now));
}

// At a time t without poses the estimate drifts along x with the velocity wander · t²; the position
// error is then wander · t³/3.
TEST(PoseEstimator, DriftsQuadraticallyWithoutPoses) {
  Belief belief(traits_of(0.0));
  belief.see();
  EXPECT_EQ(belief.estimator.drift_mps(), Eigen::Vector3d::Zero());
  belief.wait(600);
  EXPECT_NEAR(belief.estimator.drift_mps().x(), 0.5 * 0.36, 1e-9);
  EXPECT_EQ(belief.estimator.drift_mps().y(), 0.0);
  const Eigen::Vector3d off_m = belief.estimator.position_m() - kHere;
  EXPECT_NEAR(off_m.x(), 0.5 * 0.216 / 3.0, 2e-4);
  EXPECT_NEAR(off_m.tail<2>().norm(), 0.0, 1e-12);
}

// Each pose corrects three tenths of the error. The first pose, a pose after a gap, and a pose with
// a new reset counter correct the complete error.
TEST(PoseEstimator, CorrectsThirtyPercentPerPoseAndAllAfterReset) {
  PoseEstimatorTraits traits = traits_of(0.0);
  traits.wander_mps3 = 0.0;
  Belief belief(traits);
  const Eigen::Vector3d jump_m(0.3, -0.2, 0.1);
  belief.see();
  EXPECT_EQ(belief.off_m(), 0.0);
  double left = 1.0;
  for (int k = 0; k < 5; ++k) {
    belief.wait(10);
    belief.see(jump_m);
    left *= 0.7;
    EXPECT_LT((belief.estimator.position_m() - kHere - (1.0 - left) * jump_m).norm(), 1e-12);
  }
  belief.see(-jump_m, 1);
  EXPECT_LT((belief.estimator.position_m() - kHere + jump_m).norm(), 1e-12)
      << "a reset corrects the complete error";
  belief.see(jump_m, 1);
  EXPECT_NEAR(belief.off_m(), 0.4 * jump_m.norm(), 1e-12) << "a reset counts once";
  belief.wait(201);
  belief.see(jump_m, 1);
  EXPECT_LT((belief.estimator.position_m() - kHere - jump_m).norm(), 1e-12)
      << "after a gap the complete error is corrected";
  // A pose with a new reset counter is accepted at any distance.
  belief.wait(10);
  belief.see({5.0, 0.0, 0.0}, 2);
  EXPECT_NEAR(belief.off_m(), 5.0, 1e-12);
}

TEST(PoseEstimator, RefusesFarPosesUntilTimeout) {
  const Eigen::Vector3d far_m(0.0, 0.81, 0.0);
  Belief belief(traits_of(0.0));
  belief.see();
  belief.watch(100, {0.0, 0.0, 0.79});
  EXPECT_GT(belief.off_m(), 0.7) << "a pose at this distance is accepted";
  belief.watch(200);
  EXPECT_LT(belief.off_m(), 0.01);
  belief.watch(200, far_m);
  EXPECT_LT(belief.off_m(), 0.01);
  EXPECT_TRUE(belief.estimator.is_ready(belief.now));
  belief.watch(20, far_m);
  EXPECT_TRUE(belief.estimator.is_lost(belief.now)) << "poses are refused for more than 0.2 s";
  belief.watch(80, far_m);
  EXPECT_LT(belief.off_m(), 0.01);
  belief.watch(10, far_m);
  EXPECT_NEAR(belief.off_m(), 0.81, 1e-9) << "0.3 s after the first pose";
  EXPECT_TRUE(belief.estimator.is_ready(belief.now));
  // A good pose between the bad ones restarts the timer.
  belief.watch(250, Eigen::Vector3d::Zero());
  belief.watch(10, far_m);
  belief.watch(250, Eigen::Vector3d::Zero());
  EXPECT_NEAR(belief.off_m(), 0.81, 1e-9);
}

TEST(PoseEstimator, IgnoresAPoseBeforeTheFirstStep) {
  PoseEstimator estimator(traits_of(0.0));
  estimator.fuse(kStart, kStart, kHere, 0);
  EXPECT_EQ(estimator.poses(), 0);
  EXPECT_FALSE(estimator.is_fed(kStart, 1.0));
}

// A pose older than a second is compared with the oldest stored position.
TEST(PoseEstimator, StoresOneSecondOfPositions) {
  PoseEstimatorTraits traits = traits_of(0.0);
  traits.wander_mps3 = 0.0;
  PoseEstimator estimator(traits);
  const auto place = [](int ms) { return Eigen::Vector3d(1e-3 * ms, 0.0, 0.0); };
  for (int ms = 0; ms <= 3000; ms += 10) {
    estimator.move(kStart + ms * kMs, place(ms), 0.01);
  }
  for (const auto& [capture_ms, at_ms] :
       std::map<int, int>{{1000, 2000}, {2000, 2000}, {2005, 2010}, {2500, 2500}, {9000, 3000}}) {
    PoseEstimator fresh = estimator;
    fresh.fuse(kStart + 3000 * kMs, kStart + capture_ms * kMs, Eigen::Vector3d::Zero(), 0);
    EXPECT_NEAR(fresh.position_m().x(), 3.0 - 1e-3 * at_ms, 1e-9) << capture_ms;
  }
}

// --- parameters

AutopilotSettings settings_with(AutopilotDialect dialect,
                                const std::map<std::string, double>& values) {
  return settings_of(dialect, [&](const std::string& name) {
    const auto found = values.find(name);
    return found == values.end() ? std::nullopt : std::optional(found->second);
  });
}

// The defaults of the firmwares according to their parameter documentation.
TEST(AutopilotSettings, UseFirmwareDefaultsWithoutParameters) {
  const AutopilotSettings px4 = settings_with(AutopilotDialect::kPx4, {});
  EXPECT_EQ(px4.setpoint_loss_s, 1.0);
  EXPECT_FALSE(px4.lands_on_setpoint_loss);
  EXPECT_EQ(px4.heartbeat_loss_s, std::nullopt);
  EXPECT_EQ(px4.station_id, std::nullopt);
  EXPECT_NEAR(px4.pose_loss_s, 5.0 - 0.4, 1e-12);
  EXPECT_TRUE(px4.lands_on_pose_loss);
  EXPECT_TRUE(px4.has_barometer);
  EXPECT_EQ(px4.idle_disarm_s, 11.0);
  EXPECT_EQ(px4.land_disarm_s, 2.0);
  EXPECT_EQ(px4.speed_max_mps, 12.0);
  EXPECT_EQ(px4.land_speed_mps, 0.7);
  EXPECT_EQ(px4.position_gain_per_s, 0.95);
  EXPECT_NEAR(px4.yaw_rate_max_radps, 200.0 * kPi / 180.0, 1e-12);
  EXPECT_EQ(px4.velocity_gain_per_s, 1.8);
  const AutopilotSettings ardupilot = settings_with(AutopilotDialect::kArdupilot, {});
  EXPECT_EQ(ardupilot.setpoint_loss_s, 3.0);
  EXPECT_FALSE(ardupilot.lands_on_setpoint_loss);
  EXPECT_TRUE(ardupilot.has_barometer);
  EXPECT_EQ(ardupilot.position_gain_per_s, 1.0);  // parameter PSC_POSXY_P
  EXPECT_EQ(ardupilot.velocity_gain_per_s, 2.0);  // parameter PSC_VELXY_P
  EXPECT_EQ(ardupilot.heartbeat_loss_s, std::nullopt);
  EXPECT_EQ(ardupilot.station_id, 255);
  EXPECT_EQ(ardupilot.pose_loss_s, 7.0);
  EXPECT_TRUE(ardupilot.lands_on_pose_loss);
  EXPECT_EQ(ardupilot.idle_disarm_s, 10.0);
  EXPECT_EQ(ardupilot.land_disarm_s, 0.45);
  EXPECT_NEAR(ardupilot.speed_max_mps, 5.0, 1e-12);
  EXPECT_NEAR(ardupilot.land_speed_mps, 0.5, 1e-12);
  EXPECT_NEAR(ardupilot.yaw_rate_max_radps, 60.0 * kPi / 180.0, 1e-12);
}

TEST(AutopilotSettings, ConvertParametersAndUnits) {
  const auto px4 = [](const std::string& name, double value) {
    return settings_with(AutopilotDialect::kPx4, {{name, value}});
  };
  EXPECT_EQ(px4("COM_OF_LOSS_T", 0.3).setpoint_loss_s, 0.3);
  EXPECT_TRUE(px4("COM_OBL_RC_ACT", 4.0).lands_on_setpoint_loss);
  EXPECT_FALSE(px4("COM_OBL_RC_ACT", 3.0).lands_on_setpoint_loss);
  EXPECT_FALSE(px4("COM_OBL_RC_ACT", 5.0).lands_on_setpoint_loss);
  EXPECT_EQ(px4("NAV_DLL_ACT", 3.0).heartbeat_loss_s, 10.0);
  EXPECT_EQ(px4("NAV_DLL_ACT", 2.0).heartbeat_loss_s, std::nullopt);
  EXPECT_EQ(settings_with(AutopilotDialect::kPx4, {{"NAV_DLL_ACT", 3.0}, {"COM_DL_LOSS_T", 4.0}})
                .heartbeat_loss_s,
            4.0);
  EXPECT_NEAR(px4("EKF2_NOAID_TOUT", 2e6).pose_loss_s, 1.6, 1e-12);
  EXPECT_FALSE(px4("EKF2_BARO_CTRL", 0.0).has_barometer);
  EXPECT_EQ(px4("COM_DISARM_PRFLT", 5.0).idle_disarm_s, 6.0);
  EXPECT_EQ(px4("COM_DISARM_PRFLT", 0.0).idle_disarm_s, std::nullopt);
  EXPECT_EQ(px4("COM_DISARM_PRFLT", -1.0).idle_disarm_s, std::nullopt);
  EXPECT_EQ(px4("COM_DISARM_LAND", 3.0).land_disarm_s, 3.0);
  EXPECT_EQ(px4("COM_DISARM_LAND", 0.0).land_disarm_s, std::nullopt);
  EXPECT_EQ(px4("MPC_XY_VEL_MAX", 2.0).speed_max_mps, 2.0);
  EXPECT_EQ(px4("MPC_LAND_SPEED", 0.4).land_speed_mps, 0.4);
  EXPECT_EQ(px4("MPC_XY_P", 1.5).position_gain_per_s, 1.5);
  EXPECT_NEAR(px4("MC_YAWRATE_MAX", 90.0).yaw_rate_max_radps, kPi / 2, 1e-12);
  EXPECT_EQ(px4("MPC_XY_VEL_P_ACC", 2.5).velocity_gain_per_s, 2.5);
  const auto ardupilot = [](const std::string& name, double value) {
    return settings_with(AutopilotDialect::kArdupilot, {{name, value}});
  };
  EXPECT_EQ(ardupilot("GUID_TIMEOUT", 1.5).setpoint_loss_s, 1.5);
  EXPECT_EQ(ardupilot("FS_GCS_ENABLE", 5.0).heartbeat_loss_s, 5.0);
  EXPECT_EQ(ardupilot("FS_GCS_ENABLE", 1.0).heartbeat_loss_s, std::nullopt);
  EXPECT_EQ(
      settings_with(AutopilotDialect::kArdupilot, {{"FS_GCS_ENABLE", 5.0}, {"FS_GCS_TIMEOUT", 2.0}})
          .heartbeat_loss_s,
      2.0);
  EXPECT_EQ(ardupilot("SYSID_MYGCS", 190.0).station_id, 190);
  EXPECT_FALSE(ardupilot("FS_EKF_ACTION", 2.0).lands_on_pose_loss);
  EXPECT_TRUE(ardupilot("FS_EKF_ACTION", 3.0).lands_on_pose_loss);
  EXPECT_EQ(ardupilot("DISARM_DELAY", 4.0).idle_disarm_s, 4.0);
  EXPECT_EQ(ardupilot("DISARM_DELAY", 0.0).idle_disarm_s, std::nullopt);
  EXPECT_NEAR(ardupilot("WPNAV_SPEED", 250.0).speed_max_mps, 2.5, 1e-12);
  EXPECT_NEAR(ardupilot("ATC_SLEW_YAW", 9000.0).yaw_rate_max_radps, kPi / 2, 1e-12);
  EXPECT_NEAR(ardupilot("LAND_SPEED", 30.0).land_speed_mps, 0.3, 1e-12);
}

// Autopilots, modes and estimator flags have the numbers of the MAVLink documentation.
TEST(AutopilotProfile, UsesMavlinkNumbers) {
  const AutopilotProfile& px4 = profile_of(AutopilotDialect::kPx4);
  EXPECT_EQ(px4.autopilot_id, 12);
  EXPECT_EQ(px4.follow_mode, 0x00060000U);  // main mode 6: offboard
  EXPECT_EQ(px4.land_mode, 0x06040000U);    // main mode 4: auto, sub mode 6: land
  EXPECT_EQ(px4.start_mode, 0x03040000U);   // sub mode 3: loiter
  EXPECT_EQ(px4.refusal, 1);
  const AutopilotProfile& ardupilot = profile_of(AutopilotDialect::kArdupilot);
  EXPECT_EQ(ardupilot.autopilot_id, 3);
  EXPECT_EQ(ardupilot.follow_mode, 4U);  // mode 4: guided
  EXPECT_EQ(ardupilot.land_mode, 9U);
  EXPECT_EQ(ardupilot.start_mode, 0U);  // mode 0: stabilize
  EXPECT_EQ(ardupilot.refusal, 4);
  // Without poses, attitude and vertical velocity are valid, but positions are not.
  constexpr std::uint16_t kPositions = 0x8 | 0x10 | 0x100 | 0x200;
  for (const AutopilotProfile* profile : {&px4, &ardupilot}) {
    EXPECT_EQ(profile->flags_lost & kPositions, 0);
    EXPECT_EQ(profile->flags_lost & 0x1, 0x1);
    EXPECT_NE(profile->flags_air & kPositions, 0);
  }
}

}  // namespace
}  // namespace vantage::sim
