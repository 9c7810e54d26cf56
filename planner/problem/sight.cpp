#include "planner/problem/sight.hpp"

#include <algorithm>
#include <cmath>

#include "models/sensor/law.hpp"
#include "planner/problem/belief_table.hpp"

namespace vantage::planner {
namespace {

double square(double x) { return x * x; }

}  // namespace

void SightTable::reset(const SearchProblem& problem) {
  problem_ = &problem;
  sensors_.clear();
  range_max_m_ = 0.0;
  lacks_planar_law_ = false;
  for (const models::SensorModel& model : problem.sensors) {
    Sensor sensor;
    sensor.range_max2_m2 = square(model.range_max_m);
    sensor.range_min2_m2 = square(model.range_min_m);
    if (model.fov_rad < 2.0 * kPi) {
      sensor.cos_half_fov = std::cos(0.5 * model.fov_rad);
      sensor.cos2_half_fov = square(sensor.cos_half_fov);
    }
    if (const auto planar_law = model.kind.law().planar_law) {
      const models::PlanarLaw law = planar_law(model);
      sensor.along_sight = law.along_per_m2;
      sensor.across_sight = law.across_per_rad2;
      sensor.isotropic_per_m2 = law.isotropic_per_m2;
      sensor.is_directional = law.along_per_m2 > 0.0 || law.across_per_rad2 > 0.0;
      sensor.lacks_planar_law = sensor.is_directional && sensor.isotropic_per_m2 > 0.0;
      sensor.variance_grows = model.variance_grows_with_range;
      sensor.variance_floor = model.variance_floor;
      sensor.growth_per_m = 1.0 / model.range_max_m;
    } else {
      sensor.lacks_planar_law = true;
    }
    lacks_planar_law_ = lacks_planar_law_ || sensor.lacks_planar_law;
    range_max_m_ = std::max(range_max_m_, model.range_max_m);
    sensors_.push_back(sensor);
  }
  range_max_m2_ = square(range_max_m_);
  const models::World* const world = sight_world(problem);
  has_obstacles_ = world != nullptr && !world->obstacles.empty();
}

bool SightTable::add_planar_information(const Sensor& sensor, double dx_m, double dy_m,
                                        double cos_yaw, double sin_yaw, PackedInformation& sum) {
  const double r2 = dx_m * dx_m + dy_m * dy_m;
  if (r2 >= sensor.range_max2_m2 || r2 < sensor.range_min2_m2) {
    return false;
  }
  const bool all_around = sensor.cos_half_fov < -1.0;
  if (r2 == 0.0) {  // no direction: only an all-round position sensor sees the target
    if (sensor.is_directional || !all_around) {
      return false;
    }
  } else if (!all_around) {
    const double along = dx_m * cos_yaw + dy_m * sin_yaw;
    const double edge2 = sensor.cos2_half_fov * r2;
    if (sensor.cos_half_fov >= 0.0 ? !(along > 0.0 && along * along > edge2)
                                   : !(along > 0.0 || along * along < edge2)) {
      return false;
    }
  }
  if (!sensor.is_directional) {
    sum.m[0] += sensor.isotropic_per_m2;
    sum.m[2] += sensor.isotropic_per_m2;
    return true;
  }
  double per_r2 = 1.0 / r2;
  const double across = sensor.across_sight * per_r2;
  if (sensor.variance_grows) {
    per_r2 /= std::max(sensor.variance_floor, std::sqrt(r2) * sensor.growth_per_m);
  }
  const double xx = dx_m * dx_m * per_r2;
  const double xy = dx_m * dy_m * per_r2;
  const double yy = dy_m * dy_m * per_r2;
  sum.m[0] += sensor.along_sight * xx + across * yy;
  sum.m[1] += (sensor.along_sight - across) * xy;
  sum.m[2] += sensor.along_sight * yy + across * xx;
  return true;
}

bool SightTable::add_information(const Eigen::Vector3d& target_m,
                                 const Eigen::Vector2d& velocity_mps, BlockLayout layout,
                                 const Pose2& at, double cos_yaw, double sin_yaw,
                                 PackedInformation& out) const {
  const bool spatial = layout == BlockLayout::kSpatial;
  bool seen = false;
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    if (!spatial && !sensors_[s].lacks_planar_law) {
      seen = add_planar_information(sensors_[s], target_m.x() - at.x_m, target_m.y() - at.y_m,
                                    cos_yaw, sin_yaw, out) ||
             seen;
      continue;
    }
    const models::SensorModel& sensor = problem_->sensors[s];
    const models::Viewpoint from{at, problem_->height_m};
    const models::PositionVector target = target_m.head(spatial ? 3 : 2);
    if (!models::in_view(sensor, from, target)) {
      continue;
    }
    seen = true;
    if (layout == BlockLayout::kMoving && models::measures_velocity(sensor)) {
      models::StateVector state(4);
      state << target, velocity_mps;
      double packed[kMaxPacked];
      pack(layout, models::state_information(sensor, from, state), packed);
      for (int i = 0; i < kMaxPacked; ++i) {
        out.m[i] += packed[i];
      }
      out.is_of_state = true;
      continue;
    }
    const models::PositionMatrix M = models::information(sensor, from, target);
    double packed[6];
    pack(spatial ? BlockLayout::kSpatial : BlockLayout::kPlanar, M, packed);
    for (int i = 0; i < (spatial ? 6 : 3); ++i) {
      out.m[i] += packed[i];
    }
  }
  return seen && (!has_obstacles_ || line_of_sight(at.position_m(), target_m.head<2>()));
}

bool SightTable::line_of_sight(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
  if (problem_->field != nullptr) {  // advance through obstacle-free discs while they are large
    constexpr int kDiscsMax = 8;
    constexpr double kLeast_m = 0.1;
    constexpr double kInwards = 1.0 - 1e-6;  // allowance for the field's float rounding
    const Eigen::Vector2d d_m = b_m - a_m;
    const double length_m = d_m.norm();
    double gone_m = 0.0;
    for (int i = 0; i < kDiscsMax; ++i) {
      const double free_m =
          problem_->field->lower_bound_m(a_m + (gone_m / std::max(length_m, kLeast_m)) * d_m);
      if (free_m < kLeast_m) {
        break;
      }
      gone_m += kInwards * free_m;
      if (gone_m >= length_m) {
        return true;
      }
    }
  }
  return models::line_of_sight(*problem_->world, a_m, b_m);
}

}  // namespace vantage::planner
