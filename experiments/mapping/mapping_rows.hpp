#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "experiments/mapping/mapping_trial.hpp"
#include "experiments/sweep/sweep.hpp"
#include "models/mapping/occupancy_belief.hpp"
#include "models/world/world.hpp"

// Conversion of maps and paths of resilient mapping to table rows, and to the input files of
// gnuplot.

namespace vantage::experiments {

/// Adds `map` to the table "maps": each row holds one row of cells, one character per cell from '0'
/// (free) to 'z' (occupied).
void add_map_rows(UnitRows& rows, const std::string& name, const models::OccupancyBelief& map);

/// Adds each robot's position at each step, and whether it was attacked, to the table "ways".
void add_path_rows(UnitRows& rows, const MappingOutcome& outcome);

/// Returns the cells that name a setting: "squares,worst,2,plain,rain".
using SettingCells = std::function<std::string(std::size_t)>;

/// Returns files by name. For each of `worlds`: WORLD_truth.txt, and from the first trial of the
/// setting that stores maps WORLD_half.txt, WORLD_end.txt and WORLD_ways.txt.
std::map<std::string, std::string> map_files(const Tables& tables,
                                             const std::map<std::string, models::World>& worlds,
                                             const SettingCells& setting_cells);

/// Returns the entropy by step as CSV: mean and confidence interval over the trials.
std::string entropy_curves(const Tables& tables, const SettingCells& setting_cells);

}  // namespace vantage::experiments
