#pragma once

#include <cstdint>

// Constants of the MAVLink definitions that a driver and its simulated peer use. Source:
// common.xml, minimal.xml.

namespace vantage::wire::mavlink {

namespace command {
constexpr std::uint16_t kLand = 21;
constexpr std::uint16_t kTakeOff = 22;
constexpr std::uint16_t kSetMode = 176;
constexpr std::uint16_t kArmDisarm = 400;
constexpr std::uint16_t kSetMessageInterval = 511;
}  // namespace command

constexpr float kForceDisarm = 21196.0F;

namespace result {
constexpr std::uint8_t kAccepted = 0;
constexpr std::uint8_t kInProgress = 5;
}  // namespace result

/// Bits of SYS_STATUS.onboard_control_sensors_*.
constexpr std::uint32_t kSensorMotorOutputs = 1U << 15U;

namespace type {
constexpr std::uint8_t kAntennaTracker = 5;
constexpr std::uint8_t kGroundStation = 6;
constexpr std::uint8_t kOnboardController = 18;
constexpr std::uint8_t kGimbal = 26;
constexpr std::uint8_t kAdsb = 27;
/// first of the types camera, charging station, FLARM, servo, ODID
constexpr std::uint8_t kFirstAccessory = 30;
constexpr std::uint8_t kLastAccessory = 34;
/// first of the types battery, parachute, log, OSD, IMU, GPS, winch
constexpr std::uint8_t kFirstPart = 36;

/// True if MAV_TYPE `type` is a vehicle; false for a station, a companion computer or a part.
constexpr bool is_vehicle(std::uint8_t type) {
  const bool is_accessory = type >= kFirstAccessory && type <= kLastAccessory;
  return type != kAntennaTracker && type != kGroundStation && type != kOnboardController &&
         type != kGimbal && type != kAdsb && !is_accessory && (type < kFirstPart || type > 42);
}
}  // namespace type

namespace autopilot {
constexpr std::uint8_t kArdupilot = 3;
constexpr std::uint8_t kNone = 8;
constexpr std::uint8_t kPx4 = 12;
}  // namespace autopilot

constexpr std::uint8_t kComponentAutopilot = 1;
constexpr std::uint8_t kComponentOnboardComputer = 191;
constexpr std::uint8_t kArmedFlag = 128;
constexpr std::uint8_t kStateActive = 4;
constexpr std::uint8_t kEstimatorVision = 2;

namespace landed {
constexpr std::uint8_t kUnknown = 0;
constexpr std::uint8_t kOnGround = 1;
}  // namespace landed

namespace frame {
constexpr std::uint8_t kLocalNed = 1;
constexpr std::uint8_t kBodyNed = 8;
constexpr std::uint8_t kBodyFrd = 12;
constexpr std::uint8_t kLocalFrd = 20;
}  // namespace frame

/// Bits of type_mask in a position set-point, each of which disables fields, and the combinations
/// in use.
namespace mask {
constexpr std::uint16_t kIgnorePosition = 7;
constexpr std::uint16_t kIgnoreVelocity = 56;
constexpr std::uint16_t kIgnoreAcceleration = 448;
constexpr std::uint16_t kIsForce = 512;  ///< the acceleration is a force
constexpr std::uint16_t kIgnoreYaw = 1024;
constexpr std::uint16_t kIgnoreYawRate = 2048;
constexpr std::uint16_t kNothingIgnored = 0;
constexpr std::uint16_t kPositionAndYaw = kIgnoreVelocity | kIgnoreAcceleration | kIgnoreYawRate;
constexpr std::uint16_t kVelocityAndYawRate = kIgnorePosition | kIgnoreAcceleration | kIgnoreYaw;
}  // namespace mask

/// Flags of ESTIMATOR_STATUS and EKF_STATUS_REPORT.
namespace estimator {
constexpr std::uint16_t kAttitude = 1;
constexpr std::uint16_t kHorizontalVelocity = 2;
constexpr std::uint16_t kVerticalVelocity = 4;
constexpr std::uint16_t kRelativePosition = 8;
constexpr std::uint16_t kAbsolutePosition = 16;
constexpr std::uint16_t kHeight = 32;
constexpr std::uint16_t kConstantPosition = 128;
constexpr std::uint16_t kUninitialised = 1024;  ///< only in EKF_STATUS_REPORT
}  // namespace estimator

}  // namespace vantage::wire::mavlink
