#pragma once

#include <array>
#include <cstdint>

#include "wire/mavlink/field_list.hpp"
#include "wire/mavlink/messages_motion.hpp"

// Commands to a vehicle and its answers. Members are in wire order, with the names, units and types
// of the message definitions (common.xml, ardupilotmega.xml).

namespace vantage::wire::mavlink {

struct SetMode {
  static constexpr MessageName kMessage{"SET_MODE", 11};
  std::uint32_t custom_mode = 0;
  std::uint8_t target_system = 0;
  std::uint8_t base_mode = 0;
  using Fields = FieldList<&SetMode::custom_mode, &SetMode::target_system, &SetMode::base_mode>;
  using Extensions = FieldList<>;
};

struct CommandInt {
  static constexpr MessageName kMessage{"COMMAND_INT", 75};
  float param1 = 0.0F;
  float param2 = 0.0F;
  float param3 = 0.0F;
  float param4 = 0.0F;
  std::int32_t x = 0;
  std::int32_t y = 0;
  float z = 0.0F;
  std::uint16_t command = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t frame = 0;
  std::uint8_t current = 0;
  std::uint8_t autocontinue = 0;
  using Fields =
      FieldList<&CommandInt::param1, &CommandInt::param2, &CommandInt::param3, &CommandInt::param4,
                &CommandInt::x, &CommandInt::y, &CommandInt::z, &CommandInt::command,
                &CommandInt::target_system, &CommandInt::target_component, &CommandInt::frame,
                &CommandInt::current, &CommandInt::autocontinue>;
  using Extensions = FieldList<>;
};

struct CommandLong {
  static constexpr MessageName kMessage{"COMMAND_LONG", 76};
  float param1 = 0.0F;
  float param2 = 0.0F;
  float param3 = 0.0F;
  float param4 = 0.0F;
  float param5 = 0.0F;
  float param6 = 0.0F;
  float param7 = 0.0F;
  std::uint16_t command = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t confirmation = 0;
  using Fields = FieldList<&CommandLong::param1, &CommandLong::param2, &CommandLong::param3,
                           &CommandLong::param4, &CommandLong::param5, &CommandLong::param6,
                           &CommandLong::param7, &CommandLong::command, &CommandLong::target_system,
                           &CommandLong::target_component, &CommandLong::confirmation>;
  using Extensions = FieldList<>;
};

struct CommandAck {
  static constexpr MessageName kMessage{"COMMAND_ACK", 77};
  std::uint16_t command = 0;
  std::uint8_t result = 0;
  std::uint8_t progress = 0;  ///< [%]
  std::int32_t result_param2 = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  using Fields = FieldList<&CommandAck::command, &CommandAck::result>;
  using Extensions = FieldList<&CommandAck::progress, &CommandAck::result_param2,
                               &CommandAck::target_system, &CommandAck::target_component>;
};

struct ManualControl {
  static constexpr MessageName kMessage{"MANUAL_CONTROL", 69};
  std::int16_t x = 0;
  std::int16_t y = 0;
  std::int16_t z = 0;
  std::int16_t r = 0;
  std::uint16_t buttons = 0;
  std::uint8_t target = 0;
  std::uint16_t buttons2 = 0;
  std::uint8_t enabled_extensions = 0;
  std::int16_t s = 0;
  std::int16_t t = 0;
  std::int16_t aux1 = 0;
  std::int16_t aux2 = 0;
  std::int16_t aux3 = 0;
  std::int16_t aux4 = 0;
  std::int16_t aux5 = 0;
  std::int16_t aux6 = 0;
  using Fields = FieldList<&ManualControl::x, &ManualControl::y, &ManualControl::z,
                           &ManualControl::r, &ManualControl::buttons, &ManualControl::target>;
  using Extensions =
      FieldList<&ManualControl::buttons2, &ManualControl::enabled_extensions, &ManualControl::s,
                &ManualControl::t, &ManualControl::aux1, &ManualControl::aux2, &ManualControl::aux3,
                &ManualControl::aux4, &ManualControl::aux5, &ManualControl::aux6>;
};

struct SetAttitudeTarget {
  static constexpr MessageName kMessage{"SET_ATTITUDE_TARGET", 82};
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  std::array<float, 4> q{};
  float body_roll_rate = 0.0F;   ///< [rad/s]
  float body_pitch_rate = 0.0F;  ///< [rad/s]
  float body_yaw_rate = 0.0F;    ///< [rad/s]
  float thrust = 0.0F;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t type_mask = 0;
  std::array<float, 3> thrust_body{};
  using Fields = FieldList<&SetAttitudeTarget::time_boot_ms, &SetAttitudeTarget::q,
                           &SetAttitudeTarget::body_roll_rate, &SetAttitudeTarget::body_pitch_rate,
                           &SetAttitudeTarget::body_yaw_rate, &SetAttitudeTarget::thrust,
                           &SetAttitudeTarget::target_system, &SetAttitudeTarget::target_component,
                           &SetAttitudeTarget::type_mask>;
  using Extensions = FieldList<&SetAttitudeTarget::thrust_body>;
};

/// Common first fields of both position set-point messages.
struct PositionTarget : LocalMotion {
  float afx = 0.0F;       ///< [m/s/s]
  float afy = 0.0F;       ///< [m/s/s]
  float afz = 0.0F;       ///< [m/s/s]
  float yaw = 0.0F;       ///< [rad]
  float yaw_rate = 0.0F;  ///< [rad/s]
  std::uint16_t type_mask = 0;
  using TargetFields = Joined<
      LocalMotion::MotionFields,
      FieldList<&PositionTarget::afx, &PositionTarget::afy, &PositionTarget::afz,
                &PositionTarget::yaw, &PositionTarget::yaw_rate, &PositionTarget::type_mask>>;
};

struct SetPositionTargetLocalNed : PositionTarget {
  static constexpr MessageName kMessage{"SET_POSITION_TARGET_LOCAL_NED", 84};
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t coordinate_frame = 0;
  using Fields = Joined<TargetFields, FieldList<&SetPositionTargetLocalNed::target_system,
                                                &SetPositionTargetLocalNed::target_component,
                                                &SetPositionTargetLocalNed::coordinate_frame>>;
  using Extensions = FieldList<>;
};

struct PositionTargetLocalNed : PositionTarget {
  static constexpr MessageName kMessage{"POSITION_TARGET_LOCAL_NED", 85};
  std::uint8_t coordinate_frame = 0;
  using Fields = Joined<TargetFields, FieldList<&PositionTargetLocalNed::coordinate_frame>>;
  using Extensions = FieldList<>;
};

}  // namespace vantage::wire::mavlink
