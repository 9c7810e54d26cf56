#pragma once

#include <array>
#include <cstdint>

#include "wire/mavlink/field_list.hpp"
#include "wire/mavlink/messages_motion.hpp"

// Messages with a vehicle's estimated state and the quality of the estimate. Members are in wire
// order, with the names, units and types of the message definitions (common.xml,
// ardupilotmega.xml).

namespace vantage::wire::mavlink {

struct Attitude {
  static constexpr MessageName kMessage{"ATTITUDE", 30};
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  float roll = 0.0F;               ///< [rad]
  float pitch = 0.0F;              ///< [rad]
  float yaw = 0.0F;                ///< [rad]
  float rollspeed = 0.0F;          ///< [rad/s]
  float pitchspeed = 0.0F;         ///< [rad/s]
  float yawspeed = 0.0F;           ///< [rad/s]
  using Fields =
      FieldList<&Attitude::time_boot_ms, &Attitude::roll, &Attitude::pitch, &Attitude::yaw,
                &Attitude::rollspeed, &Attitude::pitchspeed, &Attitude::yawspeed>;
  using Extensions = FieldList<>;
};

struct AttitudeQuaternion {
  static constexpr MessageName kMessage{"ATTITUDE_QUATERNION", 31};
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  float q1 = 0.0F;
  float q2 = 0.0F;
  float q3 = 0.0F;
  float q4 = 0.0F;
  float rollspeed = 0.0F;   ///< [rad/s]
  float pitchspeed = 0.0F;  ///< [rad/s]
  float yawspeed = 0.0F;    ///< [rad/s]
  std::array<float, 4> repr_offset_q{};
  using Fields =
      FieldList<&AttitudeQuaternion::time_boot_ms, &AttitudeQuaternion::q1, &AttitudeQuaternion::q2,
                &AttitudeQuaternion::q3, &AttitudeQuaternion::q4, &AttitudeQuaternion::rollspeed,
                &AttitudeQuaternion::pitchspeed, &AttitudeQuaternion::yawspeed>;
  using Extensions = FieldList<&AttitudeQuaternion::repr_offset_q>;
};

struct LocalPositionNed : LocalMotion {
  static constexpr MessageName kMessage{"LOCAL_POSITION_NED", 32};
  using Fields = MotionFields;
  using Extensions = FieldList<>;
};

struct GpsGlobalOrigin {
  static constexpr MessageName kMessage{"GPS_GLOBAL_ORIGIN", 49};
  std::int32_t latitude = 0;    ///< [degE7]
  std::int32_t longitude = 0;   ///< [degE7]
  std::int32_t altitude = 0;    ///< [mm]
  std::uint64_t time_usec = 0;  ///< [us]
  using Fields = FieldList<&GpsGlobalOrigin::latitude, &GpsGlobalOrigin::longitude,
                           &GpsGlobalOrigin::altitude>;
  using Extensions = FieldList<&GpsGlobalOrigin::time_usec>;
};

struct HomePosition {
  static constexpr MessageName kMessage{"HOME_POSITION", 242};
  std::int32_t latitude = 0;   ///< [degE7]
  std::int32_t longitude = 0;  ///< [degE7]
  std::int32_t altitude = 0;   ///< [mm]
  float x = 0.0F;              ///< [m]
  float y = 0.0F;              ///< [m]
  float z = 0.0F;              ///< [m]
  std::array<float, 4> q{};
  float approach_x = 0.0F;      ///< [m]
  float approach_y = 0.0F;      ///< [m]
  float approach_z = 0.0F;      ///< [m]
  std::uint64_t time_usec = 0;  ///< [us]
  using Fields =
      FieldList<&HomePosition::latitude, &HomePosition::longitude, &HomePosition::altitude,
                &HomePosition::x, &HomePosition::y, &HomePosition::z, &HomePosition::q,
                &HomePosition::approach_x, &HomePosition::approach_y, &HomePosition::approach_z>;
  using Extensions = FieldList<&HomePosition::time_usec>;
};

struct ExtendedSysState {
  static constexpr MessageName kMessage{"EXTENDED_SYS_STATE", 245};
  std::uint8_t vtol_state = 0;
  std::uint8_t landed_state = 0;
  using Fields = FieldList<&ExtendedSysState::vtol_state, &ExtendedSysState::landed_state>;
  using Extensions = FieldList<>;
};

struct BatteryStatus {
  static constexpr MessageName kMessage{"BATTERY_STATUS", 147};
  std::int32_t current_consumed = 0;         ///< [mAh]
  std::int32_t energy_consumed = 0;          ///< [hJ]
  std::int16_t temperature = 0;              ///< [cdegC]
  std::array<std::uint16_t, 10> voltages{};  ///< [mV]
  std::int16_t current_battery = 0;          ///< [cA]
  std::uint8_t id = 0;
  std::uint8_t battery_function = 0;
  std::uint8_t type = 0;
  std::int8_t battery_remaining = 0;  ///< [%]
  std::int32_t time_remaining = 0;    ///< [s]
  std::uint8_t charge_state = 0;
  std::array<std::uint16_t, 4> voltages_ext{};  ///< [mV]
  std::uint8_t mode = 0;
  std::uint32_t fault_bitmask = 0;
  using Fields = FieldList<&BatteryStatus::current_consumed, &BatteryStatus::energy_consumed,
                           &BatteryStatus::temperature, &BatteryStatus::voltages,
                           &BatteryStatus::current_battery, &BatteryStatus::id,
                           &BatteryStatus::battery_function, &BatteryStatus::type,
                           &BatteryStatus::battery_remaining>;
  using Extensions =
      FieldList<&BatteryStatus::time_remaining, &BatteryStatus::charge_state,
                &BatteryStatus::voltages_ext, &BatteryStatus::mode, &BatteryStatus::fault_bitmask>;
};

struct EstimatorStatus {
  static constexpr MessageName kMessage{"ESTIMATOR_STATUS", 230};
  std::uint64_t time_usec = 0;  ///< [us]
  float vel_ratio = 0.0F;
  float pos_horiz_ratio = 0.0F;
  float pos_vert_ratio = 0.0F;
  float mag_ratio = 0.0F;
  float hagl_ratio = 0.0F;
  float tas_ratio = 0.0F;
  float pos_horiz_accuracy = 0.0F;  ///< [m]
  float pos_vert_accuracy = 0.0F;   ///< [m]
  std::uint16_t flags = 0;
  using Fields = FieldList<&EstimatorStatus::time_usec, &EstimatorStatus::vel_ratio,
                           &EstimatorStatus::pos_horiz_ratio, &EstimatorStatus::pos_vert_ratio,
                           &EstimatorStatus::mag_ratio, &EstimatorStatus::hagl_ratio,
                           &EstimatorStatus::tas_ratio, &EstimatorStatus::pos_horiz_accuracy,
                           &EstimatorStatus::pos_vert_accuracy, &EstimatorStatus::flags>;
  using Extensions = FieldList<>;
};

struct EkfStatusReport {
  static constexpr MessageName kMessage{"EKF_STATUS_REPORT", 193};
  float velocity_variance = 0.0F;
  float pos_horiz_variance = 0.0F;
  float pos_vert_variance = 0.0F;
  float compass_variance = 0.0F;
  float terrain_alt_variance = 0.0F;
  std::uint16_t flags = 0;
  float airspeed_variance = 0.0F;
  using Fields =
      FieldList<&EkfStatusReport::velocity_variance, &EkfStatusReport::pos_horiz_variance,
                &EkfStatusReport::pos_vert_variance, &EkfStatusReport::compass_variance,
                &EkfStatusReport::terrain_alt_variance, &EkfStatusReport::flags>;
  using Extensions = FieldList<&EkfStatusReport::airspeed_variance>;
};

struct DistanceSensor {
  static constexpr MessageName kMessage{"DISTANCE_SENSOR", 132};
  std::uint32_t time_boot_ms = 0;      ///< [ms]
  std::uint16_t min_distance = 0;      ///< [cm]
  std::uint16_t max_distance = 0;      ///< [cm]
  std::uint16_t current_distance = 0;  ///< [cm]
  std::uint8_t type = 0;
  std::uint8_t id = 0;
  std::uint8_t orientation = 0;
  std::uint8_t covariance = 0;  ///< [cm^2]
  float horizontal_fov = 0.0F;  ///< [rad]
  float vertical_fov = 0.0F;    ///< [rad]
  std::array<float, 4> quaternion{};
  std::uint8_t signal_quality = 0;  ///< [%]
  using Fields = FieldList<&DistanceSensor::time_boot_ms, &DistanceSensor::min_distance,
                           &DistanceSensor::max_distance, &DistanceSensor::current_distance,
                           &DistanceSensor::type, &DistanceSensor::id, &DistanceSensor::orientation,
                           &DistanceSensor::covariance>;
  using Extensions = FieldList<&DistanceSensor::horizontal_fov, &DistanceSensor::vertical_fov,
                               &DistanceSensor::quaternion, &DistanceSensor::signal_quality>;
};

}  // namespace vantage::wire::mavlink
