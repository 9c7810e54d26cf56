#pragma once

#include <array>
#include <cstdint>

#include "wire/mavlink/field_list.hpp"
#include "wire/mavlink/messages_motion.hpp"

// External position and pose for a vehicle. Members are in wire order, with the names, units and
// types of the message definitions (common.xml, ardupilotmega.xml).

namespace vantage::wire::mavlink {

struct SetGpsGlobalOrigin {
  static constexpr MessageName kMessage{"SET_GPS_GLOBAL_ORIGIN", 48};
  std::int32_t latitude = 0;   ///< [degE7]
  std::int32_t longitude = 0;  ///< [degE7]
  std::int32_t altitude = 0;   ///< [mm]
  std::uint8_t target_system = 0;
  std::uint64_t time_usec = 0;  ///< [us]
  using Fields = FieldList<&SetGpsGlobalOrigin::latitude, &SetGpsGlobalOrigin::longitude,
                           &SetGpsGlobalOrigin::altitude, &SetGpsGlobalOrigin::target_system>;
  using Extensions = FieldList<&SetGpsGlobalOrigin::time_usec>;
};

struct VisionPositionEstimate : PoseEstimate {
  static constexpr MessageName kMessage{"VISION_POSITION_ESTIMATE", 102};
  std::uint8_t reset_counter = 0;
  using Extensions =
      Joined<PoseEstimate::Extensions, FieldList<&VisionPositionEstimate::reset_counter>>;
};

struct VisionSpeedEstimate {
  static constexpr MessageName kMessage{"VISION_SPEED_ESTIMATE", 103};
  std::uint64_t usec = 0;  ///< [us]
  float x = 0.0F;          ///< [m/s]
  float y = 0.0F;          ///< [m/s]
  float z = 0.0F;          ///< [m/s]
  std::array<float, 9> covariance{};
  std::uint8_t reset_counter = 0;
  using Fields = FieldList<&VisionSpeedEstimate::usec, &VisionSpeedEstimate::x,
                           &VisionSpeedEstimate::y, &VisionSpeedEstimate::z>;
  using Extensions =
      FieldList<&VisionSpeedEstimate::covariance, &VisionSpeedEstimate::reset_counter>;
};

struct ViconPositionEstimate : PoseEstimate {
  static constexpr MessageName kMessage{"VICON_POSITION_ESTIMATE", 104};
};

struct AttPosMocap {
  static constexpr MessageName kMessage{"ATT_POS_MOCAP", 138};
  std::uint64_t time_usec = 0;  ///< [us]
  std::array<float, 4> q{};
  float x = 0.0F;  ///< [m]
  float y = 0.0F;  ///< [m]
  float z = 0.0F;  ///< [m]
  std::array<float, 21> covariance{};
  using Fields = FieldList<&AttPosMocap::time_usec, &AttPosMocap::q, &AttPosMocap::x,
                           &AttPosMocap::y, &AttPosMocap::z>;
  using Extensions = FieldList<&AttPosMocap::covariance>;
};

struct GpsInput {
  static constexpr MessageName kMessage{"GPS_INPUT", 232};
  std::uint64_t time_usec = 0;     ///< [us]
  std::uint32_t time_week_ms = 0;  ///< [ms]
  std::int32_t lat = 0;            ///< [degE7]
  std::int32_t lon = 0;            ///< [degE7]
  float alt = 0.0F;                ///< [m]
  float hdop = 0.0F;
  float vdop = 0.0F;
  float vn = 0.0F;              ///< [m/s]
  float ve = 0.0F;              ///< [m/s]
  float vd = 0.0F;              ///< [m/s]
  float speed_accuracy = 0.0F;  ///< [m/s]
  float horiz_accuracy = 0.0F;  ///< [m]
  float vert_accuracy = 0.0F;   ///< [m]
  std::uint16_t ignore_flags = 0;
  std::uint16_t time_week = 0;
  std::uint8_t gps_id = 0;
  std::uint8_t fix_type = 0;
  std::uint8_t satellites_visible = 0;
  std::uint16_t yaw = 0;  ///< [cdeg]
  using Fields =
      FieldList<&GpsInput::time_usec, &GpsInput::time_week_ms, &GpsInput::lat, &GpsInput::lon,
                &GpsInput::alt, &GpsInput::hdop, &GpsInput::vdop, &GpsInput::vn, &GpsInput::ve,
                &GpsInput::vd, &GpsInput::speed_accuracy, &GpsInput::horiz_accuracy,
                &GpsInput::vert_accuracy, &GpsInput::ignore_flags, &GpsInput::time_week,
                &GpsInput::gps_id, &GpsInput::fix_type, &GpsInput::satellites_visible>;
  using Extensions = FieldList<&GpsInput::yaw>;
};

struct Odometry {
  static constexpr MessageName kMessage{"ODOMETRY", 331};
  std::uint64_t time_usec = 0;  ///< [us]
  float x = 0.0F;               ///< [m]
  float y = 0.0F;               ///< [m]
  float z = 0.0F;               ///< [m]
  std::array<float, 4> q{};
  float vx = 0.0F;          ///< [m/s]
  float vy = 0.0F;          ///< [m/s]
  float vz = 0.0F;          ///< [m/s]
  float rollspeed = 0.0F;   ///< [rad/s]
  float pitchspeed = 0.0F;  ///< [rad/s]
  float yawspeed = 0.0F;    ///< [rad/s]
  std::array<float, 21> pose_covariance{};
  std::array<float, 21> velocity_covariance{};
  std::uint8_t frame_id = 0;
  std::uint8_t child_frame_id = 0;
  std::uint8_t reset_counter = 0;
  std::uint8_t estimator_type = 0;
  std::int8_t quality = 0;  ///< [%]
  using Fields =
      FieldList<&Odometry::time_usec, &Odometry::x, &Odometry::y, &Odometry::z, &Odometry::q,
                &Odometry::vx, &Odometry::vy, &Odometry::vz, &Odometry::rollspeed,
                &Odometry::pitchspeed, &Odometry::yawspeed, &Odometry::pose_covariance,
                &Odometry::velocity_covariance, &Odometry::frame_id, &Odometry::child_frame_id>;
  using Extensions =
      FieldList<&Odometry::reset_counter, &Odometry::estimator_type, &Odometry::quality>;
};

}  // namespace vantage::wire::mavlink
