#pragma once

#include <array>
#include <limits>
#include <optional>
#include <random>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "core/pose.hpp"
#include "models/sensor/kind.hpp"
#include "models/target/target_model.hpp"

// Gaussian sensors, z = h(x, y) + v with v ~ N(0, V(x, y)): the five sensors of the dissertation
// and any other with a SensorLaw (models/sensor/law.hpp). They measure a target's position and, for
// kinds with measures_velocity(), its velocity. The position is planar (2 rows: on the ground, z =
// 0) or in space (3 rows). No function allocates.

namespace vantage::models {

inline constexpr int kMaxMeasurementDim = 3;
using PositionVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;
using PositionMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
using MeasurementVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;
using MeasurementMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
/// ∂z/∂state or ∂z/∂position, at most 3 × 4.
using MeasurementJacobian =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, kUnaligned, 3, kMaxTargetDim>;

/// The position of a sensor: the planar pose of its vehicle and its height above the ground.
struct Viewpoint {
  Pose2 world_from_body;
  double height_m = 0.0;
};
/// Returns the distance between two viewpoints in space, m.
double distance_m(const Viewpoint& a, const Viewpoint& b);

/// Largest number of parameters that one kind of sensor declares (SensorLaw::parameters).
inline constexpr int kMaxOwnParameters = 4;

/// Systematic error of a ranging sensor: it reports range_scale · true range + range_bias_m.
struct RangeCalibration {
  double range_scale = 1.0;
  double range_bias_m = 0.0;
};

/// Parameters of one sensor. Ranges are horizontal for planar targets and in space for targets with
/// three coordinates. Angles are in the horizontal plane.
struct SensorModel {
  SensorKind kind = SensorKind::kRangeBearing;  ///< determines which other fields are used
  double range_max_m = 10.0;  ///< targets at this range or beyond are not measured
  /// nearer targets are not measured; for a bearing sensor: > 0 and a horizontal distance, because
  /// bearings are singular at 0
  double range_min_m = 0.0;
  /// full angle φ; targets with |bearing| ≥ φ/2 are not seen (except with a full circle)
  double fov_rad = 2.0 * kPi;
  double range_sigma_m = 0.15;              ///< 1σ of a range
  double bearing_sigma_rad = radians(5.0);  ///< 1σ of a bearing
  double position_sigma_m = 0.1;            ///< 1σ of each coordinate of a position
  double pixel_sigma = 1.0;                 ///< 1σ of each image coordinate
  double focal_length_pixels = 500.0;       ///< K = diag(f, f) with the principal point at 0
  double camera_tilt_rad = kPi / 2;         ///< 0: along body x; π/2: straight down
  double depth_min_m = 0.05;                ///< minimum depth along the camera's axis
  /// Range and bearing variances grow linearly in range, V = V_max · max(floor, r / range_max),
  /// up to the full σ² at range_max (dissertation after eq. 3.8); false: constant.
  bool variance_grows_with_range = false;
  double variance_floor = 0.1;
  RangeCalibration calibration;
  /// Values of the kind's own parameters, in the order of SensorLaw::parameters; NaN: default.
  std::array<double, kMaxOwnParameters> own = {kUnset, kUnset, kUnset, kUnset};
  static constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

