#pragma once

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads the detection statistics of `sensor`: target ids, false alarms and misses. Precondition:
/// the other keys of the sensor have been read.
void read_detection(Mapping& from, const models::SensorModel& sensor,
                    models::DetectionModel& detection);

/// Refuses a team with detections without target ids if data association does not support its
/// robots, targets or world. Precondition: robots, targets, world and estimator have been read.
void check_without_ids(Mapping& top, const Scenario& scenario);

}  // namespace vantage::scenario
