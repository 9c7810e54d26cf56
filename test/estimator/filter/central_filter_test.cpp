#include "estimator/filter/central_filter.hpp"

#include <random>

#include <gtest/gtest.h>

#include "core/index.hpp"
#include "estimator/filter/distributed_filter.hpp"
#include "test/estimator/filter_support.hpp"

namespace vantage::estimator {
namespace {

const models::TargetModel kModel{models::TargetKind::kDoubleIntegrator, 2, 0.01};

models::World square_world() {
  models::World world;
  world.bounds = {{-20.0, -20.0}, {20.0, 20.0}};
  return world;
}

models::SensorModel forward_sensor() {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kRangeBearing;
  sensor.range_max_m = 15.0;
  sensor.fov_rad = radians(120.0);
  sensor.range_sigma_m = 0.15;
  sensor.bearing_sigma_rad = radians(5.0);
  return sensor;
}

models::Gaussian prior_at(double x_m, double y_m) {
  models::Gaussian prior{Eigen::Vector4d(x_m, y_m, 0.3, -0.2), {}};
  prior.covariance = Eigen::Vector4d(0.5, 0.5, 0.1, 0.1).asDiagonal();
  return prior;
}

// Returns the observations of two robots of those stationary targets that are in view.
std::vector<models::RobotMeasurement> looks_at(const std::vector<Eigen::Vector2d>& targets_m,
                                               Time now, std::mt19937_64& rng) {
  std::vector<models::RobotMeasurement> looks(2);
  looks[0].viewpoint = test::at(-8.0, 0.0);
  looks[1].viewpoint = test::at(8.0, 4.0, kPi);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    looks[i].stamp.time = now;
    looks[i].robot = i == 0 ? "Q1" : "Q2";
    for (std::size_t m = 0; m < targets_m.size(); ++m) {
      if (models::in_view(forward_sensor(), looks[i].viewpoint, targets_m[m])) {
        looks[i].detections.push_back(
            {static_cast<int>(m),
             models::sample(forward_sensor(), looks[i].viewpoint, targets_m[m], rng)});
      }
    }
  }
  return looks;
}

// Every observation is received without delay, and empty scans are not used.
TEST(CentralFilter, EqualsADistributedFilterWithAllMeasurements) {
  const std::vector<Eigen::Vector2d> targets_m = {{-2.0, 1.0}, {3.0, -1.0}, {-10.0, 18.0}};
  const std::vector<models::Gaussian> priors = {prior_at(-2.3, 1.2), prior_at(3.5, -1.4),
                                                prior_at(-10.5, 18.5)};
  const models::World world = square_world();
  CentralFilter central({kModel, 0.5, 0.0, true}, world, priors);
  FilterSpec spec = test::open_spec(kModel, forward_sensor(), 3);
  spec.sensor = forward_sensor();
  spec.estimator.targets_stay_inside = true;
  spec.communication_range_m = 1e6;
  spec.team = {{"Q1", forward_sensor()}, {"Q2", forward_sensor()}};
  DistributedFilter distributed(spec);
  distributed.rebase(test::prior(test::instant(0), priors));
  std::mt19937_64 rng(5);
  int seen = 0;
  for (int step = 1; step <= 60; ++step) {
    const auto looks = looks_at(targets_m, test::instant(step), rng);
    central.predict();
    central.update(forward_sensor(), looks);
    test::take_step(distributed, test::instant(step), looks[0].viewpoint, looks);
    for (int m = 0; m < 3; ++m) {
      const models::Gaussian& own = central.beliefs()[index(m)];
      const models::Gaussian other = test::known(distributed, m);
      EXPECT_LT((own.mean - other.mean).norm(), 1e-6) << "step " << step << ", target " << m;
      EXPECT_LT((own.covariance - other.covariance).norm(), 1e-6 * own.covariance.norm());
      seen += central.is_seen()[index(m)];
    }
  }
  EXPECT_EQ(seen, 2 * 60) << "the third is out of view";
}

TEST(CentralFilter, OnlyPredictsUnobservedTargets) {
  const models::World world = square_world();
  CentralFilter filter({kModel, 0.5, 0.05, false}, world, {prior_at(1.0, 2.0)});
  const models::Gaussian expected = models::predict(prior_at(1.0, 2.0), kModel, 0.5);
  filter.predict();
  filter.update(forward_sensor(), {});
  EXPECT_LT((filter.beliefs()[0].mean - expected.mean).norm(), 1e-9);
  EXPECT_LT((filter.beliefs()[0].covariance - expected.covariance).norm(), 1e-9);
  EXPECT_EQ(filter.is_seen()[0], 0);
}

TEST(CentralFilter, MovesABeliefOutOfAnEmptyView) {
  const models::World world = square_world();
  models::RobotMeasurement look;
  look.viewpoint = test::at(0.0, 0.0);
  for (const double probability : {0.0, 0.5}) {
    CentralFilter filter({kModel, 0.5, probability, true}, world, {prior_at(14.8, 0.0)});
    filter.update(forward_sensor(), {&look, 1});
    if (probability > 0.0) {
      EXPECT_GT(filter.beliefs()[0].mean.x(), 14.81);
    } else {
      EXPECT_EQ(filter.beliefs()[0].mean, prior_at(14.8, 0.0).mean);
    }
  }
}

}  // namespace
}  // namespace vantage::estimator
