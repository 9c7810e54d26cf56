#include "drivers/safety/pose_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/inputs.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/bisect.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kFrameS = 0.01;
constexpr BodyContext kOnGround{};
constexpr BodyContext kHovers{true, false, false, 0.0};
constexpr BodyContext kFlies{true, true, false, 0.0};

class Poses : public testing::Test {
 protected:
  PoseVerdict see(const Eigen::Vector3d& p_m, double at_s, const BodyContext& context = kHovers,
                  double yaw_rad = 0.0) {
    const models::MocapBody body{"Q1", lift({p_m.x(), p_m.y(), yaw_rad}, p_m.z()), false};
    return monitor.judge(&body, context, limits, kStart + from_seconds(at_s));
  }
  /// Resets the monitor and shows the body at rest at `p_m` until time 0.
  void stand(const Eigen::Vector3d& p_m) {
    monitor = {};
    EXPECT_EQ(see(p_m, -kFrameS), PoseVerdict::kAccepted);
    EXPECT_EQ(see(p_m, 0.0), PoseVerdict::kAccepted);
  }

  SafetyLimits limits = limits_for(test::FlightBench::scenario(), "Q1");  // 8 × 4.4 m, 3 m high
  PoseMonitor monitor;
};

// The accepted volume extends 1 m beyond fence and ceiling, and 0.3 m below the floor.
TEST_F(Poses, BeginOnlyInsideTheVolume) {
  const Eigen::Vector3d middle_m(0.5, -0.4, 1.0);
  const double ends_m[3][2] = {{-5.0, 5.0}, {-3.2, 3.2}, {-0.3, 4.0}};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double end_m : ends_m[axis]) {
      const double last_m = test::last_accepted(middle_m(axis), 2.0 * end_m, 1e-9, [&](double m) {
        monitor = {};
        Eigen::Vector3d p_m = middle_m;
        p_m(axis) = m;
        return see(p_m, 0.0, kOnGround) == PoseVerdict::kAccepted;
      });
      EXPECT_NEAR(last_m, end_m, 1e-8) << axis;
    }
  }
  EXPECT_EQ(see({0.0, 9.0, 1.0}, 1.0, kOnGround), PoseVerdict::kOutside);
  EXPECT_EQ(see({0.0, 9.0, 1.0}, 2.0), PoseVerdict::kOutside)
      << "a jump to the outside is refused in the air, too";
}

// In the air, the pose gate allows for an unknown acceleration of 10 m/s² during the gap. The gate
// stays smaller than half of the separation.
TEST_F(Poses, GateGrowsWithTheGap) {
  const Eigen::Vector3d here_m(0.5, -0.4, 1.0);
  for (const double gap_s : {0.01, 0.1, 0.2, 0.3, 1.0}) {
    const double gate_m = std::min(limits.pose_gate_max_m, 0.25 + 5.0 * gap_s * gap_s);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {1.0, -1.0}) {
        const double last_m = test::last_accepted(0.001, 2.0, 1e-9, [&](double m) {
          stand(here_m);
          return see(here_m + side * m * Eigen::Vector3d::Unit(axis), gap_s) ==
                 PoseVerdict::kAccepted;
        });
        EXPECT_NEAR(last_m, gate_m, 1e-8) << gap_s << " " << axis << " " << side;
      }
    }
    const double turn_rad = 1.0 + std::min(10.0 * gap_s, 0.5 * (kPi - 1.0));
    for (const double side : {1.0, -1.0}) {
      const double last_rad = test::last_accepted(0.001, kPi, 1e-9, [&](double rad) {
        stand(here_m);
        return see(here_m, gap_s, kHovers, side * rad) == PoseVerdict::kAccepted;
      });
      EXPECT_NEAR(last_rad, turn_rad, 1e-7) << gap_s << " " << side;
    }
  }
  // A possible descent during the gap widens the gate downwards only.
  for (const double z_m : {-0.4, 0.4}) {
    stand(here_m);
    const BodyContext sinks{true, false, false, 0.3};
    EXPECT_EQ(see(here_m + Eigen::Vector3d(0.0, 0.0, z_m), kFrameS, sinks),
              z_m < 0.0 ? PoseVerdict::kAccepted : PoseVerdict::kJump);
  }
}

