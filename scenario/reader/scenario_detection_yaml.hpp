#pragma once

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads what of `sensor` the estimators may be told: ids, false alarms and misses.
/// Precondition: the rest of the sensor is read.
void read_detection(Mapping& from, const models::SensorModel& sensor,
                    models::DetectionModel& detection);

/// Refuses a team whose detections bear no ids where it, its targets or its world are not such as
/// detections are associated with. Precondition: all of `scenario` that it names is read.
void check_unnamed(Mapping& top, const Scenario& scenario);

}  // namespace vantage::scenario
