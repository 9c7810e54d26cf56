#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/filter/distributed_filter.hpp"
#include "test/estimator/csv.hpp"
#include "test/estimator/filter_support.hpp"

// Uses real flights (EuRoC V1_01 … V1_03): one observer and two targets. Measurements are simulated
// from Vicon poses, as in the dissertation's hardware experiment.

namespace vantage::estimator {
namespace {

constexpr int kStride = 10;  // the rows have 100 Hz, observations 10 Hz
constexpr double kLook_s = 0.1;
/// m; minimum distance of an observation. The flights were not simultaneous, so their paths may
/// intersect.
constexpr double kNearest_m = 0.3;
constexpr unsigned kSeeds = 40;                // draws of the measurement noise
constexpr double kNees95 = 5.991464547107979;  // 95 % quantile of χ²₂
constexpr double kBand95 = 2.05;               // Student's t, about 29 degrees of freedom

using Track3 = std::vector<std::vector<double>>;  // rows of t x y z qw qx qy qz

Pose3 pose_of(const std::vector<double>& row) {
  return {{row[1], row[2], row[3]},
          Eigen::Quaterniond(row[4], row[5], row[6], row[7]).normalized()};
}

/// Returns the white-acceleration density, m²/s³ per coordinate, that covers the flight at all
/// relevant time scales: the maximum over Δ of ½ E‖v(t + Δ) − v(t)‖²/Δ.
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

/// Mean and standard error of independent samples.
struct MeanOf {
  double mean = 0.0;
  double error = 0.0;
};
MeanOf mean_of(const std::vector<double>& samples) {
  const double n = static_cast<double>(samples.size());
  MeanOf out;
  double squares = 0.0;
  for (const double each : samples) {
    out.mean += each / n;
    squares += each * each / n;
  }
  out.error = std::sqrt((squares - out.mean * out.mean) / (n - 1.0));
  return out;
}

/// Mean NEES of one seed per target and flight section of 5 s. Errors are correlated over one or
/// two seconds, so sections are independent.
class Stretches {
 public:
  void add(std::size_t row, int target, double nees) {
    Sum& sum = sums_[{row / kRows, target}];
    sum.nees += nees;
    sum.looks += 1.0;
  }
  [[nodiscard]] std::vector<double> means() const {
    std::vector<double> out;
    for (const auto& [stretch, sum] : sums_) {
      out.push_back(sum.nees / sum.looks);
    }
    return out;
  }