// A descent commanded during the gap widens the gate downwards only.
TEST_F(Poses, AllowACommandedDescentWhileUnseen) {
  const Eigen::Vector3d here_m(0.5, -0.4, 2.0);
  const double gap_s = 0.1;
  const double gate_m = std::min(limits.pose_gate_max_m, 0.25 + 5.0 * gap_s * gap_s);
  for (const double sunk_m : {0.0, 0.1, 0.7}) {
    BodyContext context = kHovers;
    context.sunk_m = sunk_m;
    for (const auto& [way, room_m] : {std::pair(Eigen::Vector3d(0.0, 0.0, -1.0), gate_m + sunk_m),
                                      std::pair(Eigen::Vector3d(0.0, 0.0, 1.0), gate_m),
                                      std::pair(Eigen::Vector3d(-1.0, 0.0, 0.0), gate_m)}) {
      const double last_m = test::last_accepted(0.001, 1.9, 1e-9, [&, &way = way](double m) {
        stand(here_m);
        return see(here_m + m * way, gap_s, context) == PoseVerdict::kAccepted;
      });
      EXPECT_NEAR(last_m, room_m, 1e-8) << sunk_m << " along " << way.transpose();
    }
  }
}

// On the ground the body may be carried. A jump then restarts the track at rest, with a count of
// one accepted pose. Tested twice.
TEST_F(Poses, StartANewTrackAtRestAfterCarrying) {
  double t_s = 0.0;
  Eigen::Vector3d p_m(0.0, -1.0, 0.0);
  for (const double to_m : {2.0, -2.0}) {
    for (int i = 0; i < 50; ++i) {
      t_s += kFrameS;
      p_m.x() += 0.5 * kFrameS;
      EXPECT_EQ(see(p_m, t_s, kOnGround, 0.8 * t_s), PoseVerdict::kAccepted);
    }
    EXPECT_NEAR(monitor.velocity_world_mps().x(), 0.5, 1e-3);
    EXPECT_NEAR(monitor.turn_radps(), 0.8, 1e-3);
    EXPECT_GE(monitor.accepted_in_row(), 50);
    t_s += kFrameS;
    p_m.x() = to_m;
    EXPECT_EQ(see(p_m, t_s, kOnGround, 0.8 * t_s), PoseVerdict::kAccepted);
    EXPECT_EQ(monitor.velocity_world_mps(), Eigen::Vector3d::Zero());
    EXPECT_EQ(monitor.turn_radps(), 0.0);
    EXPECT_EQ(monitor.accepted_in_row(), 1);
    EXPECT_EQ(monitor.predict_m(kStart + from_seconds(t_s + 1.0), 9.0), p_m);
  }
}

// The filtered velocity responds to a step with 1 − e^(−t / 50 ms) in either direction. A velocity
// change that needs more than 10 m/s² is limited.
TEST_F(Poses, FilterVelocityAndTurnRateWithATimeConstantOf50Ms) {
  for (const double side : {1.0, -1.0}) {
    stand({0.0, -1.0, 1.0});
    for (int i = 1; i <= 30; ++i) {
      const double t_s = kFrameS * i;
      EXPECT_EQ(see({0.3 * side * t_s, -1.0, 1.0}, t_s, kFlies, 0.7 * side * t_s),
                PoseVerdict::kAccepted);
      const double known = 1.0 - std::exp(-t_s / 0.05);
      EXPECT_NEAR(monitor.velocity_world_mps().x(), 0.3 * side * known, 1e-9);
      EXPECT_NEAR(monitor.turn_radps(), 0.7 * side * known, 1e-9);
    }
    const Time later = kStart + from_seconds(0.3 + 0.1);
    const double ahead_m = monitor.predict_m(later, 0.05).x() - 0.3 * side * 0.3;
    EXPECT_NEAR(ahead_m, 0.05 * monitor.velocity_world_mps().x(), 1e-9)
        << "the extrapolation is limited";
    stand({0.0, -1.0, 1.0});
    EXPECT_EQ(see({0.0, -1.0 + 0.2 * side, 1.0}, kFrameS, kFlies), PoseVerdict::kAccepted);
    EXPECT_NEAR(monitor.velocity_world_mps().y(), 10.0 * kFrameS * side, 1e-9);
  }
}

