#include "estimator/posterior/confinement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>

#include "estimator/posterior/moment_matching.hpp"

namespace vantage::estimator {

namespace {

// True if every point of the rule is in `bounds`. Rounding is monotone, so testing the four
// outermost points, computed like all others, is sufficient.
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

Folded fold(double position_m, double min_m, double max_m) {
  const double width_m = max_m - min_m;
  double along_m = position_m - min_m;
  if (!(std::abs(along_m) < 2.0 * width_m)) {  // for smaller values fmod() has no effect
    along_m = std::fmod(along_m, 2.0 * width_m);
  }
  if (along_m < 0.0) {
    along_m += 2.0 * width_m;
  }
  return along_m <= width_m ? Folded{min_m + along_m, 1.0}
                            : Folded{min_m + 2.0 * width_m - along_m, -1.0};
}

models::World inset(const models::World& world, double radius_m) {
  models::World inside = world;
  const Eigen::Vector2d margin_m = Eigen::Vector2d::Constant(radius_m);
  if ((world.bounds.max_m - world.bounds.min_m).minCoeff() > 2.0 * radius_m) {
    inside.bounds = {world.bounds.min_m + margin_m, world.bounds.max_m - margin_m};
  }
  for (models::Obstacle& box : inside.obstacles) {
    box.footprint = {box.footprint.min_m - margin_m, box.footprint.max_m + margin_m};
  }
  return inside;
}

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
  const Eigen::Matrix2d G = root.matrixL().solve(P_pv).transpose();  // velocity per unit of u
  const Eigen::Matrix2d C = belief.covariance.bottomRightCorner<2, 2>() - G * G.transpose();

  // Plain arrays let the compiler vectorise over four rows.
  std::array<double, 4> sum{};
  std::array<std::array<double, 4>, 4> sum_of_squares{};  // [column][row]
  for (int i = 0; i < rule.size; ++i) {
    const auto at_x = static_cast<std::size_t>(i);
    const double u = rule.point[at_x];
    const Folded x = fold(belief.mean(0) + L(0, 0) * u, bounds.min_m.x(), bounds.max_m.x());
    for (int j = 0; j < rule.size; ++j) {
      const auto at_y = static_cast<std::size_t>(j);
      const double v = rule.point[at_y];
      const double weight = rule.weight[at_x] * rule.weight[at_y];
      const Folded y =
          fold(belief.mean(1) + (L(1, 0) * u + L(1, 1) * v), bounds.min_m.y(), bounds.max_m.y());
      const std::array<double, 4> z = {x.position_m, y.position_m,
                                       x.sign * (belief.mean(2) + (G(0, 0) * u + G(0, 1) * v)),
                                       y.sign * (belief.mean(3) + (G(1, 0) * u + G(1, 1) * v))};
      std::array<double, 4> weighted;
      for (std::size_t row = 0; row < 4; ++row) {
        weighted[row] = weight * z[row];
        sum[row] += weighted[row];
      }
      for (std::size_t column = 0; column < 4; ++column) {
        for (std::size_t row = 0; row < 4; ++row) {
          sum_of_squares[column][row] += weighted[row] * z[column];
        }
      }
      const double crossed = x.sign * y.sign;
      const std::array<double, 4> of_vx = {0.0, 0.0, C(0, 0), C(1, 0) * crossed};
      const std::array<double, 4> of_vy = {0.0, 0.0, C(0, 1) * crossed, C(1, 1)};
      for (std::size_t row = 0; row < 4; ++row) {
        sum_of_squares[2][row] += weight * of_vx[row];
        sum_of_squares[3][row] += weight * of_vy[row];
      }
    }
  }
  const Eigen::Map<const Eigen::Vector4d> mean(sum.data());
  const Eigen::Map<const Eigen::Matrix4d> squares(sum_of_squares.front().data());
  models::Gaussian inside = belief;
  inside.mean = mean;
  const Eigen::Matrix4d covariance = squares - mean * mean.transpose();
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
