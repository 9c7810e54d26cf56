#include "localizer/robot_localizer.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/localizer/simulated_team.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::localizer {
namespace {

struct Options {
  int steps = 600;
  double loss = 0.0;  ///< probability that a receiver misses a message
  bool starts_known = true;
  int silent_from = -1;  ///< step from which robot 2 sends nothing
};

struct Outcome {
  double rmse_m = 0.0;  ///< error over all robots after 20 s
  int placed = 0;
  std::vector<Pose2> poses;
  std::vector<InputCounts> counts;
};

/// Simulates a team in which each robot computes its own pose from what it receives.
Outcome drive(const Options& options, unsigned seed) {
  test::SimulatedTeam team(4, seed);
  team.wrong_ids = 0.001;
  std::vector<RobotLocalizer> localizers;
  for (int r = 0; r < 4; ++r) {
    localizers.emplace_back(team.spec, r);
    for (int each = 0; options.starts_known && each < 4; ++each) {
      localizers.back().place(each, team.truth[static_cast<std::size_t>(each)],
                              1e-4 * Eigen::Matrix3d::Identity());
    }
    localizers.back().advance_to(team.now);
  }
  std::mt19937 rng(seed + 100);
  std::uniform_real_distribution<double> uniform;
  double squared = 0.0;
  int judged = 0;
  for (int step = 0; step < options.steps; ++step) {
    team.step();
    for (std::size_t r = 0; r < localizers.size(); ++r) {
      localizers[r].add_odometry(team.commands[r]);
      localizers[r].add_sightings(team.frames[r]);
      localizers[r].advance_to(team.now);
      if (step >= 200 && localizers[r].is_placed()) {
        squared += (localizers[r].pose().position_m() - team.truth[r].position_m()).squaredNorm();
        ++judged;
      }
    }
    for (std::size_t from = 0; step % 2 == 0 && from < localizers.size(); ++from) {
      if (from == 1 && options.silent_from >= 0 && step >= options.silent_from) {
        continue;
      }
      models::PoseEstimate message;
      localizers[from].write_message(message);
      for (std::size_t to = 0; to < localizers.size(); ++to) {
        if (to != from && uniform(rng) >= options.loss) {
          localizers[to].add_teammate(message);
        }
      }
    }
  }
  Outcome outcome;
  outcome.rmse_m = std::sqrt(squared / judged);
  for (const RobotLocalizer& localizer : localizers) {
    outcome.placed += localizer.is_placed() ? 1 : 0;
    outcome.poses.push_back(localizer.pose());
    outcome.counts.push_back(localizer.counts());
  }
  return outcome;
}

TEST(RobotLocalizer, LosesLittleAccuracyWhenMessagesAreLost) {
  double without = 0.0;
  double with = 0.0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    without += drive({}, seed).rmse_m;
    with += drive({.loss = 0.2}, seed).rmse_m;
  }
  EXPECT_LT(without / 3.0, 0.12);
  EXPECT_LT(with, 1.1 * without);
}

TEST(RobotLocalizer, MissesNoDataWhenSingleMessagesAreLost) {
  for (const InputCounts& counts : drive({.loss = 0.2}, 5).counts) {
    EXPECT_EQ(counts.missing_increments, 0);
    EXPECT_EQ(counts.lost_sightings, 0);
    EXPECT_EQ(counts.refused, 0);
  }
}

TEST(RobotLocalizer, FindsUnknownStarts) {
  const Outcome outcome = drive({.starts_known = false}, 2);
  EXPECT_EQ(outcome.placed, 4);
  EXPECT_LT(outcome.rmse_m, 0.15);
}

TEST(RobotLocalizer, ContinuesWhenTeammateFallsSilent) {
  const Outcome outcome = drive({.silent_from = 300}, 4);
  EXPECT_LT(outcome.rmse_m, 0.15);
  EXPECT_GT(outcome.counts[0].missing_increments, 0);
}

TEST(RobotLocalizer, IsDeterministic) {
  const Outcome first = drive({.steps = 100, .loss = 0.2}, 6);
  const Outcome second = drive({.steps = 100, .loss = 0.2}, 6);
  EXPECT_EQ(first.poses, second.poses);
}

