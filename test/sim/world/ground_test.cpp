// Tests targets on the ground, the cameras, and the time steps of the world.

#include "sim/world/ground.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "sim/world/linear_targets.hpp"
#include "sim/world/mocap.hpp"
#include "sim/world/world_simulation.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::sim {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

scenario::Scenario lab_with(scenario::TargetMotion motion) {
  scenario::Scenario out = test::lab_scenario();
  out.target_truth.motion = motion;
  return out;
}

// The reported velocity of a target equals the rate of change of its position, for any motion.
TEST(Ground, VelocityIsRateOfPosition) {
  for (const auto motion :
       {scenario::TargetMotion::kRandomWaypoint, scenario::TargetMotion::kDoubleIntegrator}) {
    scenario::Scenario scenario = lab_with(motion);
    scenario.target_truth.acceleration_q = 0.02;
    Ground ground(scenario, 3);
    double fastest_mps = 0.0;
    int moves = 0;
    for (int step = 0; step < 6000; ++step) {
      if (step % 10 == 0) {
        ground.decide(0.05);
      }
      std::vector<Pose2> before;
      std::vector<Eigen::Vector2d> before_mps;
      for (std::size_t i = 0; i < 5; ++i) {
        before.push_back(ground.world_from_body(i));
        before_mps.push_back(ground.velocity_mps(i));
      }
      ground.step(0.005);
      for (std::size_t i = 0; i < 5; ++i) {
        const Eigen::Vector2d moved_m =
            ground.world_from_body(i).position_m() - before[i].position_m();
        const Eigen::Vector2d mean_mps = 0.5 * (before_mps[i] + ground.velocity_mps(i));
        const bool has_bounced = moved_m.norm() == 0.0;
        EXPECT_TRUE(has_bounced || (moved_m / 0.005 - mean_mps).norm() < 0.03);
        moves += has_bounced ? 0 : 1;
        fastest_mps = std::max(fastest_mps, mean_mps.norm());
        if (motion == scenario::TargetMotion::kDoubleIntegrator) {
          EXPECT_EQ(ground.world_from_body(i).yaw_rad, before[i].yaw_rad)
              << "drifting targets do not turn";
        }
      }
    }
    EXPECT_GT(moves, 5000);
    EXPECT_GT(fastest_mps, 0.3);
    EXPECT_EQ(ground.rovers() != nullptr, motion == scenario::TargetMotion::kRandomWaypoint);
  }
}

TEST(Ground, LimitsDriftToTwoMetresPerSecond) {
  scenario::Scenario scenario = lab_with(scenario::TargetMotion::kDoubleIntegrator);
  scenario.target_truth.acceleration_q = 20.0;
  Ground ground(scenario, 3);
  double fastest_mps = 0.0;
  for (int step = 0; step < 4000; ++step) {
    ground.step(0.005);
    fastest_mps = std::max(fastest_mps, ground.velocity_mps(4).norm());
  }
  EXPECT_NEAR(fastest_mps, 2.0, 1e-9);
}

TEST(Ground, UsesGivenPositions) {
  scenario::Scenario scenario = lab_with(scenario::TargetMotion::kStill);
  scenario.targets[3].start = Pose2{2.0, 7.0, -2.0};
  Ground ground(scenario, 3);
  ground.keep_out({{2.0, 7.0}}, 1.0);
  ground.decide(0.05);
  ground.step(0.005);
  EXPECT_EQ(ground.world_from_body(3), (Pose2{2.0, 7.0, -2.0}));
  EXPECT_EQ(ground.velocity_mps(3), Eigen::Vector2d::Zero());
  EXPECT_EQ(ground.rovers(), nullptr);
}

// --- targets of a linear model

TEST(LinearTargets, ReflectAtWalls) {
  const models::TargetModel model{models::TargetKind::kDoubleIntegrator, 2, 0.0};
  const models::Rectangle bounds{{-2.0, 3.0}, {4.0, 5.0}};
  struct Row {
    Eigen::Vector4d from, to;
  };
  for (const Row& row : {Row{{3.9, 4.0, 0.5, 0.1}, {3.85, 4.05, -0.5, 0.1}},
                         Row{{-1.9, 4.0, -0.5, 0.1}, {-1.85, 4.05, 0.5, 0.1}},
                         Row{{1.0, 4.9, 0.2, 0.6}, {1.1, 4.8, 0.2, -0.6}},
                         Row{{1.0, 3.1, -0.2, -0.6}, {0.9, 3.2, -0.2, 0.6}},
                         Row{{3.9, 3.1, 0.5, -0.6}, {3.85, 3.2, -0.5, 0.6}},
                         Row{{1.0, 4.0, 0.2, 0.6}, {1.1, 4.3, 0.2, 0.6}}}) {
    LinearTargets targets(model, 0.5, bounds, {row.from}, std::mt19937_64(1));
    targets.move();
    EXPECT_LT((targets.states()[0] - row.to).norm(), 1e-12) << row.from.transpose();
  }
}

