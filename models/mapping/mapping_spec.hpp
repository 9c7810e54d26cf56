#pragma once

#include "models/mapping/beam.hpp"

namespace vantage::models {

/// Mapping parameters of a team: the range finder of each robot, the grid and the effect of one
/// scan.
struct MappingSpec {
  BeamSensor scanner{96, 2.0 * kPi, 0.0, 1.5, 0.01};
  int planned_beams = 48;             ///< beams used in planning, evenly spaced like the scanner's
  double resolution_m = 0.2;          ///< m; side of a cell
  double look_probability = 0.95;     ///< occupancy probability of a cell after one hit; > 1/2
  double settled_probability = 0.99;  ///< cells at least this certain give no further information
  /// nats per metre; penalty for the distance from a plan's end to the frontier.
  double frontier_nats_per_m = 0.5;
};

}  // namespace vantage::models