 private:
  static constexpr std::size_t kRows = 500;
  struct Sum {
    double nees = 0.0;
    double looks = 0.0;
  };
  std::map<std::pair<std::size_t, int>, Sum> sums_;
};

class ViconFlights : public ::testing::TestWithParam<models::SensorKind> {};

TEST_P(ViconFlights, ErrorsMatchTheFiltersCovariance) {
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
  std::vector<std::vector<double>> stretches;  // sections by seed
  double inside = 0.0;
  double squared_m2 = 0.0;
  double variance_m2 = 0.0;
  double raw_m2 = 0.0;
  double samples = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    DistributedFilter filter(spec);
    std::mt19937_64 rng(seed);
    Stretches nees;
    double judged = 0.0;
    const std::size_t rows = std::min({observer.size(), targets[0].size(), targets[1].size()});
    for (std::size_t i = 0; i < rows; i += kStride) {
      const Time t = from_utime(1'000'000'000) + from_seconds(0.01 * static_cast<double>(i));
      const Pose3 eye = pose_of(observer[i]);
      const models::Viewpoint from{flatten(eye), eye.translation_m.z()};
      const std::vector<Eigen::Vector2d> truth = {{targets[0][i][1], targets[0][i][2]},
                                                  {targets[1][i][1], targets[1][i][2]}};
      models::RobotMeasurement look;
      look.stamp.time = t;
      look.viewpoint = from;
      for (int m = 0; m < 2; ++m) {
        const Eigen::Vector2d y_m = truth[static_cast<std::size_t>(m)];
        if ((y_m - from.world_from_body.position_m()).norm() > kNearest_m) {
          look.detections.push_back({m, models::sample(sensor, from, y_m, rng)});
        }
      }
      test::take_step(filter, t, from, {look});
      if (i < 1000) {  // the first ten seconds are not evaluated
        continue;
      }
      for (const models::Detection& d : look.detections) {
        const Eigen::Vector2d y_m = truth[static_cast<std::size_t>(d.target_id)];
        const models::Gaussian g = test::known(filter, d.target_id);
        const Eigen::Vector2d error = g.mean.head(2) - y_m;
        const Eigen::Matrix2d P = g.covariance.topLeftCorner(2, 2);
        squared_m2 += error.squaredNorm();
        variance_m2 += P.trace();
        const double squared = error.dot(P.inverse() * error);
        nees.add(i, d.target_id, squared);
        inside += squared < kNees95 ? 1.0 : 0.0;
        const auto raw = models::position_from(sensor, from, d.measurement.z, 2);
        raw_m2 += (Eigen::Vector2d(raw.value_or(y_m)) - y_m).squaredNorm();
        judged += 1.0;
      }
    }
    ASSERT_GT(judged, 500.0);
    stretches.push_back(nees.means());
    samples += judged;
  }
  const double rmse_m = std::sqrt(squared_m2 / samples);
  const double sigma_m = std::sqrt(variance_m2 / samples);
  const double raw_m = std::sqrt(raw_m2 / samples);
  // The noise is drawn forty times, but each flight exists only once. The uncertainty of the mean
  // NEES is therefore estimated from the differences between flight sections.
  std::vector<double> over_seeds(stretches.front().size());
  std::vector<double> off;  // deviation of each seed, in standard errors
  for (const std::vector<double>& of : stretches) {
    ASSERT_EQ(of.size(), over_seeds.size());
    for (std::size_t s = 0; s < of.size(); ++s) {
      over_seeds[s] += of[s] / kSeeds;
    }
    const MeanOf seed = mean_of(of);
    off.push_back((seed.mean - 2.0) / seed.error);
  }
  const MeanOf whole = mean_of(over_seeds);
  const auto in_band =
      std::count_if(off.begin(), off.end(), [](double z) { return std::abs(z) < kBand95; });
  const auto [lowest, highest] = std::minmax_element(off.begin(), off.end());
  std::cout << "q " << q << " m2/s3, rmse " << rmse_m << " m, filter's own sigma " << sigma_m
            << " m, raw measurements " << raw_m << " m, mean NEES " << whole.mean << " +- "
            << whole.error << " of 2 over " << over_seeds.size() << " stretches; seeds from "
            << *lowest << " to " << *highest << " standard errors off, " << in_band << " of "
            << kSeeds << " in their 95 % band; inside the 95 % ellipse " << inside / samples
            << "\n";
  // Expected by chance: the mean differs from 2 by more than 3.7 standard errors once in a thousand
  // tests; six of forty seeds are outside their bands once in seventy tests.
  EXPECT_NEAR(whole.mean, 2.0, 3.7 * whole.error);
  EXPECT_LT(whole.error, 0.1);  // otherwise the test is too weak
  EXPECT_GT(*lowest, -3.7);
  EXPECT_LT(*highest, 3.7);
  EXPECT_GE(in_band, 35);
  EXPECT_NEAR(inside / samples, 0.95, 0.015);
  EXPECT_NEAR(rmse_m, sigma_m, 0.05 * sigma_m);
  EXPECT_LT(rmse_m, 0.9 * raw_m);  // the filter must improve on raw measurements
}

INSTANTIATE_TEST_SUITE_P(Sensors, ViconFlights,
                         ::testing::Values(models::SensorKind::kRangeBearing,
                                           models::SensorKind::kPosition));

}  // namespace
}  // namespace vantage::estimator