TEST(RobotLocalizer, MovesBySameDistanceForIncrementsAndCommands) {
  test::SimulatedTeam team(1, 1);
  team.spec.robots[0].drive = {};
  RobotLocalizer commanded(team.spec, 0);
  RobotLocalizer measured(team.spec, 0);
  for (RobotLocalizer* localizer : {&commanded, &measured}) {
    localizer->place(0, {}, 1e-4 * Eigen::Matrix3d::Identity());
    localizer->advance_to(team.now);
  }
  for (int i = 0; i < 40; ++i) {
    models::OdometryReport odometry;
    odometry.kind = models::OdometryKind::kCommand;
    odometry.stamp.time = team.now;
    odometry.motion_body = {0.2, 0.0, 0.0};
    commanded.add_odometry(odometry);
    team.now += Duration{70'000};
    odometry.kind = models::OdometryKind::kIncrement;
    odometry.stamp.time = team.now;
    odometry.interval = Duration{70'000};
    odometry.motion_body = {0.014, 0.0, 0.0};
    measured.add_odometry(odometry);
    commanded.advance_to(team.now);
    measured.advance_to(team.now);
  }
  EXPECT_NEAR(commanded.pose().x_m, 0.56, 1e-9);
  EXPECT_NEAR(measured.pose().x_m, 0.56, 1e-9);
}

TEST(RobotLocalizer, RefusesMessagesOfUnknownRobotsOrWithOtherIncrements) {
  test::SimulatedTeam team(2, 1);
  RobotLocalizer localizer(team.spec, 0);
  localizer.advance_to(team.now);
  models::PoseEstimate message;
  message.increment = kIncrement;
  message.increments_from = team.now;
  message.robot = "STRANGER";
  localizer.add_teammate(message);
  message.robot = "R2";
  message.increment = 2 * kIncrement;
  localizer.add_teammate(message);
  EXPECT_EQ(localizer.counts().refused, 2);
}

// A negative index would be outside the array of increments.
TEST(RobotLocalizer, RefusesTimesBeforeTheEpoch) {
  test::SimulatedTeam team(2, 1);
  RobotLocalizer localizer(team.spec, 0);
  models::OdometryReport odometry;
  odometry.kind = models::OdometryKind::kIncrement;
  odometry.interval = Duration{50'000};
  localizer.add_odometry(odometry);
  models::PoseEstimate message;
  message.robot = "R2";
  message.increment = kIncrement;
  message.increments_from = from_utime(-kIncrement.count());
  message.increments = {Eigen::Vector3d::Zero()};
  localizer.add_teammate(message);
  EXPECT_EQ(localizer.counts().refused, 2);
}

TEST(RobotLocalizer, RefusesIncrementsThatATeammateCannotKnow) {
  test::SimulatedTeam team(2, 1);
  RobotLocalizer localizer(team.spec, 0);
  localizer.advance_to(team.now);
  models::PoseEstimate message;
  message.robot = "R2";
  message.increment = kIncrement;
  message.stamp.time = team.now;
  message.increments_from = team.now - kMessageIncrements * kIncrement;
  message.increments.assign(kMessageIncrements, Eigen::Vector3d::Zero());
  localizer.add_teammate(message);
  EXPECT_EQ(localizer.counts().refused, 0);
  message.increments_from = team.now - kIncrement;  // ends after the message
  message.increments.assign(2, Eigen::Vector3d::Zero());
  localizer.add_teammate(message);
  EXPECT_EQ(localizer.counts().refused, 1);
  message.increments_from = team.now - 2 * kMessageIncrements * kIncrement;
  message.increments.assign(kMessageIncrements + 1, Eigen::Vector3d::Zero());
  localizer.add_teammate(message);
  EXPECT_EQ(localizer.counts().refused, 2);
}

/// Returns the increments that a robot sends after `reports` of its odometer, each for 50 ms and
/// 5 mm. The first report begins `phase` after a step; report number `lost` is missing.
std::vector<Eigen::Vector3d> increments_sent(Duration phase, int reports, int lost) {
  test::SimulatedTeam team(2, 1);
  RobotLocalizer localizer(team.spec, 0);
  localizer.place(0, {}, 1e-4 * Eigen::Matrix3d::Identity());
  localizer.advance_to(team.now);
  models::OdometryReport odometry;
  odometry.kind = models::OdometryKind::kIncrement;
  odometry.interval = Duration{50'000};
  odometry.motion_body = {0.005, 0.0, 0.0};
  for (int i = 0; i < reports; ++i) {
    odometry.stamp.time = team.now + phase + (i + 1) * odometry.interval;
    if (i != lost) {
      localizer.add_odometry(odometry);
    }
  }
  localizer.advance_to(odometry.stamp.time);
  models::PoseEstimate message;
  localizer.write_message(message);
  EXPECT_LE(message.increments_from + static_cast<int>(message.increments.size()) * kIncrement,
            message.stamp.time);
  return message.increments;
}

// A silent teammate may drive up to 0.5 m/s away from where its last motion leads.
TEST(RobotLocalizer, IsUncertainAboutASilentTeammate) {
  test::SimulatedTeam team(2, 1);
  RobotLocalizer localizer(team.spec, 0);
  localizer.place(0, {}, 1e-4 * Eigen::Matrix3d::Identity());
  localizer.place(1, {2.0, 0.0, 0.0}, 1e-4 * Eigen::Matrix3d::Identity());
  localizer.advance_to(team.now);
  models::PoseEstimate message;
  message.robot = "R2";
  message.increment = kIncrement;
  message.increments = {Eigen::Vector3d::Zero()};  // the teammate stands
  message.increments_from = team.now;
  message.stamp.time = team.now + kIncrement;
  localizer.add_teammate(message);
  const auto sigma_m = [&] { return std::sqrt(localizer.team().covariance(1)(0, 0)); };
  for (const double silence_s : {0.2, 1.0, 2.0, 5.0, 20.0}) {
    localizer.advance_to(message.stamp.time + from_seconds(silence_s));
    EXPECT_NEAR(sigma_m(), std::min(0.5 * silence_s * silence_s, 0.5 * silence_s), 0.02)
        << silence_s;
  }
}

TEST(RobotLocalizer, SendsItsMotionAtAnyPhaseOfTheOdometer) {
  for (const Duration phase : {Duration{0}, Duration{10'000}, Duration{30'000}, Duration{49'999}}) {
    const auto increments = increments_sent(phase, 20, -1);
    ASSERT_GE(increments.size(), 9U) << phase.count();
    for (const Eigen::Vector3d& increment : increments) {
      EXPECT_NEAR(increment.x(), 0.01, 1e-12) << phase.count();
    }
  }
}

TEST(RobotLocalizer, SendsNoPartOfAnIncrementAfterALostReport) {
  for (const Duration phase : {Duration{0}, Duration{30'000}}) {
    for (const Eigen::Vector3d& increment : increments_sent(phase, 20, 10)) {
      EXPECT_NEAR(increment.x(), 0.01, 1e-12) << phase.count();
    }
  }
}

TEST(RobotLocalizer, RefusesRobotThatTheScenarioDoesNotHave) {
  test::SimulatedTeam team(2, 1);
  EXPECT_THROW(RobotLocalizer(team.spec, 2), UsageError);
}

TEST(RobotLocalizer, LimitsTheSizeOfItsMessage) {
  test::SimulatedTeam team(4, 3);
  RobotLocalizer localizer(team.spec, 0);
  localizer.advance_to(team.now);
  models::PoseEstimate message;
  for (int i = 0; i < 300; ++i) {
    team.step();
    localizer.add_odometry(team.commands[0]);
    localizer.add_sightings(team.frames[0]);
    localizer.advance_to(team.now);
    localizer.write_message(message);
    EXPECT_LE(message.increments.size(), static_cast<std::size_t>(kMessageIncrements));
    EXPECT_LE(message.sightings.size(), static_cast<std::size_t>(kMessageSightings));
  }
  EXPECT_EQ(message.increments.size(), static_cast<std::size_t>(kMessageIncrements));
  EXPECT_FALSE(message.sightings.empty());
}

TEST(RobotLocalizer, AllocatesNothingPerStep) {
  test::SimulatedTeam team(4, 3);
  RobotLocalizer localizer(team.spec, 0);
  RobotLocalizer mate(team.spec, 1);
  for (RobotLocalizer* each : {&localizer, &mate}) {
    each->advance_to(team.now);
  }
  models::PoseEstimate message;
  std::size_t allocations = 0;
  for (int i = 0; i < 200; ++i) {
    team.step();
    mate.add_odometry(team.commands[1]);
    mate.add_sightings(team.frames[1]);
    mate.advance_to(team.now);
    mate.write_message(message);
    const test::AllocationCounter counter;
    localizer.add_odometry(team.commands[0]);
    localizer.add_sightings(team.frames[0]);
    localizer.add_teammate(message);
    localizer.advance_to(team.now);
    allocations += counter.count();
  }
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace vantage::localizer
