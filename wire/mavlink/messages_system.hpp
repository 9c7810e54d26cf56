#pragma once

#include <array>
#include <cstdint>

#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/field_list.hpp"

// Identity, status, parameters and texts of a vehicle. Members are in wire order, with the names,
// units and types of the message definitions (common.xml, ardupilotmega.xml).

namespace vantage::wire::mavlink {

struct Heartbeat {
  static constexpr MessageName kMessage{"HEARTBEAT", 0};
  std::uint32_t custom_mode = 0;
  std::uint8_t type = 0;
  std::uint8_t autopilot = 0;
  std::uint8_t base_mode = 0;
  std::uint8_t system_status = 0;
  std::uint8_t mavlink_version = 0;
  using Fields =
      FieldList<&Heartbeat::custom_mode, &Heartbeat::type, &Heartbeat::autopilot,
                &Heartbeat::base_mode, &Heartbeat::system_status, &Heartbeat::mavlink_version>;
  using Extensions = FieldList<>;
};

/// Returns the heartbeat of a peer that does not fly, such as a ground station; `type` is MAV_TYPE.
constexpr Heartbeat heartbeat_of(std::uint8_t type) {
  Heartbeat heartbeat;
  heartbeat.type = type;
  heartbeat.autopilot = autopilot::kNone;
  heartbeat.system_status = kStateActive;
  heartbeat.mavlink_version = 3;
  return heartbeat;
}

struct SysStatus {
  static constexpr MessageName kMessage{"SYS_STATUS", 1};
  std::uint32_t onboard_control_sensors_present = 0;
  std::uint32_t onboard_control_sensors_enabled = 0;
  std::uint32_t onboard_control_sensors_health = 0;
  std::uint16_t load = 0;             ///< [d%]
  std::uint16_t voltage_battery = 0;  ///< [mV]
  std::int16_t current_battery = 0;   ///< [cA]
  std::uint16_t drop_rate_comm = 0;   ///< [c%]
  std::uint16_t errors_comm = 0;
  std::uint16_t errors_count1 = 0;
  std::uint16_t errors_count2 = 0;
  std::uint16_t errors_count3 = 0;
  std::uint16_t errors_count4 = 0;
  std::int8_t battery_remaining = 0;  ///< [%]
  std::uint32_t onboard_control_sensors_present_extended = 0;
  std::uint32_t onboard_control_sensors_enabled_extended = 0;
  std::uint32_t onboard_control_sensors_health_extended = 0;
  using Fields = FieldList<
      &SysStatus::onboard_control_sensors_present, &SysStatus::onboard_control_sensors_enabled,
      &SysStatus::onboard_control_sensors_health, &SysStatus::load, &SysStatus::voltage_battery,
      &SysStatus::current_battery, &SysStatus::drop_rate_comm, &SysStatus::errors_comm,
      &SysStatus::errors_count1, &SysStatus::errors_count2, &SysStatus::errors_count3,
      &SysStatus::errors_count4, &SysStatus::battery_remaining>;
  using Extensions = FieldList<&SysStatus::onboard_control_sensors_present_extended,
                               &SysStatus::onboard_control_sensors_enabled_extended,
                               &SysStatus::onboard_control_sensors_health_extended>;
};

struct SystemTime {
  static constexpr MessageName kMessage{"SYSTEM_TIME", 2};
  std::uint64_t time_unix_usec = 0;  ///< [us]
  std::uint32_t time_boot_ms = 0;    ///< [ms]
  using Fields = FieldList<&SystemTime::time_unix_usec, &SystemTime::time_boot_ms>;
  using Extensions = FieldList<>;
};

struct Timesync {
  static constexpr MessageName kMessage{"TIMESYNC", 111};
  std::int64_t tc1 = 0;  ///< [ns]
  std::int64_t ts1 = 0;  ///< [ns]
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  using Fields = FieldList<&Timesync::tc1, &Timesync::ts1>;
  using Extensions = FieldList<&Timesync::target_system, &Timesync::target_component>;
};

struct ParamRequestRead {
  static constexpr MessageName kMessage{"PARAM_REQUEST_READ", 20};
  std::int16_t param_index = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::array<char, 16> param_id{};
  using Fields = FieldList<&ParamRequestRead::param_index, &ParamRequestRead::target_system,
                           &ParamRequestRead::target_component, &ParamRequestRead::param_id>;
  using Extensions = FieldList<>;
};

struct ParamValue {
  static constexpr MessageName kMessage{"PARAM_VALUE", 22};
  float param_value = 0.0F;
  std::uint16_t param_count = 0;
  std::uint16_t param_index = 0;
  std::array<char, 16> param_id{};
  std::uint8_t param_type = 0;
  using Fields =
      FieldList<&ParamValue::param_value, &ParamValue::param_count, &ParamValue::param_index,
                &ParamValue::param_id, &ParamValue::param_type>;
  using Extensions = FieldList<>;
};

struct ParamSet {
  static constexpr MessageName kMessage{"PARAM_SET", 23};
  float param_value = 0.0F;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::array<char, 16> param_id{};
  std::uint8_t param_type = 0;
  using Fields = FieldList<&ParamSet::param_value, &ParamSet::target_system,
                           &ParamSet::target_component, &ParamSet::param_id, &ParamSet::param_type>;
  using Extensions = FieldList<>;
};

struct Statustext {
  static constexpr MessageName kMessage{"STATUSTEXT", 253};
  std::uint8_t severity = 0;
  std::array<char, 50> text{};
  std::uint16_t id = 0;
  std::uint8_t chunk_seq = 0;
  using Fields = FieldList<&Statustext::severity, &Statustext::text>;
  using Extensions = FieldList<&Statustext::id, &Statustext::chunk_seq>;
};

struct AutopilotVersion {
  static constexpr MessageName kMessage{"AUTOPILOT_VERSION", 148};
  std::uint64_t capabilities = 0;
  std::uint64_t uid = 0;
  std::uint32_t flight_sw_version = 0;
  std::uint32_t middleware_sw_version = 0;
  std::uint32_t os_sw_version = 0;
  std::uint32_t board_version = 0;
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::array<std::uint8_t, 8> flight_custom_version{};
  std::array<std::uint8_t, 8> middleware_custom_version{};
  std::array<std::uint8_t, 8> os_custom_version{};
  std::array<std::uint8_t, 18> uid2{};
  using Fields =
      FieldList<&AutopilotVersion::capabilities, &AutopilotVersion::uid,
                &AutopilotVersion::flight_sw_version, &AutopilotVersion::middleware_sw_version,
                &AutopilotVersion::os_sw_version, &AutopilotVersion::board_version,
                &AutopilotVersion::vendor_id, &AutopilotVersion::product_id,
                &AutopilotVersion::flight_custom_version,
                &AutopilotVersion::middleware_custom_version, &AutopilotVersion::os_custom_version>;
  using Extensions = FieldList<&AutopilotVersion::uid2>;
};

struct MessageInterval {
  static constexpr MessageName kMessage{"MESSAGE_INTERVAL", 244};
  std::int32_t interval_us = 0;  ///< [us]
  std::uint16_t message_id = 0;
  using Fields = FieldList<&MessageInterval::interval_us, &MessageInterval::message_id>;
  using Extensions = FieldList<>;
};

}  // namespace vantage::wire::mavlink
