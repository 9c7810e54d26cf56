#pragma once

#include <functional>
#include <vector>

#include "models/mapping/beam.hpp"
#include "test/support/random.hpp"

namespace vantage::test {

/// All maps of a beam's cells with the densities of a reading: the reference for beam information.
/// It does not use first-hit events.
class EnumeratedBeam {
 public:
  EnumeratedBeam(const models::BeamProfile& beam, const models::BeamSensor& sensor);

  struct Map {
    double probability = 0.0;
    double mean_range_m = 0.0;
    std::vector<bool> occupied;
  };
  [[nodiscard]] const std::vector<Map>& maps() const { return maps_; }
  /// Returns N(z; mean of `map`, σ²).
  [[nodiscard]] double density(const Map& map, double z_m) const;
  /// Returns Σ_m p(m) N(z; mean of m, σ²).
  [[nodiscard]] double density(double z_m) const;
  /// Returns ∫ f(z) dz over the readings of all maps. `f` must be 0 at 10 σ from all mean readings.
  [[nodiscard]] double integral(const std::function<double(double)>& f) const;

 private:
  std::vector<Map> maps_;
  double sigma_m_ = 0.0;
  std::vector<double> means_m_;  // ascending, without duplicates
};

/// Returns a beam of 1 … `cells_max` cells with random widths and occupancies, some of them
/// certain.
models::BeamProfile random_beam(Random& random, int cells_max, double width_min_m,
                                double width_max_m);

}  // namespace vantage::test
