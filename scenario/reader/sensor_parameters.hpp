#pragma once

#include "models/sensor/sensor.hpp"
#include "scenario/reader/mapping.hpp"

namespace vantage::scenario {

/// Reads the parameters that the sensor's kind declares (SensorLaw::parameters), under
/// their names. Refuses a parameter of another kind, with the list of this kind's own parameters.
void read_own_parameters(Mapping& from, models::SensorModel& sensor);

}  // namespace vantage::scenario