// Identical poses are accepted for the time limit; afterwards the pose age counts from the first of
// them.
TEST_F(Poses, CountAsStuckAfterTheTimeLimit) {
  const Eigen::Vector3d here_m(0.0, -1.0, 1.0);
  for (const BodyContext& context : {kFlies, kHovers}) {
    const double allowed_s =
        context.is_moving ? limits.pose_stuck_moving_s : limits.pose_stuck_hover_s;
    stand(here_m);  // first seen at -10 ms
    double t_s = 0.0;
    while (see(here_m, t_s += kFrameS, context) == PoseVerdict::kAccepted && t_s < 2.0) {
    }
    EXPECT_NEAR(t_s + kFrameS, allowed_s, 1.01 * kFrameS);
    EXPECT_NEAR(monitor.age_s(kStart + from_seconds(t_s)), t_s + kFrameS, 1e-6);
    EXPECT_EQ(monitor.accepted_in_row(), 0);
    EXPECT_EQ(see(here_m + Eigen::Vector3d(0.001, 0.0, 0.0), t_s + kFrameS, context),
              PoseVerdict::kAccepted);
  }
  stand(here_m);
  for (double t_s = kFrameS; t_s < 3.0; t_s += kFrameS) {
    EXPECT_EQ(see(here_m, t_s, kOnGround), PoseVerdict::kAccepted)
        << "on the ground the body may be stationary";
  }
}

TEST_F(Poses, AreCountedConsecutively) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d here_m(0.0, -1.0, 1.0);
  stand(here_m);
  double t_s = 0.0;
  for (int time = 0; time < 2; ++time) {
    for (int i = 1; i <= 3; ++i) {
      EXPECT_EQ(see({0.0, nan, 1.0}, t_s += kFrameS), PoseVerdict::kMalformed);
      EXPECT_EQ(monitor.rejected_in_row(), i);
      EXPECT_EQ(monitor.accepted_in_row(), 0);
    }
    EXPECT_EQ(monitor.world_from_body().translation_m, here_m);
    EXPECT_EQ(see(here_m, t_s += kFrameS), PoseVerdict::kAccepted);
    EXPECT_EQ(monitor.rejected_in_row(), 0);
    EXPECT_EQ(monitor.accepted_in_row(), 1);
    const Time now = kStart + from_seconds(t_s + kFrameS);
    EXPECT_EQ(monitor.judge(nullptr, kHovers, limits, now), PoseVerdict::kAbsent);
    EXPECT_EQ(monitor.rejected_in_row(), 0) << "an unseen body is not a rejected pose";
    EXPECT_EQ(monitor.accepted_in_row(), 0);
  }
}

TEST_F(Poses, AreCountedFromTheFirstAcceptedOne) {
  const Eigen::Vector3d here_m(0.5, -0.4, 1.0);
  EXPECT_EQ(monitor.accepted_in_row(), 0);
  for (int n = 1; n <= 3; ++n) {
    EXPECT_EQ(see(here_m, kFrameS * n), PoseVerdict::kAccepted);
    EXPECT_EQ(monitor.accepted_in_row(), n);
  }
  EXPECT_EQ(see(here_m + Eigen::Vector3d(2.0, 0.0, 0.0), 4 * kFrameS), PoseVerdict::kJump);
  EXPECT_EQ(monitor.accepted_in_row(), 0);
  EXPECT_EQ(see(here_m, 5 * kFrameS), PoseVerdict::kAccepted);
  EXPECT_EQ(monitor.accepted_in_row(), 1);
}

