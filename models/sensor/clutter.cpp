#include "models/sensor/clutter.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "models/sensor/law.hpp"

namespace vantage::models {
namespace {

/// True if range and field of view alone determine what is in view.
bool is_sector(const SensorModel& sensor) { return sensor.kind.law().can_measure == nullptr; }

double fov_rad(const SensorModel& sensor) {
  return has_full_view(sensor) ? 2.0 * kPi : sensor.fov_rad;
}

PositionVector ahead_m(const Viewpoint& from, double range_m, double bearing_rad) {
  const double at_rad = from.world_from_body.yaw_rad + bearing_rad;
  PositionVector y_m = from.world_from_body.position_m();
  y_m += range_m * Eigen::Vector2d(std::cos(at_rad), std::sin(at_rad));
  return y_m;
}

/// Returns a Poisson number by multiplying uniform random numbers (Knuth, The Art of Computer
/// Programming 2, 3.4.1). std::poisson_distribution uses lgamma(), which differs between C
/// libraries.
int draw_poisson(double mean, std::mt19937_64& rng) {
  constexpr double kAtOnce = 500.0;  // largest mean per draw; exp(−mean) of larger means underflows
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int count = 0;
  for (double left = mean; left > 0.0; left -= kAtOnce) {
    const double end = std::exp(-std::min(left, kAtOnce));
    for (double product = uniform(rng); product > end; product *= uniform(rng)) {
      ++count;
    }
  }
  return count;
}

}  // namespace

double view_area_m2(const SensorModel& sensor, const Viewpoint& from) {
  const double least_m2 = sensor.range_min_m * sensor.range_min_m;
  const double most_m2 = sensor.range_max_m * sensor.range_max_m;
  const double sector_m2 = 0.5 * fov_rad(sensor) * (most_m2 - least_m2);
  if (is_sector(sensor)) {
    return sector_m2;
  }
  constexpr int kRings = 40;  // number of rings of equal area; also number of directions
  int seen = 0;
  for (int i = 0; i < kRings; ++i) {
    const double range_m = std::sqrt(least_m2 + (most_m2 - least_m2) * (i + 0.5) / kRings);
    for (int j = 0; j < kRings; ++j) {
      const double bearing_rad = fov_rad(sensor) * ((j + 0.5) / kRings - 0.5);
      seen += in_view(sensor, from, ahead_m(from, range_m, bearing_rad)) ? 1 : 0;
    }
  }
  return sector_m2 * seen / (kRings * kRings);
}

std::vector<Measurement> sample_clutter(const SensorModel& sensor, const Viewpoint& from,
                                        double clutter_per_look, std::mt19937_64& rng) {
  std::vector<Measurement> alarms;
  if (clutter_per_look <= 0.0) {
    return alarms;
  }
  // maximum number of tries per false alarm; then the false alarm is dropped (very small view)
  constexpr int kTriesMax = 1000;
  const int count = draw_poisson(clutter_per_look, rng);
  const double least_m2 = sensor.range_min_m * sensor.range_min_m;
  const double most_m2 = sensor.range_max_m * sensor.range_max_m;
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < count; ++i) {
    for (int tried = 0; tried < kTriesMax; ++tried) {
      const double range_m = std::sqrt(least_m2 + (most_m2 - least_m2) * share(rng));
      const PositionVector y_m = ahead_m(from, range_m, fov_rad(sensor) * (share(rng) - 0.5));
      if (in_view(sensor, from, y_m)) {
        alarms.push_back(sample(sensor, from, y_m, rng));
        break;
      }
    }
  }
  return alarms;
}

}  // namespace vantage::models
