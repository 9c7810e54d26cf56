#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "logs/edit/edit.hpp"
#include "logs/mrclam/mrclam.hpp"

namespace vantage::logs {

/// Returns the name of robot `subject` in the scenario and in channel names.
std::string mrclam_robot(int subject);

/// Returns a scenario with the robots R1, R2, … and the landmarks of `data`, in a world that
/// contains all true positions. Sensors and drives have default parameters. The scenario has a
/// target only because each scenario needs one; the data contain none.
std::string mrclam_scenario(const MrclamData& data);

/// Passes `data` to `sink` as events of a log, in the order of time: SCENARIO, ODOMETRY_R
/// (commands), SIGHTINGS_R (one message per camera frame), and VICON (true poses). The times are
/// those of the data. Returns the number of events; ends early if `sink` returns false or `stop`
/// returns true.
/// @param version  version of the program, for SCENARIO
std::int64_t write_mrclam(const MrclamData& data, const std::string& version, const EventSink& sink,
                          const std::function<bool()>& stop);

}  // namespace vantage::logs
