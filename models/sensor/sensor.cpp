#include "models/sensor/sensor.hpp"
