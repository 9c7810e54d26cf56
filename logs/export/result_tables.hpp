#pragma once

#include <functional>
#include <string>

#include "logs/export/mcap_export.hpp"
#include "logs/file/log_index.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// Writes the results of the trial in `log` as tables for a person or a spreadsheet in `folder`,
/// which is created if absent:
///   estimates.csv  t_s, robot, target, x_m, y_m, sigma_m, error_m: each robot's belief of each
///                  target; error_m is empty without the truth
///   plans.csv      t_s, robot, round, source, late, cost_nat, lower_bound_nat, nodes, margin_s
///   vehicles.csv   t_s, robot, state, battery_share, reasons
///   poses.csv      t_s, body, x_m, y_m, z_m, yaw_deg: motion capture, without occluded bodies
///   contacts.csv   t_s, kind, body_a, body_b, distance_m
/// t_s is the time since the start of the log, s. Messages of other types are not written. After a
/// stop (`stop` is called for each event), or if the disk is full, every table ends with a complete
/// line.
/// @throws StartupError "PATH: cannot be …: REASON" if the folder or a table cannot be created.
ExportCounts export_results(
    const IndexedLog& log, const scenario::Scenario& scenario, const std::string& folder,
    const std::function<void(double)>& progress = {},
    const std::function<bool()>& stop = [] { return false; });

}  // namespace vantage::logs
