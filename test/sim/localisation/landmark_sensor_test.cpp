#include "sim/localisation/landmark_sensor.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"

namespace vantage::sim {
namespace {

const Time kNow = from_utime(1'700'000'000'000'000);

models::TruthFrame truth_with(const Pose2& robot, const Pose2& mate) {
  models::TruthFrame truth;
  truth.stamp.time = kNow;
  truth.bodies = {{"Q1", -1, lift(robot, 1.0), Eigen::Vector3d::Zero()},
                  {"Q2", -1, lift(mate, 1.5), Eigen::Vector3d::Zero()}};
  return truth;
}

scenario::LocalizerSpec exact() {
  scenario::LocalizerSpec spec;
  spec.landmarks = {{101, {2.0, 0.0}}, {102, {0.0, 3.0}}, {103, {-9.0, 0.0}}};
  spec.robots.resize(2);
  spec.robots[0].name = "Q1";
  spec.robots[0].id = 1;
  spec.robots[1].name = "Q2";
  spec.robots[1].id = 2;
  spec.simulation.emplace().sightings.noise_scale = 0.0;
  return spec;
}

const models::Sighting* find(const std::vector<models::Sighting>& seen, int id) {
  const auto found =
      std::find_if(seen.begin(), seen.end(), [id](const auto& each) { return each.id == id; });
  return found == seen.end() ? nullptr : &*found;
}

TEST(LandmarkSensor, MeasuresRangeAndBearingOfWhatIsInRange) {
  LandmarkSensor sensor(exact(), 0, {}, 1);
  const auto seen = sensor.look(truth_with({0.0, 0.0, kPi / 2}, {1.0, 1.0, 0.0}));
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_NEAR(find(seen, 101)->range_m, 2.0, 1e-12);
  EXPECT_NEAR(find(seen, 101)->bearing_rad, -kPi / 2, 1e-12);
  EXPECT_NEAR(find(seen, 102)->bearing_rad, 0.0, 1e-12);
  EXPECT_NEAR(find(seen, 2)->range_m, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(find(seen, 2)->bearing_rad, -kPi / 4, 1e-12);
  EXPECT_EQ(seen[0].time, kNow);
}

TEST(LandmarkSensor, AppliesMountingScaleBiasAndDelay) {
  scenario::LocalizerSpec spec = exact();
  spec.robots[0].sightings = {true, 1.1, 0.05, 0.1, 0.02, 0.5, 0.04};
  LandmarkSensor sensor(spec, 0, {}, 1);
  const auto seen = sensor.look(truth_with({0.0, 0.0, 0.0}, {9.0, 9.0, 0.0}));
  const models::Sighting* const sighting = find(seen, 101);
  ASSERT_NE(sighting, nullptr);
  EXPECT_NEAR(sighting->range_m, 1.1 * 1.5 * std::cos(0.1) + 0.05, 1e-12);
  EXPECT_NEAR(sighting->bearing_rad, 0.02, 1e-12);
  EXPECT_EQ(sighting->time, kNow + Duration{40'000});
}

TEST(LandmarkSensor, SeesNothingOutsideItsViewOrBehindAnObstacle) {
  scenario::LocalizerSpec spec = exact();
  spec.simulation->sightings.fov_rad = kPi / 2;
  LandmarkSensor narrow(spec, 0, {}, 1);
  EXPECT_EQ(find(narrow.look(truth_with({0.0, 0.0, 0.0}, {9.0, 9.0, 0.0})), 102), nullptr);
  models::World world;
  world.obstacles = {{{{0.8, -0.5}, {1.2, 0.5}}, 2.0}};
  LandmarkSensor blocked(exact(), 0, world, 1);
  const auto seen = blocked.look(truth_with({0.0, 0.0, 0.0}, {9.0, 9.0, 0.0}));
  EXPECT_EQ(find(seen, 101), nullptr);
  EXPECT_NE(find(seen, 102), nullptr);
}

TEST(LandmarkSensor, DetectsWithTheStatedProbability) {
  scenario::LocalizerSpec spec = exact();
  spec.simulation->sightings.detection_probability = 0.7;
  LandmarkSensor sensor(spec, 0, {}, 3);
  constexpr int kFrames = 10000;
  int detected = 0;
  for (int i = 0; i < kFrames; ++i) {
    detected += find(sensor.look(truth_with({}, {9.0, 9.0, 0.0})), 101) != nullptr ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(detected) / kFrames, 0.7, 0.02);  // tolerance: 4σ
}

}  // namespace
}  // namespace vantage::sim