TEST(LinearTargets, StartWithPositionAndVelocity) {
  const models::TargetModel model{models::TargetKind::kDoubleIntegrator, 2, 0.1};
  const models::StateVector four = Eigen::Vector4d::Zero();
  const models::StateVector two = Eigen::Vector2d::Zero();
  const models::Rectangle bounds{{-2.0, -3.0}, {4.0, 5.0}};
  EXPECT_NO_THROW(LinearTargets(model, 0.5, bounds, {four, four}, std::mt19937_64(1)));
  EXPECT_THROW(LinearTargets(model, 0.5, bounds, {four, two}, std::mt19937_64(1)), UsageError);
}

// Covariances are correlated, with unequal variances, and singular. Each sample lies in the range
// of the covariance.
TEST(DrawGaussian, HasTheGivenCovariance) {
  Eigen::Matrix3d root;
  root << 0.1, 0.0, 0.0, 0.5, 2.0, 0.0, -1.0, 1.0, 0.0;  // matrix of rank two
  const models::StateMatrix covariance = root * root.transpose();
  const Eigen::LDLT<models::StateMatrix> ldlt(covariance);
  std::mt19937_64 rng(3);
  constexpr int kDraws = 20'000;
  models::StateMatrix sample = models::StateMatrix::Zero(3, 3);
  for (int n = 0; n < kDraws; ++n) {
    const models::StateVector draw = draw_gaussian(ldlt, rng);
    ASSERT_TRUE(draw.allFinite());
    sample += draw * draw.transpose() / kDraws;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
      EXPECT_NEAR(sample(i, j) / scale, covariance(i, j) / scale, 0.04);
    }
  }
}

// --- cameras

TEST(MocapCamera, RefusesInvalidSpec) {
  const auto is_taken = [](double scenario::MocapSpec::*field, double value) {
    scenario::MocapSpec spec;
    spec.*field = value;
    try {
      const MocapCamera camera(spec, 1);
    } catch (const UsageError&) {
      return false;
    }
    return true;
  };
  EXPECT_TRUE(is_taken(&scenario::MocapSpec::rate_hz, 1000.0));
  EXPECT_TRUE(is_taken(&scenario::MocapSpec::rate_hz, 0.01));
  EXPECT_FALSE(is_taken(&scenario::MocapSpec::rate_hz, 1000.1));
  EXPECT_FALSE(is_taken(&scenario::MocapSpec::rate_hz, -1.0));
  for (const auto field : {&scenario::MocapSpec::position_sigma_m,
                           &scenario::MocapSpec::yaw_sigma_rad, &scenario::MocapSpec::latency_s}) {
    EXPECT_TRUE(is_taken(field, 0.0));
    EXPECT_FALSE(is_taken(field, -1e-6));
  }
}

