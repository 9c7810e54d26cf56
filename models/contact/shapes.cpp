#include "models/contact/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vantage::models {

Box3 box_of(const Obstacle& obstacle) {
  return {{obstacle.footprint.min_m.x(), obstacle.footprint.min_m.y(), 0.0},
          {obstacle.footprint.max_m.x(), obstacle.footprint.max_m.y(), obstacle.height_m}};
}

double signed_distance_m(const Box3& box, const Eigen::Vector3d& p_m) {
  const Eigen::Vector3d outside_m = (box.min_m - p_m).cwiseMax(p_m - box.max_m);
  const double deepest_m = outside_m.maxCoeff();
  return deepest_m <= 0.0 ? deepest_m : outside_m.cwiseMax(0.0).norm();
}

double swept_distance_m(const Box3& box, const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  constexpr double kToleranceM = 1e-9;
  const Eigen::Vector3d motion_m = b_m - a_m;
  const auto distance_m = [&](double s) { return signed_distance_m(box, a_m + s * motion_m); };
  double least_m = std::min(distance_m(0.0), distance_m(1.0));
  double low = 0.0;
  double high = 1.0;
  double s1 = 1.0 - (std::numbers::phi - 1.0);
  double s2 = std::numbers::phi - 1.0;
  double d1 = distance_m(s1);
  double d2 = distance_m(s2);
  while ((high - low) * motion_m.norm() > kToleranceM) {  // golden-section search
    if (d1 < d2) {
      high = s2;
      s2 = s1;
      d2 = d1;
      s1 = high - (std::numbers::phi - 1.0) * (high - low);
      d1 = distance_m(s1);
    } else {
      low = s1;
      s1 = s2;
      d1 = d2;
      s2 = low + (std::numbers::phi - 1.0) * (high - low);
      d2 = distance_m(s2);
    }
    least_m = std::min({least_m, d1, d2});
  }
  return least_m;
}

double distance_to_bounds_m(const World& world, const Eigen::Vector3d& p_m) {
  return std::min({p_m.x() - world.bounds.min_m.x(), p_m.y() - world.bounds.min_m.y(),
                   world.bounds.max_m.x() - p_m.x(), world.bounds.max_m.y() - p_m.y(),
                   world.ceiling_m - p_m.z()});
}

}  // namespace vantage::models
