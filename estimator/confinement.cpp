#include "estimator/confinement.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>

#include "estimator/moment_matching.hpp"

namespace vantage::estimator {

namespace {

using Moment = Eigen::Vector4d;

/// A coordinate that turned back at each wall it met, and whether it now runs the other way.
struct Folded {
  double position_m = 0.0;
  double sign = 1.0;
};

Folded fold(double position_m, double min_m, double max_m) {
  const double width_m = max_m - min_m;
  double along_m = position_m - min_m;
  if (!(along_m >= 0.0 && along_m < 2.0 * width_m)) {  // else fmod() gives back what it gets
    along_m = std::fmod(along_m, 2.0 * width_m);
  }
  if (along_m < 0.0) {
    along_m += 2.0 * width_m;
  }
  return along_m <= width_m ? Folded{min_m + along_m, 1.0}
                            : Folded{min_m + 2.0 * width_m - along_m, -1.0};
}

// Whether every point of the rule is in `bounds`. Rounding is monotone, so that the outermost four,
// computed as all are, are the outermost of all.
bool are_all_inside(const ProductRule& rule, const Eigen::Vector2d& mean_m,
                    const Eigen::Matrix2d& L, const models::Rectangle& bounds) {
  const double first = rule.point.front();
  const double last = rule.point[static_cast<std::size_t>(rule.size - 1)];
  for (const double at_x : {first, last}) {
    for (const double at_y : {first, last}) {
      const Eigen::Vector2d y_m = mean_m + L * Eigen::Vector2d(at_x, at_y);
      if (!bounds.contains(y_m)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

models::Gaussian reflect(const models::Gaussian& belief, const models::Rectangle& bounds) {
  const Eigen::Matrix2d P_pp = belief.covariance.topLeftCorner<2, 2>();
  const Eigen::LLT<Eigen::Matrix2d> root(P_pp);
  const Eigen::Vector2d size_m = bounds.max_m - bounds.min_m;
  if (root.info() != Eigen::Success || size_m.minCoeff() <= 0.0) {
    return belief;
  }
  const Eigen::Matrix2d L = root.matrixL();
  const ProductRule& rule = ProductRule::of(2);
  if (are_all_inside(rule, belief.mean.head<2>(), L, bounds)) {
    return belief;
  }
  const Eigen::Matrix2d P_pv = belief.covariance.topRightCorner<2, 2>();
  const Eigen::Matrix2d G = root.matrixL().solve(P_pv).transpose();  // velocity from u
  const Eigen::Matrix2d C = belief.covariance.bottomRightCorner<2, 2>() - G * G.transpose();

  Moment sum = Moment::Zero();
  Eigen::Matrix4d sum_of_squares = Eigen::Matrix4d::Zero();
  for (int i = 0; i < rule.size; ++i) {
    for (int j = 0; j < rule.size; ++j) {
      const auto at_x = static_cast<std::size_t>(i);
      const auto at_y = static_cast<std::size_t>(j);
      const Eigen::Vector2d u(rule.point[at_x], rule.point[at_y]);
      const double weight = rule.weight[at_x] * rule.weight[at_y];
      const Eigen::Vector2d y_m = belief.mean.head<2>() + L * u;
      const Folded x = fold(y_m.x(), bounds.min_m.x(), bounds.max_m.x());
      const Folded y = fold(y_m.y(), bounds.min_m.y(), bounds.max_m.y());
      const Eigen::Vector2d sign(x.sign, y.sign);
      Moment z;
      z << x.position_m, y.position_m, sign.cwiseProduct(belief.mean.tail<2>() + G * u);
      sum += weight * z;
      sum_of_squares += weight * z * z.transpose();
      sum_of_squares.bottomRightCorner<2, 2>() +=
          weight * sign.asDiagonal() * C * sign.asDiagonal();
    }
  }
  models::Gaussian inside = belief;
  inside.mean = sum;
  const Eigen::Matrix4d covariance = sum_of_squares - sum * sum.transpose();
  inside.covariance = 0.5 * (covariance + covariance.transpose());
  return inside;
}

models::Gaussian confine(const models::Gaussian& outside, const models::World& world) {
  const bool turns_back = outside.mean.size() == 4;
  const models::Gaussian belief = turns_back ? reflect(outside, world.bounds) : outside;
  const Eigen::Index n = belief.mean.size() == 3 ? 3 : 2;
  const Eigen::LLT<models::PositionMatrix> root(belief.covariance.topLeftCorner(n, n));
  const Eigen::Vector2d mean_m = belief.mean.head<2>();
  if (root.info() != Eigen::Success || (turns_back && world.obstacles.empty()) ||
      models::clearance_m(world, mean_m) > ProductRule::of(n).reach_m(root.matrixL())) {
    return belief;
  }
  return reweighted(belief, [&](const models::PositionVector& y_m) {
    const Eigen::Vector2d p_m = y_m.head<2>();
    const bool is_free =
        (turns_back || world.bounds.contains(p_m)) &&
        std::none_of(world.obstacles.begin(), world.obstacles.end(),
                     [&](const models::Obstacle& box) { return box.footprint.contains(p_m); });
    return is_free ? 1.0 : 0.0;
  });
}

}  // namespace vantage::estimator
