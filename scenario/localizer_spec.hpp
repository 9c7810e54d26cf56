#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/angle.hpp"
#include "models/world/world.hpp"

// Section `localizer` of a scenario as values: what a robot needs to know to compute its own pose
// from odometry, landmarks and teammates.

namespace vantage::scenario {

/// Landmark at a known position.
struct LandmarkSpec {
  int id = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< world frame
};

/// Geometry and latency of a sensor that measures range and bearing of landmarks and teammates.
struct SightingSpec {
  /// True: the reported range is the depth along the sensor's axis, d · cos(bearing − axis).
  bool range_is_depth = false;
  double range_scale = 1.0;         ///< reported range = scale · range + offset
  double range_offset_m = 0.0;      ///< m
  double axis_rad = 0.0;            ///< rad, from the body's x axis; direction of the depth
  double bearing_offset_rad = 0.0;  ///< rad; reported bearing − true bearing
  double forward_m = 0.0;           ///< m; position of the sensor on the body's x axis
  double stamp_delay_s = 0.0;       ///< s; stamp − time of the exposure
};

/// Response of a robot to its commanded velocity.
struct DriveSpec {
  double delay_s = 0.0;          ///< s; time until a command begins to act
  double lag_s = 0.0;            ///< s; time constant of the first-order response
  double speed_scale = 1.0;      ///< actual speed / commanded speed
  double turn_scale = 1.0;       ///< actual turn rate / commanded turn rate
  double turn_bias_radps = 0.0;  ///< rad/s; turn rate without command, while driving
};

/// 1σ of the errors of odometry. Errors consist of white noise and of slowly varying errors.
struct OdometryNoiseSpec {
  double turn_sigma_rad_per_sqrt_s = 0.027;  ///< rad/√s; white noise of the heading
  double turn_sigma_per_sqrt_rad = 0.18;     ///< √rad; white noise of the heading per turn
  double slide_sigma_per_sqrt_m = 0.03;      ///< √m; white noise of the position per distance
  double turn_drift_radps = 0.005;           ///< rad/s; slowly varying error of the turn rate
  double turn_drift_time_s = 10.0;           ///< s; correlation time of turn_drift_radps
  double speed_drift_share = 0.17;           ///< slowly varying relative error of the speed
  double speed_drift_time_s = 15.0;          ///< s; correlation time of speed_drift_share
};

/// 1σ of the errors of sightings. The values are enlarged to allow for errors that are correlated
/// in time.
struct SightingNoiseSpec {
  double range_sigma_m = 0.0375;  ///< m, at distance 0
  /// 1/m; this factor times the squared distance is added to the 1σ at distance 0
  double range_sigma_per_m = 0.0009;
  double bearing_sigma_rad = 0.008;        ///< rad, for a distant body
  double across_sigma_m = 0.007;           ///< m; error across the line of sight
  double frame_bearing_sigma_rad = 0.018;  ///< rad; error that all bearings of a frame share
  double teammate_sigma_m = 0.01;          ///< m; additional error of a teammate's position
};

/// Parameters of one robot.
struct LocalizedRobotSpec {
  std::string name;  ///< name of the robot in the scenario
  int id = 0;        ///< id under which teammates detect this robot
  SightingSpec sightings;
  DriveSpec drive;
};

/// Rules for vehicles that motion capture does not see and that navigate by POSE_R. Only ground
/// robots may do so, because POSE_R has no height.
struct PoseSafetySpec {
  bool rovers_may_drive = false;  ///< false: rovers stop without motion capture
  double sigma_hold_m = 0.15;     ///< m; a rover holds while the 1σ of its position is larger
  double sigma_stop_m = 0.4;      ///< m; larger 1σ: a rover holds until the operator sends follow
  double margin_sigmas = 3.0;  ///< distances to fence, obstacles, bodies are reduced by this · 1σ
};

/// Simulated odometer of each robot. Its white noise and slowly varying errors are those of
/// OdometryNoiseSpec times `noise_scale`; the other errors are unknown to the localisers.
struct SimulatedOdometerSpec {
  double rate_hz = 20.0;         ///< Hz; reports per second
  double noise_scale = 1.0;      ///< factor of the errors in OdometryNoiseSpec
  double speed_scale = 1.0;      ///< reported displacement / true displacement
  double turn_scale = 1.0;       ///< reported turn / true turn
  double turn_bias_radps = 0.0;  ///< rad/s; reported turn rate minus true turn rate
  double slips_per_min = 0.0;    ///< mean number of slips per minute
  double slip_s = 0.5;           ///< s; duration of a slip
  double slip_share = 0.5;       ///< reported displacement in a slip = (1 + slip_share) · true one
};

/// Simulated sensor of landmarks and teammates of each robot. Its errors are those of
/// SightingNoiseSpec times `noise_scale`.
struct SimulatedSightingsSpec {
  double rate_hz = 5.0;                ///< Hz; frames per second
  double noise_scale = 1.0;            ///< factor of the errors in SightingNoiseSpec
  double range_min_m = 0.2;            ///< m
  double range_max_m = 4.0;            ///< m
  double fov_rad = 2.0 * kPi;          ///< rad; full angle, about the body's x axis
  double detection_probability = 1.0;  ///< for each landmark or teammate in view
};

/// Time and area in which the simulated motion capture does not see bodies.
struct MocapOutageSpec {
  double from_s = 0.0;  ///< s since the start, or since take-off
  double to_s = std::numeric_limits<double>::infinity();
  bool after_take_off = false;  ///< true: times start when all robots have reached their height
  std::optional<models::Rectangle> area;  ///< absent: everywhere
};

/// Simulation of what the localisers receive.
struct LocalizerSimulationSpec {
  SimulatedOdometerSpec odometry;
  SimulatedSightingsSpec sightings;
  std::vector<MocapOutageSpec> mocap_withheld;
};

/// Parameters of the localisers of all robots.
struct LocalizerSpec {
  std::vector<LandmarkSpec> landmarks;
  int unknown_landmarks_max = 0;  ///< largest number of landmarks at unknown positions
  std::vector<LocalizedRobotSpec> robots;
  OdometryNoiseSpec odometry_noise;
  SightingNoiseSpec sighting_noise;
  PoseSafetySpec safety;
  /// Present: the simulator publishes odometry and sightings, and simulated vehicles and sensors
  /// use POSE_R instead of motion capture.
  std::optional<LocalizerSimulationSpec> simulation = std::nullopt;
};

}  // namespace vantage::scenario
