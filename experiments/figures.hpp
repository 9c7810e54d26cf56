#pragma once

#include <span>
#include <string>

#include "models/world/world.hpp"

// Functions that return gnuplot scripts. Each script is run in the directory of its experiment's
// files and writes SVG and PNG.

namespace vantage::experiments {

std::string dls_savings_figure();
std::string dls_objective_figure();
/// Draws information as a function of energy (Fig. 3.8), and the paths chosen by each method in one
/// trial in `world` (Fig. 3.9). `titles` contains one quoted title per method.
std::string heterogeneous_figures(const models::World& world, const std::string& titles);
std::string resilient_tracking_figure();
/// Draws the mean errors of each combination and the values printed in the dissertation, from
/// table.csv.
std::string resilient_tracking_choices_figure();
/// Draws maps of the first trial of RAIN with two attacks (Fig. 4.4), and entropy over time (Fig.
/// 4.5).
std::string resilient_mapping_figures();
/// Draws the heuristic (Fig. 2.3), search trees (Fig. 2.2, 2.5) and the cost of the trees' paths
/// (Fig. 2.4).
std::string active_mapping_figures();
/// Draws the means and confidence intervals of a sweep of team trials (Fig. 3.3, 3.4). `columns`
/// are the columns that name a setting.
std::string team_figure(const std::string& name, const std::string& axis,
                        const std::string& columns);

/// Draws the OSPA distance and the number of track swaps of each of `methods` at each setting of
/// tracking-clutter. The rows of summary.csv are the methods of each setting, in the order of
/// `methods`.
std::string tracking_clutter_figure(std::span<const char* const> methods);

/// Draws, for surveillance, the measures as a function of T_REPLAN for α = 2, from summary.csv.
/// Also draws the camp and the paths of one trial.
std::string surveillance_figures();
/// Draws, for resilient-hardware, the paths of one trial and the distances to both targets, for
/// both planners.
std::string resilient_hardware_figure();
/// Draws, for search-or-sampling, the loss of each method in each family from summary.csv, and the
/// difference between the sampling tree and the beam as a function of the horizon.
std::string search_or_sampling_figure();

}  // namespace vantage::experiments
