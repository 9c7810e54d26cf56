#pragma once

#include <vector>

#include <Eigen/Core>

#include "planner/problem/block_kernels.hpp"
#include "planner/problem/lanes.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// Viewpoints of the children of one node, in groups of four lanes.
struct Views {
  int count = 0;
  alignas(32) double x_m[kMaxControls] = {};
  alignas(32) double y_m[kMaxControls] = {};
  alignas(32) double cos_yaw[kMaxControls] = {};
  alignas(32) double sin_yaw[kMaxControls] = {};

  [[nodiscard]] int groups() const { return (count + kLanes - 1) / kLanes; }
};

/// Position information of a planar target from four viewpoints.
struct InformationLanes {
  Lanes m00;
  Lanes m01;
  Lanes m11;
};

/// Information that a robot's sensors give about a target at a known position:
/// models::information() summed over the sensors, tabulated so that one evaluation costs one
/// division. Includes line of sight.
///
/// Agrees with models/sensor to rounding (tested). Exactly at a sensor's limit, the visibility of a
/// target can differ from models/sensor because of rounding.
class SightTable {
 public:
  SightTable() { sensors_.reserve(8); }

  /// Tabulates the sensors and the world of `problem`, which must outlive the queries.
  void reset(const SearchProblem& problem);

  /// Returns the longest range of all sensors, m.
  [[nodiscard]] double range_max_m() const { return range_max_m_; }
  /// True if compute_lanes() supports every planar target: all sensors have a PlanarLaw.
  [[nodiscard]] bool has_lanes() const { return !lacks_planar_law_; }

  /// Adds the information that a measurement from `at` gives, in packed form, to `out`. Returns
  /// false if the target is not visible. The information is about the position; for a moving target
  /// and a sensor that measures velocity, it is about the full state, evaluated at the velocity
  /// `velocity_mps`.
  [[nodiscard]] bool add_information(const Eigen::Vector3d& target_m,
                                     const Eigen::Vector2d& velocity_mps, BlockLayout layout,
                                     const Pose2& at, double cos_yaw, double sin_yaw,
                                     PackedInformation& out) const;

  /// False if a planar target is certainly out of range. Precondition: has_lanes().
  [[nodiscard]] bool may_be_in_range(const Eigen::Vector3d& target_m, const Pose2& at) const {
    const double dx_m = target_m.x() - at.x_m;
    const double dy_m = target_m.y() - at.y_m;
    return dx_m * dx_m + dy_m * dy_m < range_max_m2_;
  }

  /// Computes the information about a planar target from the four views of `group`, and returns the
  /// mask of views that see it. Other views get zero; if no view sees it, `out` is not written.
  /// Does not check the line of sight. Precondition: has_lanes().
  [[nodiscard]] LaneMask compute_lanes(const Eigen::Vector3d& target_m, const Views& views,
                                       int group, InformationLanes& out) const;

  /// True if obstacles exist, so that line_of_sight() must be called.
  [[nodiscard]] bool has_obstacles() const { return has_obstacles_; }
  /// Returns the same result as models::line_of_sight(), but faster where the distance field
  /// decides.
  [[nodiscard]] bool line_of_sight(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;

 private:
  struct Sensor {
    double range_max2_m2 = 0.0;
    double range_min2_m2 = 0.0;
    double cos_half_fov = -2.0;  ///< −2: full circle
    double cos2_half_fov = 0.0;
    double along_sight = 0.0;       ///< 1/m²; information along the line of sight
    double across_sight = 0.0;      ///< 1/rad²; information across the sight line × distance²
    double isotropic_per_m2 = 0.0;  ///< 1/m²; information of a position sensor
    double growth_per_m = 0.0;      ///< 1/m; variance factor is max(floor, r · growth_per_m)
    double variance_floor = 1.0;
    /// true: the kind has no PlanarLaw, so information() is evaluated for each view
    bool lacks_planar_law = false;
    bool is_directional = true;  ///< false: a position sensor
    bool variance_grows = false;
  };
  [[nodiscard]] static bool add_planar_information(const Sensor& sensor, double dx_m, double dy_m,
                                                   double cos_yaw, double sin_yaw,
                                                   PackedInformation& sum);
  [[nodiscard]] static LaneMask visible_lanes(const Sensor& sensor, const Lanes& r2,
                                              const Lanes& along);

  const SearchProblem* problem_ = nullptr;
  std::vector<Sensor> sensors_;
  double range_max_m_ = 0.0;
  double range_max_m2_ = 0.0;  ///< square of range_max_m_
  bool lacks_planar_law_ = false;
  bool has_obstacles_ = false;
};

inline LaneMask SightTable::visible_lanes(const Sensor& sensor, const Lanes& r2,
                                          const Lanes& along) {
  const Lanes zero = {};
  const LaneMask in_range = (r2 < sensor.range_max2_m2) & (r2 >= sensor.range_min2_m2);
  if (sensor.cos_half_fov < -1.0) {
    return sensor.is_directional ? in_range & (r2 > zero) : in_range;
  }
  const Lanes along2 = along * along;
  const Lanes edge2 = sensor.cos2_half_fov * r2;
  return sensor.cos_half_fov >= 0.0 ? in_range & (along > zero) & (along2 > edge2)
                                    : in_range & ((along > zero) | (along2 < edge2));
}

inline LaneMask SightTable::compute_lanes(const Eigen::Vector3d& target_m, const Views& views,
                                          int group, InformationLanes& out) const {
  const Lanes zero = {};
  const int at = kLanes * group;
  const Lanes dx = target_m.x() - load(views.x_m + at);
  const Lanes dy = target_m.y() - load(views.y_m + at);
  const Lanes dx2 = dx * dx;
  const Lanes dy2 = dy * dy;
  const Lanes r2 = dx2 + dy2;
  LaneMask seen = {};
  if (bits(r2 < range_max_m2_) == 0) {
    return seen;
  }
  const Lanes along = dx * load(views.cos_yaw + at) + dy * load(views.sin_yaw + at);
  for (const Sensor& sensor : sensors_) {
    const LaneMask now = visible_lanes(sensor, r2, along);
    if (bits(now) == 0) {
      continue;
    }
    if (bits(seen) == 0) {
      out = {zero, zero, zero};
    }
    seen |= now;
    if (!sensor.is_directional) {
      const Lanes isotropic_per_m2 = now ? broadcast(sensor.isotropic_per_m2) : zero;
      out.m00 += isotropic_per_m2;
      out.m11 += isotropic_per_m2;
      continue;
    }
    Lanes per_r2 = 1.0 / r2;
    const Lanes across = sensor.across_sight * per_r2;
    if (sensor.variance_grows) {
      const Lanes growth = sqrt(r2) * sensor.growth_per_m;
      const Lanes floor = broadcast(sensor.variance_floor);
      per_r2 /= growth > floor ? growth : floor;
    }
    per_r2 = now ? per_r2 : zero;
    const Lanes side = now ? across : zero;
    const Lanes xx = dx2 * per_r2;
    const Lanes yy = dy2 * per_r2;
    out.m00 += sensor.along_sight * xx + side * yy;
    out.m01 += (sensor.along_sight - side) * (dx * dy * per_r2);
    out.m11 += sensor.along_sight * yy + side * xx;
  }
  return seen;
}

}  // namespace vantage::planner
