#pragma once

#include <optional>
#include <random>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "core/pose.hpp"
#include "models/sensor/kind.hpp"
#include "models/target/target_model.hpp"

// Gaussian sensors, z = h(x, y) + v with v ~ N(0, V(x, y)): the five of the dissertation and
// whatever has a law (models/sensor/law.hpp). Every one measures a target's position only. A target
// has a planar position (2 rows: it stands on the ground, z = 0) or one in space (3 rows). Nothing
// here allocates.

namespace vantage::models {

inline constexpr int kMaxMeasurementDim = 3;
using PositionVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;
using PositionMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
using MeasurementVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;
using MeasurementMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
/// ∂z/∂state or ∂z/∂position: up to 3 × 4.
using MeasurementJacobian =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, kUnaligned, 3, kMaxTargetDim>;

/// Where a sensor is: the pose of its vehicle seen from above, and its height above the ground.
struct Viewpoint {
  Pose2 world_from_body;
  double height_m = 0.0;
};
/// Between two of them, in space.
double distance_m(const Viewpoint& a, const Viewpoint& b);

/// Systematic error of a ranging sensor: it reports range_scale · true range + range_bias_m.
struct RangeCalibration {
  double range_scale = 1.0;
  double range_bias_m = 0.0;
};

/// One sensor. Ranges are horizontal for planar targets, in space for targets with three
/// coordinates. Angles are of the horizontal plane.
struct SensorModel {
  SensorKind kind = SensorKind::kRangeBearing;  ///< what the rest means, and which of it matters
  double range_max_m = 10.0;    ///< a target at this range or beyond gives no measurement
  double range_min_m = 0.0;     ///< nor one nearer than this; a bearing sensor needs it > 0, and
                                ///< of the horizontal distance, which is where it is singular
  double fov_rad = 2.0 * kPi;   ///< full angle φ; a target with |bearing| ≥ φ/2 is not seen
                                ///< (a full turn sees everything)
  double range_sigma_m = 0.15;  ///< 1σ of a range
  double bearing_sigma_rad = radians(5.0);  ///< 1σ of a bearing
  double position_sigma_m = 0.1;            ///< 1σ of each coordinate of a position
  double pixel_sigma = 1.0;                 ///< 1σ of each image coordinate
  double focal_length_pixels = 500.0;       ///< K = diag(f, f) with the principal point at 0
  double camera_tilt_rad = kPi / 2;         ///< 0 looks along body x, π/2 straight down
  double depth_min_m = 0.05;  ///< a camera sees nothing nearer than this along its axis
  /// Range and bearing variances grow linearly in range, V = V_max · max(floor, r / range_max),
  /// up to the full σ² at range_max (dissertation after eq. 3.8); false: constant.
  bool variance_grows_with_range = false;
  double variance_floor = 0.1;
  RangeCalibration calibration;

  /// Rows of z for a target with `position_dim` coordinates.
  [[nodiscard]] int measurement_dim(int position_dim) const;
};

/// What a sensor says of one target.
struct Measurement {
  MeasurementVector z;  ///< position: target in the body frame, m; range: m; bearing: rad from
                        ///< body x; range-bearing: (m, rad); camera: image coordinates, pixels
  MeasurementMatrix V;  ///< covariance of z
};

/// True when range, field of view and least distance allow a measurement. Line of sight is the
/// world's business (models/world).
bool in_view(const SensorModel& sensor, const Viewpoint& from,
             const PositionVector& target_world_m);

/// h(x, y), calibrated: what a noise-free sensor would report. Precondition: in_view, or at least
/// a target that is not at the sensor itself.
MeasurementVector observe(const SensorModel& sensor, const Viewpoint& from,
                          const PositionVector& target_world_m);

/// V(x, y): covariance of the noise.
MeasurementMatrix noise_covariance(const SensorModel& sensor, const Viewpoint& from,
                                   const PositionVector& target_world_m);

/// ∂h/∂position, measurement_dim × position_dim, including the calibration's scale.
MeasurementJacobian observation_jacobian(const SensorModel& sensor, const Viewpoint& from,
                                         const PositionVector& target_world_m);

/// z − ẑ, bearings wrapped into (−π, π]. Never subtract bearings by hand.
MeasurementVector innovation(const SensorModel& sensor, const MeasurementVector& z,
                             const MeasurementVector& z_expected);

/// Sensor information matrix M = Hᵀ V⁻¹ H about `target_world_m`, position_dim × position_dim;
/// zero when the target is not in_view. Source: dissertation eq. 2.19–2.30, 3.6.
PositionMatrix information(const SensorModel& sensor, const Viewpoint& from,
                           const PositionVector& target_world_m);

/// An upper bound of information() over every viewpoint within `reach_m` (horizontally) of `from`
/// at any heading: a multiple of the identity, returned as that multiple; 0 when no such viewpoint
/// can see the target; +∞ for a bearing sensor without a least range that may stand over the
/// target. Rounded outwards by a nanometre, so that sums of steps stay inside. Source: dissertation
/// app. G with the corrections of 2.29 (r² for r).
double information_bound(const SensorModel& sensor, const Viewpoint& from, double reach_m,
                         const PositionVector& target_world_m);

/// One noisy measurement of a target that is in view.
Measurement sample(const SensorModel& sensor, const Viewpoint& from,
                   const PositionVector& target_world_m, std::mt19937_64& rng);

/// The target position that explains `z` exactly; nullopt for sensors that cannot tell (range or
/// bearing alone) and for a z that no target explains. A camera's ray is met with the ground
/// plane, and so is the range of a target in space, whose elevation a bearing does not tell.
std::optional<PositionVector> position_from(const SensorModel& sensor, const Viewpoint& from,
                                            const MeasurementVector& z, int position_dim);

}  // namespace vantage::models