// The length of a quaternion may differ from 1 by up to 1 %.
TEST_F(Poses, NeedUnitQuaternionsToOnePercent) {
  const auto accepts = [&](double length) {
    monitor = {};
    models::MocapBody body{"Q1", lift({0.5, -0.4, 0.7}, 1.0), false};
    body.world_from_body.rotation.coeffs() *= length;
    return monitor.judge(&body, kHovers, limits, kStart) == PoseVerdict::kAccepted;
  };
  EXPECT_NEAR(test::last_accepted(1.0, 2.0, 1e-9, accepts), 1.01, 1e-8);
  EXPECT_NEAR(test::last_accepted(1.0, 0.0, 1e-9, accepts), 0.99, 1e-8);
}

TEST_F(Poses, MustBeFinite) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), inf, -inf}) {
    for (int i = 0; i < 7; ++i) {
      monitor = {};
      models::MocapBody body{"Q1", lift({0.5, -0.4, 0.7}, 1.0), false};
      (i < 3 ? body.world_from_body.translation_m(i)
             : body.world_from_body.rotation.coeffs()(i - 3)) = value;
      EXPECT_EQ(monitor.judge(&body, kHovers, limits, kStart), PoseVerdict::kMalformed) << i;
      EXPECT_FALSE(monitor.has_pose());
    }
  }
}

TEST_F(Poses, PredictionIsTheOriginBeforeTheFirstPose) {
  EXPECT_FALSE(monitor.has_pose());
  EXPECT_EQ(monitor.age_s(kStart), kNever);
  for (const double horizon_s : {0.0, 0.5, kNever}) {
    EXPECT_EQ(monitor.predict_m(kStart, horizon_s), Eigen::Vector3d::Zero()) << horizon_s;
  }
}

// In the air, a continuous path out of the room and back is accepted. On the ground, or for a first
// pose, it is refused.
TEST_F(Poses, OutsideTheVolumeNeedAContinuousFlight) {
  const double beyond_m = 4.0 + limits.volume_margin_m;
  for (const BodyContext& context : {kFlies, kHovers, kOnGround}) {
    monitor = {};
    for (int i = 0; i <= 800; ++i) {
      const double t_s = kFrameS * i;
      const double x_m = 3.5 + (t_s < 4.0 ? t_s : 8.0 - t_s);
      const bool is_believed = context.in_air || x_m < beyond_m;
      EXPECT_EQ(see({x_m, 0.3, 1.0}, t_s, context),
                is_believed ? PoseVerdict::kAccepted : PoseVerdict::kOutside)
          << x_m;
    }
    monitor = {};
    EXPECT_EQ(see({beyond_m + 0.1, 0.3, 1.0}, 0.0, context), PoseVerdict::kOutside);
    EXPECT_FALSE(monitor.has_pose()) << "a track cannot begin outside";
  }
}

TEST_F(Poses, AreRefusedWhileDistrusted) {
  const Eigen::Vector3d here_m(0.5, -0.4, 1.0);
  stand(here_m);
  BodyContext context = kHovers;
  context.is_distrusted = true;
  EXPECT_EQ(see(here_m, kFrameS, context), PoseVerdict::kForeign);
  EXPECT_EQ(monitor.rejected_in_row(), 1);
  EXPECT_EQ(see(here_m, 2 * kFrameS), PoseVerdict::kAccepted);
}

