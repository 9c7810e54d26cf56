#pragma once

#include "models/mapping/beam.hpp"

namespace vantage::models {

/// How a team maps: the range finder of each robot, the grid, what a look is worth.
struct MappingSpec {
  BeamSensor scanner{96, 2.0 * kPi, 0.0, 1.5, 0.01};
  int planned_beams = 48;             ///< so many of them, as evenly spaced, in planning
  double resolution_m = 0.2;          ///< side of a cell
  double look_probability = 0.95;     ///< of a cell in which one scan met something; > 1/2
  double settled_probability = 0.99;  ///< nothing is learnt of cells known so well or better
  /// Plans that end farther from the frontier are worth so much less a metre.
  double frontier_nats_per_m = 0.5;
};

}  // namespace vantage::models
