#include "test/models/mapping/enumerated_beam.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vantage::test {

EnumeratedBeam::EnumeratedBeam(const models::BeamProfile& beam, const models::BeamSensor& sensor)
    : sigma_m_(sensor.sigma_m) {
  for (unsigned bits = 0; bits < 1U << static_cast<unsigned>(beam.size()); ++bits) {
    Map map{1.0, sensor.range_max_m, {}};
    bool is_open = true;
    for (std::size_t k = 0; k < beam.occupancy.size(); ++k) {
      const bool occupied = (bits >> k & 1U) != 0;
      map.probability *= occupied ? beam.occupancy[k] : 1.0 - beam.occupancy[k];
      map.occupied.push_back(occupied);
      if (occupied && is_open) {
        map.mean_range_m = sensor.mean_range_m(0.5 * (beam.enter_m[k] + beam.exit_m[k]));
        is_open = false;
      }
    }
    means_m_.push_back(map.mean_range_m);
    maps_.push_back(std::move(map));
  }
  std::sort(means_m_.begin(), means_m_.end());
  means_m_.erase(std::unique(means_m_.begin(), means_m_.end()), means_m_.end());
}

double EnumeratedBeam::density(const Map& map, double z_m) const {
  const double d = (z_m - map.mean_range_m) / sigma_m_;
  return std::exp(-0.5 * d * d) / (sigma_m_ * std::sqrt(2.0 * std::numbers::pi));
}

double EnumeratedBeam::density(double z_m) const {
  double sum = 0.0;
  for (const Map& map : maps_) {
    sum += map.probability * density(map, z_m);
  }
  return sum;
}

double EnumeratedBeam::integral(const std::function<double(double)>& f) const {
  double sum = 0.0;
  double begin_m = means_m_.front() - 10.0 * sigma_m_;
  for (std::size_t k = 0; k < means_m_.size();) {
    begin_m = std::max(begin_m, means_m_[k] - 10.0 * sigma_m_);
    double end_m = means_m_[k] + 10.0 * sigma_m_;
    while (++k < means_m_.size() && means_m_[k] - 10.0 * sigma_m_ <= end_m) {
      end_m = means_m_[k] + 10.0 * sigma_m_;
    }
    // For functions with Gaussian decay at both ends, the trapezium rule has a relative error of
    // e^−39.
    const int steps = static_cast<int>(std::ceil((end_m - begin_m) / (0.5 * sigma_m_)));
    const double step_m = (end_m - begin_m) / steps;
    for (int i = 0; i <= steps; ++i) {
      sum += f(begin_m + i * step_m) * step_m;
    }
    begin_m = end_m;
  }
  return sum;
}

models::BeamProfile random_beam(Random& random, int cells_max, double width_min_m,
                                double width_max_m) {
  models::BeamProfile beam;
  double enter_m = random.uniform(0.0, width_max_m);
  const int cells = random.integer(1, cells_max);
  for (int k = 0; k < cells; ++k) {
    const double exit_m = enter_m + random.uniform(width_min_m, width_max_m);
    const int kind = random.integer(0, 9);
    const double occupancy = kind == 0   ? 0.0
                             : kind == 1 ? 0.5
                             : kind == 2 ? random.uniform(0.0, 0.02)
                             : kind == 3 ? random.uniform(0.98, 1.0)
                                         : random.uniform(0.0, 1.0);
    beam.push_back(k, occupancy, enter_m, exit_m);
    enter_m = exit_m;
  }
  return beam;
}

}  // namespace vantage::test