// A jump and a flip each have their own verdict, also outside the room. A pose with both counts as
// a jump.
TEST_F(Poses, JumpsAndFlipsHaveSeparateVerdictsInTheAir) {
  const Eigen::Vector3d here_m(0.5, -0.4, 1.0);
  const Eigen::Vector3d there_m = here_m + Eigen::Vector3d(1.0, 0.0, 0.0);
  stand(here_m);
  EXPECT_EQ(see(there_m, kFrameS), PoseVerdict::kJump);
  EXPECT_EQ(see(here_m, kFrameS, kHovers, 2.0), PoseVerdict::kFlip);
  EXPECT_EQ(see(there_m, kFrameS, kHovers, 2.0), PoseVerdict::kJump);
  EXPECT_EQ(see({9.0, 0.0, 1.0}, kFrameS), PoseVerdict::kOutside);
  EXPECT_EQ(monitor.rejected_in_row(), 4);
  EXPECT_EQ(see(here_m, kFrameS), PoseVerdict::kAccepted);
}

// The position of an unseen vehicle is extrapolated for half a second. The next pose is accepted
// near the extrapolated position.
TEST_F(Poses, AreExtrapolatedWhileUnseen) {
  const Eigen::Vector3d begin_m(-2.0, -1.0, 1.0);
  for (const double gap_s : {0.1, 0.3, 0.5, 0.8}) {
    const auto accepts_at = [&](double ahead_m) {
      monitor = {};
      double t_s = 0.0;
      for (int i = 0; i <= 100; ++i) {
        t_s = kFrameS * i;
        EXPECT_EQ(see(begin_m + Eigen::Vector3d(2.0 * t_s, 0.0, 0.0), t_s, kFlies),
                  PoseVerdict::kAccepted);
      }
      EXPECT_NEAR(monitor.velocity_world_mps().x(), 2.0, 1e-6);
      return see(begin_m + Eigen::Vector3d(2.0 + ahead_m, 0.0, 0.0), t_s + gap_s, kFlies) ==
             PoseVerdict::kAccepted;
    };
    const double expected_m = 2.0 * std::min(gap_s, limits.pose_age_land_s);
    const double gate_m = std::min(limits.pose_gate_max_m, 0.25 + 5.0 * gap_s * gap_s);
    EXPECT_NEAR(test::last_accepted(expected_m, 9.0, 1e-6, accepts_at), expected_m + gate_m, 1e-5);
    EXPECT_NEAR(test::last_accepted(expected_m, -9.0, 1e-6, accepts_at), expected_m - gate_m, 1e-5);
  }
}

// When the pose of a moving vehicle repeats, the time limit counts from its first occurrence,
// regardless of the earlier flight. Afterwards the pose age counts from that occurrence. A second
// repetition has the same effect.
TEST_F(Poses, StuckTimeCountsFromTheFirstOccurrence) {
  double t_s = 0.0;
  Eigen::Vector3d p_m(-3.0, -1.0, 1.0);
  for (int time = 0; time < 2; ++time) {
    for (int i = 0; i < 200; ++i) {
      t_s += kFrameS;
      p_m.x() += 0.5 * kFrameS;
      EXPECT_EQ(see(p_m, t_s, kFlies), PoseVerdict::kAccepted) << t_s;
    }
    EXPECT_GT(monitor.velocity_world_mps().x(), 0.4);
    for (int i = 1; i <= 10; ++i) {
      const double same_s = kFrameS * i;
      const bool is_stuck = same_s > limits.pose_stuck_moving_s + 1e-6;
      EXPECT_EQ(see(p_m, t_s + same_s, kFlies),
                is_stuck ? PoseVerdict::kStuck : PoseVerdict::kAccepted)
          << i;
      if (is_stuck) {
        EXPECT_EQ(monitor.velocity_world_mps(), Eigen::Vector3d::Zero());
        EXPECT_EQ(monitor.predict_m(kStart + from_seconds(t_s + 1.0), 9.0), p_m);
        EXPECT_NEAR(monitor.age_s(kStart + from_seconds(t_s + same_s)), same_s, 2e-6);
      }
    }
    t_s += 10 * kFrameS;
  }
}

}  // namespace
}  // namespace vantage::drivers
