#pragma once

#include <array>
#include <cstdint>

#include "wire/mavlink/field_list.hpp"

// Common first fields of several messages, in wire order.

namespace vantage::wire::mavlink {

/// Position and velocity in the local frame, estimated or commanded.
struct LocalMotion {
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  float x = 0.0F;                  ///< [m]
  float y = 0.0F;                  ///< [m]
  float z = 0.0F;                  ///< [m]
  float vx = 0.0F;                 ///< [m/s]
  float vy = 0.0F;                 ///< [m/s]
  float vz = 0.0F;                 ///< [m/s]
  using MotionFields =
      FieldList<&LocalMotion::time_boot_ms, &LocalMotion::x, &LocalMotion::y, &LocalMotion::z,
                &LocalMotion::vx, &LocalMotion::vy, &LocalMotion::vz>;
};

/// A pose measured by an external system.
struct PoseEstimate {
  std::uint64_t usec = 0;  ///< [us]
  float x = 0.0F;          ///< [m]
  float y = 0.0F;          ///< [m]
  float z = 0.0F;          ///< [m]
  float roll = 0.0F;       ///< [rad]
  float pitch = 0.0F;      ///< [rad]
  float yaw = 0.0F;        ///< [rad]
  std::array<float, 21> covariance{};
  using Fields =
      FieldList<&PoseEstimate::usec, &PoseEstimate::x, &PoseEstimate::y, &PoseEstimate::z,
                &PoseEstimate::roll, &PoseEstimate::pitch, &PoseEstimate::yaw>;
  using Extensions = FieldList<&PoseEstimate::covariance>;
};

}  // namespace vantage::wire::mavlink
