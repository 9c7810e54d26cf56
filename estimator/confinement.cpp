#include "estimator/confinement.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

#include "estimator/moment_matching.hpp"

namespace vantage::estimator {

models::Gaussian confine(const models::Gaussian& belief, const models::World& world) {
  const Eigen::Index n = belief.mean.size() == 3 ? 3 : 2;
  const Eigen::LLT<models::PositionMatrix> root(belief.covariance.topLeftCorner(n, n));
  if (root.info() != Eigen::Success) {
    return belief;
  }
  const Eigen::Vector2d mean_m = belief.mean.head<2>();
  if (models::clearance_m(world, mean_m) > ProductRule::of(n).reach_m(root.matrixL())) {
    return belief;
  }
  return reweighted(belief, [&](const models::PositionVector& y_m) {
    const Eigen::Vector2d p_m = y_m.head<2>();
    const bool is_free =
        world.bounds.contains(p_m) &&
        std::none_of(world.obstacles.begin(), world.obstacles.end(),
                     [&](const models::Obstacle& box) { return box.footprint.contains(p_m); });
    return is_free ? 1.0 : 0.0;
  });
}

}  // namespace vantage::estimator
