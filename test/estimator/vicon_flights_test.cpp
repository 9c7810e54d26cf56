#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/distributed_filter.hpp"
#include "test/estimator/csv.hpp"
#include "test/estimator/filter_support.hpp"

// Real flights (EuRoC V1_01 … V1_03): one is the observer, two are the targets, and measurements
// are made from Vicon poses, as in the dissertation's hardware experiment.

namespace vantage::estimator {
namespace {

constexpr int kStride = 10;  // of 100 Hz rows: looks at 10 Hz
constexpr double kLook_s = 0.1;
/// The flights pass through each other (they were not flown together); a real pair would not.
constexpr double kNearest_m = 0.3;
constexpr unsigned kSeeds = 40;  // of the measurement noise

using Track3 = std::vector<std::vector<double>>;  // t x y z qw qx qy qz

Pose3 pose_of(const std::vector<double>& row) {
  return {{row[1], row[2], row[3]},
          Eigen::Quaterniond(row[4], row[5], row[6], row[7]).normalized()};
}

/// The white-acceleration density that is no less than the flight's own at any time scale that
/// matters: max over Δ of ½ E‖v(t + Δ) − v(t)‖²/Δ, m²/s³ a coordinate.
double acceleration_density(const Track3& track) {
  std::vector<Eigen::Vector2d> velocity;
  for (std::size_t i = kStride; i < track.size(); i += kStride) {
    const auto& a = track[i - kStride];
    const auto& b = track[i];
    velocity.push_back(Eigen::Vector2d(b[1] - a[1], b[2] - a[2]) / (b[0] - a[0]));
  }
  double q = 0.0;
  for (std::size_t lag = 1; lag <= 20; ++lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < velocity.size(); ++i) {
      sum += (velocity[i] - velocity[i - lag]).squaredNorm();
    }
    const double count = static_cast<double>(velocity.size() - lag);
    q = std::max(q, 0.5 * sum / count / (kLook_s * static_cast<double>(lag)));
  }
  return q;
}

class ViconFlights : public ::testing::TestWithParam<models::SensorKind> {};

TEST_P(ViconFlights, AreTrackedAsWellAsTheFilterSays) {
  const std::string folder = VANTAGE_DATA_DIR "/vicon_flights/";
  const Track3 observer = test::read_csv(folder + "v1_01.csv");
  const std::vector<Track3> targets = {test::read_csv(folder + "v1_02.csv"),
                                       test::read_csv(folder + "v1_03.csv")};
  if (observer.empty() || targets[0].empty() || targets[1].empty()) {
    GTEST_SKIP() << "no data in " << folder;
  }
  const double q = std::max(acceleration_density(targets[0]), acceleration_density(targets[1]));
  models::SensorModel sensor;
  sensor.kind = GetParam();
  FilterSpec spec = test::open_spec({models::TargetKind::kDoubleIntegrator, 2, q}, sensor, 2);
  spec.step_s = kLook_s;
  spec.estimator.prior_velocity_sigma_mps = 1.0;
  std::vector<double> mean_nees;
  double squared_m2 = 0.0;
  double variance_m2 = 0.0;
  double raw_m2 = 0.0;
  double samples = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    DistributedFilter filter(spec);
    std::mt19937_64 rng(seed);
    double nees = 0.0;
    double judged = 0.0;
    const std::size_t rows = std::min({observer.size(), targets[0].size(), targets[1].size()});
    for (std::size_t i = 0; i < rows; i += kStride) {
      const Time t = from_utime(1'000'000'000) + from_seconds(0.01 * static_cast<double>(i));
      const Pose3 eye = pose_of(observer[i]);
      const models::Viewpoint from{flatten(eye), eye.translation_m.z()};
      const std::vector<Eigen::Vector2d> truth = {{targets[0][i][1], targets[0][i][2]},
                                                  {targets[1][i][1], targets[1][i][2]}};
      models::DetectionSet look;
      look.stamp.time = t;
      look.viewpoint = from;
      for (int m = 0; m < 2; ++m) {
        const Eigen::Vector2d y_m = truth[static_cast<std::size_t>(m)];
        if ((y_m - from.world_from_body.position_m()).norm() > kNearest_m) {
          look.detections.push_back({m, models::sample(sensor, from, y_m, rng)});
        }
      }
      test::take_step(filter, t, from, {look});
      if (i < 1000) {  // settle for ten seconds
        continue;
      }
      for (const models::Detection& d : look.detections) {
        const Eigen::Vector2d y_m = truth[static_cast<std::size_t>(d.target_id)];
        const models::Gaussian g = test::known(filter, d.target_id);
        const Eigen::Vector2d error = g.mean.head(2) - y_m;
        const Eigen::Matrix2d P = g.covariance.topLeftCorner(2, 2);
        squared_m2 += error.squaredNorm();
        variance_m2 += P.trace();
        nees += error.dot(P.inverse() * error);
        const auto raw = models::position_from(sensor, from, d.measurement.z, 2);
        raw_m2 += (Eigen::Vector2d(raw.value_or(y_m)) - y_m).squaredNorm();
        judged += 1.0;
      }
    }
    ASSERT_GT(judged, 500.0);
    mean_nees.push_back(nees / judged);
    samples += judged;
  }
  const double rmse_m = std::sqrt(squared_m2 / samples);
  const double sigma_m = std::sqrt(variance_m2 / samples);
  const double raw_m = std::sqrt(raw_m2 / samples);
  double mean = 0.0;
  double squares = 0.0;
  for (const double each : mean_nees) {
    mean += each / kSeeds;
    squares += each * each / kSeeds;
  }
  // Errors of successive looks depend on each other, draws of the noise do not: the band is over
  // these. 3.5 standard errors are missed once in two thousand.
  const double band = 3.5 * std::sqrt(std::max(squares - mean * mean, 0.0) / (kSeeds - 1.0));
  std::cout << "q " << q << " m2/s3, rmse " << rmse_m << " m, filter's own sigma " << sigma_m
            << " m, raw measurements " << raw_m << " m, mean NEES " << mean << " +- " << band
            << " of 2\n";
  // q covers the flights' own accelerations, so the filter may be pessimistic but not optimistic
  // beyond what chance leaves open; and it must be worth having.
  EXPECT_LT(mean - band, 2.0);
  EXPECT_GT(mean + band, 1.0);
  EXPECT_LT(rmse_m, sigma_m * std::sqrt(1.0 + band));
  EXPECT_LT(rmse_m, 0.9 * raw_m);
}

INSTANTIATE_TEST_SUITE_P(Sensors, ViconFlights,
                         ::testing::Values(models::SensorKind::kRangeBearing,
                                           models::SensorKind::kPosition));

}  // namespace
}  // namespace vantage::estimator
