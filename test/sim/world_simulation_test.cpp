#include "sim/world/world_simulation.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "sim/world/mocap.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::sim {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

models::RobotPlan circle_from(const scenario::RobotSpec& robot, Time start) {
  models::RobotPlan plan;
  plan.robot = robot.name;
  plan.stamp.time = start;
  plan.trajectory = {start, robot.start, robot.height_m, {{{1.0, 3.0}, 1000.0, 0.0}}};
  return plan;
}

// Simulates five minutes with the quadrotors circling above the rovers. FCL and the closed form
// both find no contact.
class LabFor300S : public ::testing::TestWithParam<int> {};

TEST_P(LabFor300S, HasNoContact) {
  const scenario::Scenario scenario = test::lab_scenario();
  WorldSimulation world(scenario, static_cast<std::uint64_t>(GetParam()), kStart);
  for (const scenario::RobotSpec& robot : scenario.robots) {
    EXPECT_EQ(world.offer(circle_from(robot, kStart)), PlanVerdict::kAccepted);
  }
  world.advance_to(kStart + std::chrono::seconds(300));
  for (const models::CollisionReport& contact : world.take_contacts()) {
    ADD_FAILURE() << contact.body_a << " and " << contact.body_b << " at " << contact.distance_m
                  << " m";
  }
  EXPECT_EQ(world.collisions().disagreements(), 0);
  EXPECT_EQ(world.collisions().non_finite(), 0);
  EXPECT_GT(world.collisions().min_separation_m(), 0.6);
  EXPECT_GT(world.ground().rovers()->way_points_reached(), 50);
}

INSTANTIATE_TEST_SUITE_P(Seeds, LabFor300S, ::testing::Range(1, 5));

TEST(WorldSimulation, AppliesWindToFlyingVehicles) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.wind = scenario::WindSpec{4.0, -2.0, 0.0};
  WorldSimulation world(scenario, 1, kStart);
  world.advance_to(kStart + std::chrono::seconds(20));
  for (const Quadrotor& quadrotor : world.quadrotors()) {
    const scenario::RobotSpec& robot = *scenario.find_robot(quadrotor.name());
    const Eigen::Vector2d off_m = quadrotor.position_world_m().head<2>() - robot.start.position_m();
    // A steady wind displaces the vehicle by wind · drag · (lag + half a step) / gain.
    const double per_mps_s = 0.25 * (0.15 + 0.0025) / 2.0;
    EXPECT_NEAR(off_m.x(), per_mps_s * 4.0, 1e-4);
    EXPECT_NEAR(off_m.y(), per_mps_s * -2.0, 1e-4);
  }
}

std::vector<double> numbers_of(const models::TruthFrame& frame) {
  std::vector<double> numbers;
  for (const models::TruthBody& body : frame.bodies) {
    const auto& q = body.world_from_body.rotation.coeffs();
    const auto& p = body.world_from_body.translation_m;
    numbers.insert(numbers.end(), {p.x(), p.y(), p.z(), q(0), q(1), q(2), q(3),
                                   body.velocity_world_mps.x(), body.velocity_world_mps.y()});
  }
  return numbers;
}

