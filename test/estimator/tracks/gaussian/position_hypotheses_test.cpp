#include "estimator/tracks/gaussian/position_hypotheses.hpp"

#include <random>

#include <gtest/gtest.h>

#include "test/estimator/filter_support.hpp"

namespace vantage::estimator {
namespace {

using models::SensorKind;

models::World room() {
  models::World world;
  world.bounds = {{-4.0, -4.0}, {4.0, 4.0}};
  return world;
}

models::SensorModel sensor_of(SensorKind kind) {
  models::SensorModel sensor;
  sensor.kind = kind;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 5.0;
  sensor.range_sigma_m = 0.1;
  sensor.bearing_sigma_rad = 0.05;
  return sensor;
}

scenario::EstimatorSpec still_targets() {
  scenario::EstimatorSpec spec;
  spec.target_model = {models::TargetKind::kRandomWalk, 2, 1e-6};
  return spec;
}

/// One robot that moves at random and measures a stationary target until the target is located.
struct Search {
  std::optional<models::Gaussian> found;
  Eigen::Vector2d truth_m;
  int measurements = 0;
};
Search search_for_a_target(SensorKind kind, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> side(-2.0, 2.0);
  std::uniform_real_distribution<double> turn(-kPi, kPi);
  const models::SensorModel sensor = sensor_of(kind);
  Search out{std::nullopt, {side(rng), side(rng)}, 0};
  PositionHypotheses hypotheses;
  while (!out.found && out.measurements < 40) {
    const models::Viewpoint from = test::at(side(rng), side(rng), turn(rng));
    if (!models::in_view(sensor, from, models::PositionVector(out.truth_m))) {
      continue;
    }
    const models::Measurement z =
        models::sample(sensor, from, models::PositionVector(out.truth_m), rng);
    if (hypotheses.size() == 0 || !hypotheses.measure(sensor, from, z)) {
      hypotheses.start(still_targets(), room(), sensor, from, z);
    }
    ++out.measurements;
    out.found = hypotheses.located(2.5);
  }
  return out;
}

// Two rings cross in two places, three in one; two rays cross once.
TEST(PositionHypotheses, LocateATargetConsistentlyBySeveralMeasurements) {
  for (const auto& [kind, most] : std::vector<std::pair<SensorKind, double>>{
           {SensorKind::kRange, 5.0}, {SensorKind::kBearing, 5.0}}) {
    test::MeanNees nees;
    double measurements = 0.0;
    constexpr int kSeeds = 400;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Search search = search_for_a_target(kind, static_cast<std::uint64_t>(seed));
      ASSERT_TRUE(search.found) << kind.name() << " seed " << seed;
      models::Gaussian position{search.found->mean.head<2>(),
                                search.found->covariance.topLeftCorner<2, 2>()};
      nees.add(position, search.truth_m);
      measurements += search.measurements;
    }
    RecordProperty(std::string(kind.name()) + "_nees", std::to_string(nees.mean()));
    EXPECT_GT(nees.mean(), 1.6) << kind.name();
    EXPECT_LT(nees.mean(), 2.6) << kind.name();
    EXPECT_LT(measurements / kSeeds, most) << kind.name();
  }
}

TEST(PositionHypotheses, DoNotLocateATargetFromOnePlace) {
  for (const SensorKind kind : {SensorKind::kRange, SensorKind::kBearing}) {
    std::mt19937_64 rng(3);
    const models::SensorModel sensor = sensor_of(kind);
    const models::Viewpoint from = test::at(0.5, 0.2, 0.3);
    PositionHypotheses hypotheses;
    for (int k = 0; k < 100; ++k) {
      const models::Measurement z =
          models::sample(sensor, from, models::PositionVector(Eigen::Vector2d(2.0, 1.0)), rng);
      if (k == 0) {
        ASSERT_TRUE(hypotheses.start(still_targets(), room(), sensor, from, z));
      } else {
        hypotheses.measure(sensor, from, z);
      }
      EXPECT_FALSE(hypotheses.located(0.5)) << kind.name() << " after " << k + 1;
    }
  }
}

TEST(PositionHypotheses, BeginOnlyWhereTheTargetCanBe) {
  const models::SensorModel sensor = sensor_of(SensorKind::kRange);
  const models::Viewpoint from = test::at(0.0, 0.0);
  models::Measurement z;
  z.z = models::MeasurementVector::Constant(1, 3.0);
  z.V = models::MeasurementMatrix::Constant(1, 1, 0.01);
  PositionHypotheses hypotheses;
  models::World narrow = room();
  narrow.bounds = {{-4.0, -0.5}, {0.5, 0.5}};  // leaves the part of the ring near (−3, 0)
  ASSERT_TRUE(hypotheses.start(still_targets(), narrow, sensor, from, z));
  const auto found = hypotheses.located(2.5);
  ASSERT_TRUE(found || hypotheses.size() > 1);
  narrow.bounds = {{-1.0, -1.0}, {1.0, 1.0}};
  EXPECT_FALSE(hypotheses.start(still_targets(), narrow, sensor, from, z));
  EXPECT_EQ(hypotheses.size(), 0);
  scenario::EstimatorSpec spatial = still_targets();
  spatial.target_model.position_dim = 3;
  EXPECT_FALSE(hypotheses.start(spatial, room(), sensor, from, z)) << "only planar targets";
}

// A second target's range, with the id of the first, fits no hypothesis.
TEST(PositionHypotheses, RefuseAContradictionAndKeepTheirState) {
  const models::SensorModel sensor = sensor_of(SensorKind::kRange);
  models::Measurement z;
  z.z = models::MeasurementVector::Constant(1, 1.0);
  z.V = models::MeasurementMatrix::Constant(1, 1, 0.01);
  PositionHypotheses hypotheses;
  ASSERT_TRUE(hypotheses.start(still_targets(), room(), sensor, test::at(-2.0, 0.0), z));
  const int before = hypotheses.size();
  EXPECT_FALSE(hypotheses.measure(sensor, test::at(3.5, 0.0), z));  // rings 3.5 m apart
  EXPECT_EQ(hypotheses.size(), before);
}

// A second robot that sees half of the ring and does not report the target leaves the other half.
TEST(PositionHypotheses, ShrinkByMissedDetections) {
  const models::SensorModel sensor = sensor_of(SensorKind::kRange);
  models::SensorModel near = sensor;
  near.range_max_m = 1.6;
  models::Measurement z;
  z.z = models::MeasurementVector::Constant(1, 1.5);
  z.V = models::MeasurementMatrix::Constant(1, 1, 0.01);
  PositionHypotheses hypotheses;
  ASSERT_TRUE(hypotheses.start(still_targets(), room(), sensor, test::at(0.0, 0.0), z));
  const int before = hypotheses.size();
  for (int k = 0; k < 5; ++k) {
    hypotheses.miss(room(), near, test::at(1.5, 0.0), 0.99);
  }
  EXPECT_LT(hypotheses.size(), 0.8 * before);
  EXPECT_GT(hypotheses.size(), 0.3 * before);
}

TEST(DistributedFilter, DiscoversTargetsByRangesOrBearingsOfATeam) {
  for (const SensorKind kind : {SensorKind::kRange, SensorKind::kBearing}) {
    FilterSpec spec =
        test::open_spec({models::TargetKind::kRandomWalk, 2, 1e-4}, sensor_of(kind), 1);
    spec.sensor.range_max_m = 5.0;
    spec.estimator.grid_resolution_m = 1.0;
    spec.world = room();
    spec.communication_range_m = 100.0;
    spec.team = {{"Q1", spec.sensor}, {"Q2", spec.sensor}, {"Q3", spec.sensor}};
    DistributedFilter filter(spec);
    std::mt19937_64 rng(5);
    const std::vector<Eigen::Vector2d> truth_m{{0.7, -0.4}};
    const models::Viewpoint views[] = {test::at(-1.5, 0.0, 0.3), test::at(1.5, 1.8, -2.0),
                                       test::at(0.5, -2.5, 1.5)};
    const auto look = [&](int step, int robot) {
      auto made = test::look_at(spec.sensor, test::instant(step),
                                views[static_cast<std::size_t>(robot)], truth_m, rng);
      made.robot = "Q" + std::to_string(robot + 1);
      return made;
    };
    test::take_step(filter, test::instant(1), views[0], {look(1, 0)});
    EXPECT_FALSE(filter.track(0).known) << kind.name() << ": one measurement";
    test::take_step(filter, test::instant(2), views[0], {look(2, 0), look(2, 1), look(2, 2)});
    ASSERT_TRUE(filter.track(0).known) << kind.name();
    EXPECT_NEAR((test::known(filter, 0).mean - truth_m[0]).norm(), 0.0, 0.4) << kind.name();
    EXPECT_EQ(filter.counters().undiscoverable, 0);
  }
}

}  // namespace
}  // namespace vantage::estimator