  /// Returns the rows of z for a target with `position_dim` coordinates.
  [[nodiscard]] int measurement_dim(int position_dim) const;
};

/// One measurement of one target.
struct Measurement {
  /// position: target in the body frame, m; range: m; bearing: rad from body x; range-bearing: (m,
  /// rad); camera: image coordinates, pixels; range-rate: (m, m/s)
  MeasurementVector z;
  MeasurementMatrix V;  ///< covariance of z
};

/// True if range, field of view and minimum distance allow a measurement. Line of sight is checked
/// in models/world.
bool in_view(const SensorModel& sensor, const Viewpoint& from,
             const PositionVector& target_world_m);

/// True if measurements depend on the target's velocity.
bool measures_velocity(const SensorModel& sensor);

/// Returns h(x, y), calibrated: the measurement of a noise-free sensor. The velocity only matters
/// if measures_velocity(). Precondition: the target is not at the sensor's own position (in_view()
/// implies this).
MeasurementVector observe(const SensorModel& sensor, const Viewpoint& from,
                          const PositionVector& target_world_m,
                          const Eigen::Vector2d& velocity_world_mps = Eigen::Vector2d::Zero());

/// Returns V(x, y), the covariance of the noise.
MeasurementMatrix noise_covariance(const SensorModel& sensor, const Viewpoint& from,
                                   const PositionVector& target_world_m);

/// Returns ∂h/∂position, measurement_dim × position_dim, including the calibration's scale.
MeasurementJacobian observation_jacobian(
    const SensorModel& sensor, const Viewpoint& from, const PositionVector& target_world_m,
    const Eigen::Vector2d& velocity_world_mps = Eigen::Vector2d::Zero());

/// Returns the velocity in a state (x, y, ẋ, ẏ); zero for a state without velocity.
Eigen::Vector2d velocity_of(const StateVector& target);

/// As observe(), for the state of a TargetModel: 2 or 3 rows of position, or (x, y, ẋ, ẏ).
MeasurementVector observe_state(const SensorModel& sensor, const Viewpoint& from,
                                const StateVector& target);

/// Returns ∂h/∂state, measurement_dim × rows of the state.
MeasurementJacobian state_jacobian(const SensorModel& sensor, const Viewpoint& from,
                                   const StateVector& target);

/// Returns z − ẑ with bearings wrapped into (−π, π]. Do not subtract bearings directly.
MeasurementVector innovation(const SensorModel& sensor, const MeasurementVector& z,
                             const MeasurementVector& z_expected);

/// Returns the sensor information matrix M = Hᵀ V⁻¹ H at `target_world_m`, position_dim ×
/// position_dim; zero if the target is not in_view. Source: dissertation eq. 2.19–2.30, 3.6.
PositionMatrix information(const SensorModel& sensor, const Viewpoint& from,
                           const PositionVector& target_world_m);

/// Returns the information about the state, Hᵀ V⁻¹ H with H = state_jacobian(); zero if the target
/// is not in_view. Its position block is information() if !measures_velocity().
StateMatrix state_information(const SensorModel& sensor, const Viewpoint& from,
                              const StateVector& target);

/// Returns an upper bound of information() over all viewpoints within `reach_m` (horizontally) of
/// `from` and all headings. The bound is a multiple of the identity; its factor is returned. The
/// factor is 0 if no such viewpoint can see the target. It is +∞ for a bearing sensor without a
/// minimum range that may be above the target. `reach_m` is enlarged by a nanometre to cover
/// accumulated rounding errors. With `speed_mps`, the bound applies to state_information() of every
/// state (position, velocity) at this position with at most this speed. Source: dissertation,
/// appendix G, with eq. 2.29 corrected (r² instead of r).
double information_bound(const SensorModel& sensor, const Viewpoint& from, double reach_m,
                         const PositionVector& target_world_m,
                         std::optional<double> speed_mps = std::nullopt);

/// Returns one noisy measurement of a target that is in view.
Measurement sample(const SensorModel& sensor, const Viewpoint& from,
                   const PositionVector& target_world_m, std::mt19937_64& rng,
                   const Eigen::Vector2d& velocity_world_mps = Eigen::Vector2d::Zero());

/// Returns the target position for which a noise-free measurement equals `z`. nullopt for sensors
/// that cannot determine it (only range or only bearing), and if no position gives `z`. If `z` does
/// not determine a position in space (camera ray; range and bearing without elevation), the target
/// is assumed to be on the ground plane.
std::optional<PositionVector> position_from(const SensorModel& sensor, const Viewpoint& from,
                                            const MeasurementVector& z, int position_dim);

}  // namespace vantage::models