TEST(WorldSimulation, DependsOnItsSeed) {
  for (const auto motion :
       {scenario::TargetMotion::kRandomWaypoint, scenario::TargetMotion::kDoubleIntegrator}) {
    scenario::Scenario scenario = test::lab_scenario();
    scenario.target_truth.motion = motion;
    WorldSimulation a(scenario, 7, kStart);
    WorldSimulation b(scenario, 7, kStart);
    WorldSimulation c(scenario, 8, kStart);
    for (int k = 1; k <= 200; ++k) {
      const Time at = kStart + k * Duration{50'000};
      a.advance_to(at);
      b.advance_to(at);
      c.advance_to(at);
      ASSERT_EQ(numbers_of(a.truth()), numbers_of(b.truth()));
    }
    EXPECT_NE(numbers_of(a.truth()), numbers_of(c.truth()));
  }
}

TEST(WorldSimulation, IsIndependentOfTheStepLength) {
  const scenario::Scenario scenario = test::lab_scenario();
  WorldSimulation often(scenario, 7, kStart);
  WorldSimulation once(scenario, 7, kStart);
  for (int k = 1; k <= 2000; ++k) {
    often.advance_to(kStart + k * WorldSimulation::kStep);
  }
  once.advance_to(kStart + 2000 * WorldSimulation::kStep);
  EXPECT_EQ(numbers_of(often.truth()), numbers_of(once.truth()));
  once.advance_to(kStart);
  EXPECT_EQ(numbers_of(often.truth()), numbers_of(once.truth()))
      << "the result depends on the step length";
}

TEST(WorldSimulation, KeepsStaticTargetsAndOmitsRealRobots) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.target_truth.motion = scenario::TargetMotion::kStill;
  scenario.targets[2].start = Pose2{2.0, 7.0, 1.0};
  scenario.robots[1].device = scenario::DeviceSource::kReal;
  WorldSimulation world(scenario, 1, kStart);
  world.advance_to(kStart + std::chrono::seconds(5));
  const models::TruthFrame truth = world.truth();
  ASSERT_EQ(truth.bodies.size(), 7u);
  EXPECT_EQ(truth.bodies[1].name, "Q3");
  EXPECT_EQ(truth.bodies[4].target_id, 2);
  EXPECT_EQ(truth.bodies[4].world_from_body.translation_m, Eigen::Vector3d(2.0, 7.0, 0.0));
  EXPECT_EQ(world.offer(circle_from(scenario.robots[1], kStart)), std::nullopt);
}

TEST(WorldSimulation, ReportsAVehicleThatFallsOnARoverBelow) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.target_truth.motion = scenario::TargetMotion::kStill;
  scenario.targets[0].start = Pose2{1.0, 1.0, 0.0};
  WorldSimulation world(scenario, 1, kStart);
  models::OperatorCommand stop;
  stop.action = models::OperatorAction::kEmergencyStop;
  stop.robot = "Q1";
  world.command(stop);
  world.advance_to(kStart + std::chrono::seconds(2));
  const auto contacts = world.take_contacts();
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].body_a, "Q1");
  EXPECT_EQ(contacts[0].body_b, "ROVER1");
  EXPECT_EQ(contacts[0].kind, models::CollisionKind::kCollision);
  EXPECT_TRUE(world.take_contacts().empty());
}

/// An external vehicle that the test moves.
class MovableVehicle : public Vehicle {
 public:
  explicit MovableVehicle(std::string name, const Eigen::Vector3d& start_m)
      : centre_m(start_m), name_(std::move(name)) {}
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] double radius_m() const override { return 0.25; }
  [[nodiscard]] Pose3 world_from_body() const override {
    return {centre_m, Eigen::Quaterniond::Identity()};
  }
  [[nodiscard]] Eigen::Vector3d velocity_world_mps() const override { return velocity_mps; }
  void step(Time, double dt_s) override { centre_m += dt_s * velocity_mps; }

  Eigen::Vector3d centre_m;
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();

 private:
  std::string name_;
};

TEST(WorldSimulation, IncludesTheCallersVehicles) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[1].device = scenario::DeviceSource::kWire;
  MovableVehicle puppet("Q2", {2.0, 4.0, 1.0});
  puppet.velocity_mps = {-0.5, 0.0, 0.0};
  WorldSimulation world(scenario, 1, kStart, {&puppet});
  EXPECT_EQ(world.quadrotors().size(), 2u);
  EXPECT_EQ(world.offer(circle_from(scenario.robots[1], kStart)), std::nullopt);
  world.advance_to(kStart + std::chrono::seconds(2));
  const models::TruthFrame truth = world.truth();
  ASSERT_EQ(truth.bodies.size(), 8u);
  EXPECT_EQ(truth.bodies[1].name, "Q2");  // bodies are in the order of the scenario
  EXPECT_NEAR(truth.bodies[1].world_from_body.translation_m.x(), 1.0, 1e-9);
  EXPECT_EQ(truth.bodies[1].velocity_world_mps, puppet.velocity_mps);
  EXPECT_EQ(world.capture().bodies[1].name, "Q2");
  EXPECT_TRUE(world.take_contacts().empty());
  puppet.velocity_mps = {0.0, 3.0, 0.0};  // m/s; moves through the wall
  world.advance_to(kStart + std::chrono::seconds(4));
  const auto contacts = world.take_contacts();
  ASSERT_FALSE(contacts.empty());
  EXPECT_EQ(contacts.front().body_a, "Q2");
  EXPECT_EQ(contacts.front().kind, models::CollisionKind::kCollision);
}

