#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"
#include "models/world/world.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::sim {

/// Simulated sensor of one robot that measures range and bearing of landmarks and teammates. The
/// measurement model is that of SightingSpec, implemented separately from the localizer.
class LandmarkSensor {
 public:
  /// @param robot  index in `spec`, which has a section `simulation`
  LandmarkSensor(const scenario::LocalizerSpec& spec, int robot, const models::World& world,
                 std::uint64_t seed);

  /// Returns the sightings at the instant of `truth`, as stamped by the sensor. Landmarks and
  /// teammates behind obstacles are not seen. Draws random numbers: call it once per frame.
  std::vector<models::Sighting> look(const models::TruthFrame& truth);

 private:
  double normal() { return std::normal_distribution<double>()(rng_); }

  scenario::LocalizerSpec spec_;
  std::size_t robot_;
  models::World world_;
  std::mt19937_64 rng_;
};

}  // namespace vantage::sim
