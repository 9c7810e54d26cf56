#pragma once

#include <optional>

#include "scenario/localizer_spec.hpp"
#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

// Readers of the sections that have their own source file: scenario_SECTION_yaml.cpp.

namespace vantage::scenario {

/// Reads a rectangle: its corners min_m and max_m.
void read_rectangle(Mapping& from, models::Rectangle& rectangle);

/// Reads the list `attacks`: each attack has a time span and a list of robots; it jams their
/// sensors. Checks that planner.attacks_max is less than the number of robots. Precondition: the
/// robots have been read.
void read_attacks(Mapping& top, Scenario& scenario);

/// Reads the list `hosts`: names of A-Z and 0-9, each with the parts that it runs. A part may be
/// listed only once. Precondition: the robots have been read.
void read_hosts(Mapping& top, Scenario& scenario);

/// Reads the section `localizer`: landmarks, and the sensor and drive of each robot that computes
/// its own pose. Precondition: the robots have been read.
std::optional<LocalizerSpec> read_localizer(Mapping& top, const Scenario& scenario);

/// Reads the section `mapping`, which the mapping objective requires. Precondition: the world and
/// the planner have been read.
void read_mapping_spec(Mapping& top, Scenario& scenario);

/// Reads `mocap`: a section with the noise of a simulated system and the connection of the driver
/// to the server, or the URL of a real server.
void read_mocap(Mapping& top, MocapSpec& mocap);

}  // namespace vantage::scenario