TEST(WorldSimulation, RoversAvoidTheGroundOnlyBelowALowVehicle) {
  const scenario::Scenario scenario = test::lab_scenario();
  MovableVehicle puppet("Q2", {2.0, 4.0, 0.0});
  // Start positions keep a distance from the start positions of the robots.
  scenario::Scenario moved = scenario;
  moved.robots[1].start = {2.0, 4.0, 0.0};
  WorldSimulation world(moved, 3, kStart, {&puppet});
  const auto nearest_m = [&](int seconds) {
    double least_m = 1e9;
    for (int k = 0; k < 20 * seconds; ++k) {
      world.advance_to(world.time() + Duration{50'000});
      for (std::size_t i = 0; i < scenario.targets.size(); ++i) {
        const Pose2 pose = world.ground().world_from_body(i);
        least_m = std::min(least_m, (pose.position_m() - Eigen::Vector2d(2.0, 4.0)).norm());
      }
    }
    return least_m;
  };
  EXPECT_GE(nearest_m(120), WorldSimulation::kKeepOutM - 0.03);  // m; prediction tolerance
  const std::int64_t reached = world.ground().rovers()->way_points_reached();
  EXPECT_GT(reached, 20) << "the rovers do not move";
  puppet.centre_m.z() = WorldSimulation::kLowM + 0.1;
  EXPECT_LT(nearest_m(120), 0.7);
}

TEST(MocapCamera, AddsTheStatedNoise) {
  scenario::MocapSpec spec;
  spec.position_sigma_m = 0.01;
  spec.yaw_sigma_rad = 0.02;
  MocapCamera camera(spec, 5);
  models::TruthFrame truth;
  truth.stamp.time = kStart;
  truth.bodies.push_back({"Q1", -1, lift({1.0, 2.0, 3.0}, 1.5), {}});
  constexpr int kFrames = 20000;
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  Eigen::Matrix4d second = Eigen::Matrix4d::Zero();
  for (int k = 0; k < kFrames; ++k) {
    const models::MocapFrame frame = camera.capture(truth);
    const Pose3& seen = frame.bodies[0].world_from_body;
    Eigen::Vector4d e;
    e.head<3>() = (seen.translation_m - Eigen::Vector3d(1.0, 2.0, 1.5)) / 0.01;
    e(3) = wrap_to_pi(flatten(seen).yaw_rad - 3.0) / 0.02;
    mean += e / kFrames;
    second += e * e.transpose() / kFrames;
  }
  // The standard deviation of a mean is 1/√n = 0.007, of a variance √(2/n) = 0.01, of a correlation
  // 0.007. The tolerance is 5σ.
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.035);
  EXPECT_LT((second - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff(), 0.05);
}

TEST(MocapCamera, CapturesAtWholePeriodsAndArrivesALatencyLater) {
  scenario::MocapSpec spec;
  spec.rate_hz = 60.0;
  spec.latency_s = 0.007;
  MocapCamera camera(spec, 5);
  EXPECT_EQ(camera.period(), Duration{16'667});
  const Time at = camera.capture_at_or_after(kStart);
  EXPECT_GE(at, kStart);
  EXPECT_LT(at - kStart, camera.period());
  EXPECT_EQ(camera.capture_at_or_after(at), at);
  models::TruthFrame truth;
  truth.stamp.time = at;
  const models::MocapFrame frame = camera.capture(truth);
  EXPECT_EQ(frame.arrival - frame.stamp.time, Duration{7'000});
  EXPECT_EQ(frame.frame_number * 16'667, to_utime(at));
}

TEST(MocapCamera, RefusesAnInvalidRate) {
  scenario::MocapSpec spec;
  spec.rate_hz = 0.0;
  EXPECT_THROW(MocapCamera(spec, 1), UsageError);
}

}  // namespace
}  // namespace vantage::sim
