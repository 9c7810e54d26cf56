#include "models/mapping/beam.hpp"

#include <cmath>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "models/mapping/ray_walk.hpp"

namespace vantage::models {

double BeamSensor::bearing_rad(int beam) const {
  const bool full_circle = field_of_view_rad >= 2.0 * kPi - 1e-12;
  if (full_circle) {
    return wrap_to_pi(2.0 * kPi * beam / beams);
  }
  return beams == 1 ? 0.0 : field_of_view_rad * (static_cast<double>(beam) / (beams - 1) - 0.5);
}

double BeamSensor::mean_range_m(double distance_m) const {
  return distance_m < range_min_m ? 0.0 : distance_m > range_max_m ? range_max_m : distance_m;
}

void require_valid(const BeamSensor& sensor) {
  require(sensor.beams >= 1, "a beam sensor must have at least 1 beam");
  require(sensor.field_of_view_rad > 0.0 && sensor.field_of_view_rad <= 2.0 * kPi,
          "a beam sensor's field of view must be in (0, 2 pi] rad");
  require(sensor.range_min_m >= 0.0 && sensor.range_max_m > sensor.range_min_m &&
              std::isfinite(sensor.range_max_m),
          "a beam sensor's ranges must satisfy 0 <= minimum < maximum, m");
  require(sensor.sigma_m > 0.0 && std::isfinite(sensor.sigma_m),
          "a beam sensor's noise must be > 0 m");
}

void BeamProfile::clear() {
  cell.clear();
  occupancy.clear();
  enter_m.clear();
  exit_m.clear();
}

void BeamProfile::push_back(int cell_index, double occupancy_probability, double from_m,
                            double to_m) {
  cell.push_back(cell_index);
  occupancy.push_back(occupancy_probability);
  enter_m.push_back(from_m);
  exit_m.push_back(to_m);
}

void trace_beam(const OccupancyBelief& belief, const BeamSensor& sensor,
                const Eigen::Vector2d& from_m, double bearing_rad, BeamProfile& out) {
  out.clear();
  RayWalk walk(belief.geometry(), from_m, bearing_rad, sensor.range_max_m);
  if (!walk.next()) {
    return;
  }
  while (walk.next()) {
    const double occupancy = belief.occupancy(walk.cell());
    out.push_back(walk.cell(), occupancy, walk.enter_m(), walk.exit_m());
    if (occupancy == 1.0) {
      return;
    }
  }
}

}  // namespace vantage::models