TEST(MocapCamera, CapturesAtNextWholePeriod) {
  scenario::MocapSpec spec;
  spec.rate_hz = 100.0;
  MocapCamera camera(spec, 1);
  EXPECT_EQ(camera.latency(), Duration{5'000});
  EXPECT_EQ(camera.capture_at_or_after(kStart), kStart);
  EXPECT_EQ(camera.capture_at_or_after(kStart + Duration{1}), kStart + Duration{10'000});
  EXPECT_EQ(camera.capture_at_or_after(kStart + Duration{9'999}), kStart + Duration{10'000});
  EXPECT_EQ(camera.capture_at_or_after(kStart + Duration{10'001}), kStart + Duration{20'000});
}

// Without noise a camera measures the true pose. Yaw noise rotates a body about the vertical in any
// attitude.
TEST(MocapCamera, KeepsBodyOrderAndRotatesAboutTheVertical) {
  models::TruthFrame truth;
  truth.stamp.time = kStart;
  truth.bodies.push_back({"Q1", -1, lift({1.0, 2.0, 3.0}, 1.5), {}});
  const Quaternion tilted(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()));
  truth.bodies.push_back({"Q2", -1, {{-1.0, 4.0, 0.2}, tilted}, {}});
  scenario::MocapSpec spec;
  spec.position_sigma_m = 0.0;
  spec.yaw_sigma_rad = 0.0;
  const models::MocapFrame exact = MocapCamera(spec, 1).capture(truth);
  ASSERT_EQ(exact.bodies.size(), 2u);
  EXPECT_EQ(exact.bodies[0].name, "Q1");
  EXPECT_EQ(exact.bodies[1].name, "Q2");
  EXPECT_EQ(exact.bodies[1].world_from_body.translation_m, Eigen::Vector3d(-1.0, 4.0, 0.2));
  EXPECT_LT(exact.bodies[1].world_from_body.rotation.angularDistance(tilted), 1e-7);
  EXPECT_FALSE(exact.bodies[0].occluded);
  spec.yaw_sigma_rad = 0.3;
  MocapCamera camera(spec, 1);
  double turned_rad = 0.0;
  for (int n = 0; n < 50; ++n) {
    const models::MocapFrame frame = camera.capture(truth);
    const Quaternion turn = frame.bodies[1].world_from_body.rotation * tilted.conjugate();
    EXPECT_NEAR(turn.x(), 0.0, 1e-12);
    EXPECT_NEAR(turn.y(), 0.0, 1e-12);
    turned_rad = std::max(turned_rad, Eigen::AngleAxisd(turn).angle());
  }
  EXPECT_GT(turned_rad, 0.2);
}

// --- the world

/// An external vehicle that counts its steps.
class StepCounter : public Vehicle {
 public:
  StepCounter(std::string name, double height_m) : name_(std::move(name)), height_m_(height_m) {}
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] double radius_m() const override { return 0.25; }
  [[nodiscard]] Pose3 world_from_body() const override { return lift({2.0, 4.0, 0.0}, height_m_); }
  [[nodiscard]] Eigen::Vector3d velocity_world_mps() const override {
    return Eigen::Vector3d::Zero();
  }
  void step(Time now, double dt_s) override { steps.emplace_back(now, dt_s); }
  std::vector<std::pair<Time, double>> steps;

 private:
  std::string name_;
  double height_m_;
};

// If the start and end times are not multiples of the step, the first and last steps are shorter.
TEST(WorldSimulation, StepsToWholeMultiplesAndTheGivenTime) {
  StepCounter vehicle("Q2", 2.5);
  const Time start = kStart + Duration{1'200};
  WorldSimulation world(test::lab_scenario(), 1, start, {&vehicle});
  world.advance_to(start);
  EXPECT_TRUE(vehicle.steps.empty());
  world.advance_to(kStart + Duration{12'500});
  EXPECT_EQ(world.time(), kStart + Duration{12'500});
  using Step = std::pair<Time, double>;
  EXPECT_EQ(vehicle.steps, (std::vector<Step>{{start, 0.0038},
                                              {kStart + Duration{5'000}, 0.005},
                                              {kStart + Duration{10'000}, 0.0025}}));
  world.advance_to(kStart + Duration{15'000});
  EXPECT_EQ(vehicle.steps.back(), (Step{kStart + Duration{12'500}, 0.0025}));
}

TEST(WorldSimulation, CommandsOneOrAllRobots) {
  const scenario::Scenario scenario = lab_with(scenario::TargetMotion::kStill);
  WorldSimulation world(scenario, 1, kStart);
  models::OperatorCommand command;
  command.action = models::OperatorAction::kHold;
  command.robot = "Q2";
  world.command(command);
  const auto states = [&] {
    std::vector<models::FlightState> out;
    for (const Quadrotor& quadrotor : world.quadrotors()) {
      out.push_back(quadrotor.state());
    }
    return out;
  };
  using models::FlightState;
  EXPECT_EQ(states(),
            (std::vector{FlightState::kFollow, FlightState::kHold, FlightState::kFollow}));
  command.action = models::OperatorAction::kLand;
  command.robot.clear();
  world.command(command);
  EXPECT_EQ(states(), (std::vector{FlightState::kLand, FlightState::kLand, FlightState::kLand}));
  world.advance_to(kStart + Duration{500'000});
  const models::TruthFrame truth = world.truth();
  EXPECT_EQ(truth.stamp.time, kStart + Duration{500'000});
  ASSERT_EQ(truth.bodies.size(), 8u);
  EXPECT_EQ(truth.bodies[2].name, "Q3");
  EXPECT_EQ(truth.bodies[2].target_id, -1);
  EXPECT_LT(truth.bodies[2].velocity_world_mps.z(), -0.3);
  EXPECT_EQ(truth.bodies[7].name, "ROVER5");
  EXPECT_EQ(truth.bodies[7].target_id, 4);
  EXPECT_EQ(world.capture().stamp.time, truth.stamp.time);
}

// An external vehicle flies just below or exactly at the height limit. Rovers avoid the ground
// below it only in the first case.
TEST(WorldSimulation, RoversAvoidTheGroundBelowVehiclesUnderTheHeightLimit) {
  for (const bool is_low : {true, false}) {
    scenario::Scenario scenario = test::lab_scenario();
    scenario.robots[1].start = {2.0, 4.0, 0.0};
    StepCounter vehicle("Q2", is_low ? 0.89 : 0.9);
    WorldSimulation world(scenario, 3, kStart, {&vehicle});
    double nearest_m = 1e9;
    for (int k = 0; k < 1600; ++k) {
      world.advance_to(world.time() + Duration{50'000});
      for (std::size_t i = 0; i < 5; ++i) {
        const Pose2 pose = world.ground().world_from_body(i);
        nearest_m = std::min(nearest_m, (pose.position_m() - Eigen::Vector2d(2.0, 4.0)).norm());
      }
    }
    EXPECT_EQ(nearest_m > 0.97, is_low) << nearest_m;
  }
}

}  // namespace
}  // namespace vantage::sim
