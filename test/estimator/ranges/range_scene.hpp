#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "estimator/ranges/range_fit.hpp"

namespace vantage::estimator::test {

/// A simulated recording: the truth and the ranges.
struct RangeScene {
  models::RangeCalibration calibration;
  std::vector<Eigen::Vector2d> beacons_m;
  std::vector<TakenRange> ranges;
};

struct RangeSceneSpec {
  double half_side_m = 30.0;
  int ranges_of_beacon = 150;
  double range_sigma_m = 0.5;
  double outlier_share_max = 0.3;
  double correlation = 0.0;  ///< correlation of successive errors of one beacon
};

/// Simulates a robot that moves among two to five beacons; scale 0.8 to 1.25, bias −2 to 2 m.
inline RangeScene draw_range_scene(unsigned seed, const RangeSceneSpec& spec) {
  std::mt19937_64 rng(seed);
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(rng);
  };
  std::normal_distribution<double> normal;
  const double L = spec.half_side_m;
  RangeScene scene;
  scene.calibration = {uniform(0.8, 1.25), uniform(-2.0, 2.0)};
  const int beacons = static_cast<int>(uniform(2.0, 6.0));
  for (int b = 0; b < beacons; ++b) {
    scene.beacons_m.emplace_back(uniform(-L, L), uniform(-L, L));
  }
  const double outlier_share = uniform(0.0, spec.outlier_share_max);
  const double rest = std::sqrt(1.0 - spec.correlation * spec.correlation);
  std::vector<double> errors(scene.beacons_m.size());
  Eigen::Vector2d robot_m = Eigen::Vector2d::Zero();
  double heading_rad = uniform(-kPi, kPi);
  double turn_rad = 0.0;
  for (int k = 0; k < spec.ranges_of_beacon * beacons; ++k) {
    turn_rad = 0.9 * turn_rad + 0.1 * normal(rng);
    heading_rad += turn_rad;
    if (robot_m.norm() > L) {
      heading_rad += 0.3 * wrap_to_pi(std::atan2(-robot_m.y(), -robot_m.x()) - heading_rad);
    }
    robot_m += 0.01 * L * Eigen::Vector2d(std::cos(heading_rad), std::sin(heading_rad));
    const int b = k % beacons;
    double& error = errors[index(b)];
    error = spec.correlation * error + rest * normal(rng);
    const double distance_m = (scene.beacons_m[index(b)] - robot_m).norm();
    const double honest_m = scene.calibration.range_scale * distance_m +
                            scene.calibration.range_bias_m + spec.range_sigma_m * error;
    const bool is_outlier = uniform(0.0, 1.0) < outlier_share;
    scene.ranges.push_back({robot_m, is_outlier ? uniform(0.0, 3.0 * L) : honest_m, b});
  }
  return scene;
}

inline constexpr int kLapPositions = 400;

/// Returns position k of a circle of 15 m, of which one lap has kLapPositions.
inline Eigen::Vector2d on_circle_m(int k) {
  const double angle_rad = 2.0 * kPi * k / kLapPositions;
  return 15.0 * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
}

/// Returns the ranges of ten laps to a beacon at (25, 5), σ = 0.3 m. Each lap has the same error at
/// the same position.
inline std::vector<TakenRange> repeated_ranges(unsigned seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> noise(0.0, 0.3);
  std::vector<double> errors_m(kLapPositions);
  for (double& error_m : errors_m) {
    error_m = noise(rng);
  }
  const Eigen::Vector2d beacon_m(25.0, 5.0);
  std::vector<TakenRange> ranges;
  for (int k = 0; k < 10 * kLapPositions; ++k) {
    const Eigen::Vector2d robot_m = on_circle_m(k);
    ranges.push_back(
        {robot_m, (beacon_m - robot_m).norm() + errors_m[index(k % kLapPositions)], 0});
  }
  return ranges;
}

}  // namespace vantage::estimator::test
