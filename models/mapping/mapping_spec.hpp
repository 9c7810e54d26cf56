#pragma once

#include "models/mapping/beam.hpp"

namespace vantage::models {

/// Parameters of mapping by a team: each robot's range finder, the grid, and the evidence of one
/// scan.
struct MappingSpec {
  BeamSensor scanner{96, 2.0 * kPi, 0.0, 1.5, 0.01};
  int planned_beams = 48;             ///< number of evenly spaced beams used in planning
  double resolution_m = 0.2;          ///< side of a cell
  double look_probability = 0.95;     ///< probability that a cell is occupied after one hit; > 1/2
  double settled_probability = 0.99;  ///< probability from which a cell counts as certain
  /// Penalty of a plan, nats per metre of path from its end to the frontier of the explored area.
  double frontier_nats_per_m = 0.5;
};

}  // namespace vantage::models
