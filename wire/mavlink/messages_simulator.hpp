#pragma once

#include <array>
#include <cstdint>

#include "wire/mavlink/field_list.hpp"

// Messages between a simulator and the firmware that flies in it. Members are in wire order, with
// the names, units and types of the message definitions (common.xml).

namespace vantage::wire::mavlink {

struct HilActuatorControls {
  static constexpr MessageName kMessage{"HIL_ACTUATOR_CONTROLS", 93};
  std::uint64_t time_usec = 0;  ///< [us]
  std::uint64_t flags = 0;      ///< bit 0: the sender waits for its sensors (lockstep)
  std::array<float, 16> controls{};
  std::uint8_t mode = 0;
  using Fields = FieldList<&HilActuatorControls::time_usec, &HilActuatorControls::flags,
                           &HilActuatorControls::controls, &HilActuatorControls::mode>;
  using Extensions = FieldList<>;
};

struct HilSensor {
  static constexpr MessageName kMessage{"HIL_SENSOR", 107};
  std::uint64_t time_usec = 0;  ///< [us]
  float xacc = 0.0F;            ///< [m/s/s]
  float yacc = 0.0F;            ///< [m/s/s]
  float zacc = 0.0F;            ///< [m/s/s]
  float xgyro = 0.0F;           ///< [rad/s]
  float ygyro = 0.0F;           ///< [rad/s]
  float zgyro = 0.0F;           ///< [rad/s]
  float xmag = 0.0F;            ///< [gauss]
  float ymag = 0.0F;            ///< [gauss]
  float zmag = 0.0F;            ///< [gauss]
  float abs_pressure = 0.0F;    ///< [hPa]
  float diff_pressure = 0.0F;   ///< [hPa]
  float pressure_alt = 0.0F;
  float temperature = 0.0F;  ///< [degC]
  std::uint32_t fields_updated = 0;
  std::uint8_t id = 0;
  using Fields =
      FieldList<&HilSensor::time_usec, &HilSensor::xacc, &HilSensor::yacc, &HilSensor::zacc,
                &HilSensor::xgyro, &HilSensor::ygyro, &HilSensor::zgyro, &HilSensor::xmag,
                &HilSensor::ymag, &HilSensor::zmag, &HilSensor::abs_pressure,
                &HilSensor::diff_pressure, &HilSensor::pressure_alt, &HilSensor::temperature,
                &HilSensor::fields_updated>;
  using Extensions = FieldList<&HilSensor::id>;
};

}  // namespace vantage::wire::mavlink
