#pragma once

#include <vector>

#include <Eigen/Core>

#include "planner/problem/block_kernels.hpp"
#include "planner/problem/lanes.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// Poses that are looked from, side by side: the children of one node.
struct Views {
  int count = 0;
  alignas(32) double x_m[kMaxControls] = {};
  alignas(32) double y_m[kMaxControls] = {};
  alignas(32) double cos_yaw[kMaxControls] = {};
  alignas(32) double sin_yaw[kMaxControls] = {};

  [[nodiscard]] int groups() const { return (count + kLanes - 1) / kLanes; }
};

/// Position information of a planar target, four looks side by side.
struct InformationLanes {
  Lanes m00;
  Lanes m01;
  Lanes m11;
};

/// What a robot's sensors tell of a target at a known place: models::information() summed over the
/// sensors, tabled so that a look costs one division. Line of sight included.
///
/// Agrees with models/sensor to rounding (tested); a target within rounding of a sensor's limit may
/// be seen by the one and not by the other.
class SightTable {
 public:
  SightTable() { sensors_.reserve(8); }

  /// Tables the sensors and the world of `problem`, which must outlive the queries.
  void reset(const SearchProblem& problem);

  /// Longest range over all sensors, m.
  [[nodiscard]] double range_max_m() const { return range_max_m_; }
  /// True when look_at() answers for every planar target: no sensor is a camera.
  [[nodiscard]] bool has_lanes() const { return !asks_information_; }

  /// Information of one look from `at`, packed, added to `out`; false when it is not seen.
  [[nodiscard]] bool look(const Eigen::Vector3d& target_m, bool spatial, const Pose2& at,
                          double cos_yaw, double sin_yaw, PackedInformation& out) const;

  /// Information about a planar target from the views 4·group …, and who of them sees it; others
  /// give zero. Line of sight is left to the caller. Precondition: has_lanes().
  [[nodiscard]] LaneMask look_at(const Eigen::Vector3d& target_m, const Views& views, int group,
                                 InformationLanes& out) const;

  /// True when something may stand between two points: whether line_of_sight() need be asked.
  [[nodiscard]] bool has_obstacles() const { return has_obstacles_; }
  /// As models::line_of_sight(), by the distance field where that can tell.
  [[nodiscard]] bool line_of_sight(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;

 private:
  struct Sensor {
    double range_max2_m2 = 0.0;
    double range_min2_m2 = 0.0;
    double cos_half_fov = -2.0;  ///< −2: sees all around
    double cos2_half_fov = 0.0;
    double along_sight = 0.0;   ///< information along the line of sight, 1/m²
    double across_sight = 0.0;  ///< and across it, times the squared distance
    double all_ways = 0.0;      ///< of a position sensor
    double growth_per_m = 0.0;  ///< variance is max(floor, r · growth_per_m) times the full one
    double variance_floor = 1.0;
    bool asks_information = false;  ///< has no planar law: information() is asked look by look
    bool tells_direction = true;    ///< false: a position sensor
    bool variance_grows = false;
  };
  [[nodiscard]] static bool look_planar(const Sensor& sensor, double dx_m, double dy_m,
                                        double cos_yaw, double sin_yaw, PackedInformation& sum);
  [[nodiscard]] static LaneMask sees(const Sensor& sensor, const Lanes& r2, const Lanes& along);

  const SearchProblem* problem_ = nullptr;
  std::vector<Sensor> sensors_;
  double range_max_m_ = 0.0;
  bool asks_information_ = false;
  bool has_obstacles_ = false;
};

}  // namespace vantage::planner
