#pragma once

#include <cstdint>
#include <string_view>
#include <tuple>

#include "wire/mavlink/messages_command.hpp"
#include "wire/mavlink/messages_external_pose.hpp"
#include "wire/mavlink/messages_simulator.hpp"
#include "wire/mavlink/messages_state.hpp"
#include "wire/mavlink/messages_system.hpp"

namespace vantage::wire::mavlink {

/// All supported messages, by ascending id.
using AllMessages =
    std::tuple<Heartbeat, SysStatus, SystemTime, SetMode, ParamRequestRead, ParamValue, ParamSet,
               Attitude, AttitudeQuaternion, LocalPositionNed, SetGpsGlobalOrigin, GpsGlobalOrigin,
               ManualControl, CommandInt, CommandLong, CommandAck, SetAttitudeTarget,
               SetPositionTargetLocalNed, PositionTargetLocalNed, HilActuatorControls,
               VisionPositionEstimate, VisionSpeedEstimate, ViconPositionEstimate, HilSensor,
               Timesync, DistanceSensor, AttPosMocap, BatteryStatus, AutopilotVersion,
               EkfStatusReport, EstimatorStatus, GpsInput, HomePosition, MessageInterval,
               ExtendedSysState, Statustext, Odometry>;

/// Properties of a message that a receiver needs to check a frame.
struct MessageInfo {
  std::string_view name;
  std::uint32_t id = 0;
  std::uint8_t crc_extra = 0;
  std::uint8_t base_bytes = 0;  ///< payload size without extensions
  std::uint8_t full_bytes = 0;  ///< payload size with extensions; both sizes are before truncation
};

/// Returns the properties of the message with this id; null when it is not in AllMessages.
const MessageInfo* find_message(std::uint32_t id);

}  // namespace vantage::wire::mavlink
