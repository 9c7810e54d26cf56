#include "drivers/vehicle/body_tracker.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr Duration kFrame{10'000};

models::MocapFrame frame_at(Time time, const Pose3& pose, std::int64_t run = 1) {
  models::MocapFrame frame;
  frame.stamp = {time, run, 0};
  frame.bodies.resize(2);
  frame.bodies[0].name = "Q2";
  frame.bodies[1].name = "Q1";
  frame.bodies[1].world_from_body = pose;
  return frame;
}

Pose3 at(double x_m, double y_m) { return lift({x_m, y_m, 0.0}, 1.0); }

TEST(BodyTracker, FindsTheVelocityOfASteadyFlightInNoise) {
  BodyTracker tracker("Q1", 2.0);
  test::Random random(3);
  double squares = 0.0;
  double promised = 0.0;
  for (int i = 0; i < 1000; ++i) {
    Pose3 pose = at(0.8 * 0.01 * i, -0.3 * 0.01 * i);
    pose.translation_m +=
        0.001 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    const Time time = kStart + i * kFrame;
    ASSERT_EQ(tracker.update(frame_at(time, pose), time, time, false), BodyVerdict::kTaken);
    if (i >= 100) {
      squares +=
          (tracker.state()->velocity_world_mps - Eigen::Vector3d(0.8, -0.3, 0.0)).squaredNorm();
      promised += 3.0 * std::pow(tracker.state()->velocity_sigma_mps, 2);
    }
  }
  EXPECT_LT(std::sqrt(squares / 2700.0), 0.06);
  EXPECT_LT(squares, promised) << "the stated accuracy is too high";
}

TEST(BodyTracker, RefusesInvalidPoses) {
  BodyTracker tracker("Q1", 2.0);
  Pose3 bad = at(0, 0);
  bad.translation_m.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(tracker.update(frame_at(kStart, bad), kStart, kStart, true), BodyVerdict::kImpossible);
  bad = at(0, 0);
  bad.rotation.coeffs().setZero();
  EXPECT_EQ(tracker.update(frame_at(kStart, bad), kStart, kStart, true), BodyVerdict::kImpossible);
  models::MocapFrame hidden = frame_at(kStart, at(0, 0));
  hidden.bodies[1].occluded = true;
  EXPECT_EQ(tracker.update(hidden, kStart, kStart, true), BodyVerdict::kUnseen);
  hidden.bodies.resize(1);
  EXPECT_EQ(tracker.update(hidden, kStart, kStart, true), BodyVerdict::kUnseen);
  EXPECT_FALSE(tracker.state().has_value());
  EXPECT_EQ(tracker.update(frame_at(kStart, at(0, 0)), kStart, kStart, true), BodyVerdict::kTaken);
  EXPECT_EQ(tracker.update(frame_at(kStart, at(0, 0)), kStart, kStart, true),
            BodyVerdict::kOutOfOrder);
}

TEST(BodyTracker, RefusesAJumpInTheAir) {
  BodyTracker tracker("Q1", 2.0);
  tracker.update(frame_at(kStart, at(0, 0)), kStart, kStart, false);
  for (int i = 1; i < 20; ++i) {
    const Time time = kStart + i * kFrame;
    EXPECT_EQ(tracker.update(frame_at(time, at(1, 0)), time, time, false), BodyVerdict::kJumped);
  }
  const Time time = kStart + 20 * kFrame;
  EXPECT_EQ(tracker.update(frame_at(time, at(0.1, 0)), time, time, false), BodyVerdict::kTaken);
  EXPECT_EQ(tracker.state()->resets, 0);
  Pose3 flipped = at(0.1, 0);
  flipped.rotation = Eigen::Quaterniond(0, 0, 0, 1);
  EXPECT_EQ(tracker.update(frame_at(time + kFrame, flipped), time + kFrame, time + kFrame, false),
            BodyVerdict::kJumped);
}

// Regression, seen in a flight: the vehicle moved while the mocap driver restarted, so all poses
// after the restart were refused. Five seconds later the autopilot had no position estimate.
TEST(BodyTracker, ContinuesAfterAMocapRestartInFlight) {
  for (const Duration other_clock : {Duration{}, Duration{std::chrono::hours(-3)}}) {
    BodyTracker tracker("Q1", 1.0);
    Time now = kStart;
    const auto see = [&](std::int64_t run, Duration clock) {
      const double x_m = to_seconds(now - kStart);  // m; position after motion at 1 m/s
      return tracker.update(frame_at(now + clock, at(x_m, 0.0), run), now + clock, now, false);
    };
    for (int i = 0; i < 50; ++i, now += kFrame) {
      ASSERT_EQ(see(1, Duration{}), BodyVerdict::kTaken);
    }
    now += std::chrono::milliseconds(700);
    for (int i = 0; i < 10; ++i, now += kFrame) {
      ASSERT_EQ(see(2, other_clock), BodyVerdict::kTaken) << i;
    }
    EXPECT_EQ(tracker.state()->resets, 0) << "the body moved there";
    // A sudden change of the position counts as a jump.
    EXPECT_EQ(tracker.update(frame_at(now, at(-2.0, 0.0), 3), now, now, false),
              BodyVerdict::kJumped);
  }
}

TEST(BodyTracker, AcceptsACarriedBodyOnTheGround) {
  BodyTracker tracker("Q1", 2.0);
  tracker.update(frame_at(kStart, at(0, 0)), kStart, kStart, true);
  int refused = 0;
  Time time = kStart;
  do {
    time += kFrame;
  } while (tracker.update(frame_at(time, at(3, 0)), time, time, true) == BodyVerdict::kJumped &&
           ++refused < 200);
  EXPECT_NEAR(refused, 50, 2) << "half a second of frames";
  EXPECT_EQ(tracker.state()->resets, 1);
  EXPECT_EQ(tracker.state()->world_from_body.translation_m.x(), 3.0);
}

TEST(BodyTracker, RefusesIdenticalPosesInTheAir) {
  BodyTracker tracker("Q1", 2.0);
  BodyVerdict verdict = BodyVerdict::kTaken;
  int taken = 0;
  for (int i = 0; i < 100 && verdict == BodyVerdict::kTaken; ++i, ++taken) {
    const Time time = kStart + i * kFrame;
    verdict = tracker.update(frame_at(time, at(0, 0)), time, time, false);
  }
  EXPECT_EQ(verdict, BodyVerdict::kRepeated);
  EXPECT_NEAR(taken, 52, 2);
  const Time time = kStart + 100 * kFrame;
  EXPECT_EQ(tracker.update(frame_at(time, at(0, 0)), time, time, true), BodyVerdict::kTaken);
}

TEST(BodyTracker, MeasuresThePoseAgeFromItsArrival) {
  BodyTracker tracker("Q1", 2.0);
  EXPECT_FALSE(tracker.age(kStart).has_value());
  const Time captured = kStart - Duration{50'000};
  tracker.update(frame_at(captured, at(0, 0)), captured, kStart, false);
  EXPECT_EQ(tracker.age(kStart + Duration{30'000}), Duration{30'000});
}

}  // namespace
}  // namespace vantage::drivers
