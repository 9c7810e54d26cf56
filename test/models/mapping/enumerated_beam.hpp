#pragma once

#include <functional>
#include <vector>

#include "models/mapping/beam.hpp"
#include "test/support/random.hpp"

namespace vantage::test {

/// Every map of a beam's cells, one by one, with the densities of a reading: the oracle of beam
/// information. Nothing here knows of first hits.
class EnumeratedBeam {
 public:
  EnumeratedBeam(const models::BeamProfile& beam, const models::BeamSensor& sensor);

  struct Map {
    double probability = 0.0;
    double mean_range_m = 0.0;
    std::vector<bool> occupied;
  };
  [[nodiscard]] const std::vector<Map>& maps() const { return maps_; }
  /// N(z; mean of `map`, σ²).
  [[nodiscard]] double density(const Map& map, double z_m) const;
  /// Σ_m p(m) density.
  [[nodiscard]] double density(double z_m) const;
  /// ∫ f(z) dz over everything that any map's reading can be. `f` must vanish 10 σ away from them.
  [[nodiscard]] double integral(const std::function<double(double)>& f) const;

 private:
  std::vector<Map> maps_;
  double sigma_m_ = 0.0;
  std::vector<double> means_m_;  // ascending, each once
};

/// A beam of 1 … `cells_max` cells of random widths and occupancies, some of them certain.
models::BeamProfile random_beam(Random& random, int cells_max, double width_min_m,
                                double width_max_m);

}  // namespace vantage::test
