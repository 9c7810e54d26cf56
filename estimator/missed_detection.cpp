#include "estimator/missed_detection.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace vantage::estimator {

namespace {

constexpr int kPlanarPoints = 15;
constexpr int kSpatialPoints = 7;
constexpr double kReachSigma = 3.0;
constexpr double kContradiction = 1e-6;

/// Equally spaced points with Gaussian weights, of mean 0 and variance 1 exactly.
struct Rule {
  int size = 0;
  double spacing = 0.0;
  std::array<double, kPlanarPoints> point{};
  std::array<double, kPlanarPoints> weight{};
};

Rule make_rule(int size) {
  Rule rule;
  rule.size = size;
  double total = 0.0;
  double variance = 0.0;
  for (int i = 0; i < size; ++i) {
    const auto k = static_cast<std::size_t>(i);
    rule.point[k] = kReachSigma * (2.0 * i / (size - 1) - 1.0);
    rule.weight[k] = std::exp(-0.5 * rule.point[k] * rule.point[k]);
    total += rule.weight[k];
    variance += rule.weight[k] * rule.point[k] * rule.point[k];
  }
  const double scale = 1.0 / std::sqrt(variance / total);
  for (int i = 0; i < size; ++i) {
    rule.weight[static_cast<std::size_t>(i)] /= total;
    rule.point[static_cast<std::size_t>(i)] *= scale;
  }
  rule.spacing = rule.point[1] - rule.point[0];
  return rule;
}

/// Moments of the whitened position u given that the look missed the target.
struct Moments {
  double missed = 0.0;  ///< Z
  double in_view = 0.0;
  models::PositionVector sum;
  models::PositionMatrix sum_of_squares;
};

}  // namespace

models::Gaussian missed_detection(const models::Gaussian& belief, const models::SensorModel& sensor,
                                  const models::Viewpoint& from, const models::World& world,
                                  double detection_probability) {
  static const Rule planar = make_rule(kPlanarPoints);
  static const Rule spatial = make_rule(kSpatialPoints);
  const Eigen::Index n = belief.mean.size() == 3 ? 3 : 2;
  const models::PositionMatrix P = belief.covariance.topLeftCorner(n, n);
  const Eigen::LLT<models::PositionMatrix> root(P);
  if (detection_probability <= 0.0 || root.info() != Eigen::Success) {
    return belief;
  }
  const models::PositionMatrix L = root.matrixL();
  const models::PositionVector mean_m = belief.mean.head(n);
  const Rule& rule = n == 3 ? spatial : planar;
  const Eigen::Vector2d eye_m = from.world_from_body.position_m();
  // L's columns bound how far the rule's farthest point can be from the mean.
  const double reach_m = std::abs(rule.point[0]) * L.cwiseAbs().rowwise().sum().norm();
  if ((mean_m.head<2>() - eye_m).norm() - reach_m > sensor.range_max_m) {
    return belief;
  }

  Moments moments{0.0, 0.0, models::PositionVector::Zero(n), models::PositionMatrix::Zero(n, n)};
  const int last_axis = n == 3 ? rule.size : 1;
  models::PositionVector u = models::PositionVector::Zero(n);
  for (int i = 0; i < rule.size; ++i) {
    for (int j = 0; j < rule.size; ++j) {
      for (int k = 0; k < last_axis; ++k) {
        u(0) = rule.point[static_cast<std::size_t>(i)];
        u(1) = rule.point[static_cast<std::size_t>(j)];
        double weight =
            rule.weight[static_cast<std::size_t>(i)] * rule.weight[static_cast<std::size_t>(j)];
        if (n == 3) {
          u(2) = rule.point[static_cast<std::size_t>(k)];
          weight *= rule.weight[static_cast<std::size_t>(k)];
        }
        const models::PositionVector y_m = mean_m + L * u;
        if (models::in_view(sensor, from, y_m) &&
            models::line_of_sight(world, eye_m, y_m.head<2>())) {
          moments.in_view += weight;
          weight *= 1.0 - detection_probability;
        }
        moments.missed += weight;
        moments.sum += weight * u;
        moments.sum_of_squares += weight * u * u.transpose();
      }
    }
  }
  if (moments.in_view <= 0.0 || moments.missed < kContradiction) {
    return belief;
  }

  const models::PositionVector shift = moments.sum / moments.missed;
  const models::PositionMatrix S =
      moments.sum_of_squares / moments.missed - shift * shift.transpose();
  const Eigen::SelfAdjointEigenSolver<models::PositionMatrix> axes(S);
  const double floor = rule.spacing * rule.spacing / 12.0;
  const models::PositionMatrix S_floored = axes.eigenvectors() *
                                           axes.eigenvalues().cwiseMax(floor).asDiagonal() *
                                           axes.eigenvectors().transpose();
  // y = μ + G u + (what the position does not tell), G = P_{:p} L⁻ᵀ.
  using Gain = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                             models::kMaxTargetDim, 3>;
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3,
                      models::kMaxTargetDim>
      Gt = root.matrixL().solve(belief.covariance.topRows(n));
  const Gain G = Gt.transpose();
  models::Gaussian posterior = belief;
  posterior.mean += G * shift;
  const models::PositionMatrix change = S_floored - models::PositionMatrix::Identity(n, n);
  posterior.covariance += G * change * G.transpose();
  posterior.covariance = (0.5 * (posterior.covariance + posterior.covariance.transpose())).eval();
  return posterior;
}

}  // namespace vantage::estimator
