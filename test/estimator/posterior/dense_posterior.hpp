#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Dense>

#include "estimator/posterior/view_limits.hpp"
#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"

// Brute-force reference for measurement updates. The only code that it shares with the estimator is
// the softness of limits, which has a separate test.

namespace vantage::estimator::test {

struct DenseMoments {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  double share_in_view = 0.0;
};

/// Returns the moments of prior × N(z; h(y), V) × view_probability(y) on a Cartesian grid. A coarse
/// grid over prior and range finds the region with probability mass, and a fine grid of `points` ×
/// `points` integrates over this region. Without prior (Ω = 0) the grid covers the range. If
/// `is_limited` is false, no limits apply.
inline std::optional<DenseMoments> dense_posterior(const Eigen::VectorXd& prior_mean,
                                                   const Eigen::MatrixXd& prior_information,
                                                   const models::SensorModel& sensor,
                                                   const models::Viewpoint& from,
                                                   const models::Measurement& z, bool is_limited,
                                                   int points) {
  const Eigen::Index n = prior_mean.size();
  const models::MeasurementMatrix W = Eigen::MatrixXd(z.V).inverse();
  const models::PositionVector believed = prior_mean;
  const models::PositionMatrix Omega = prior_information;
  Eigen::VectorXd eye = Eigen::VectorXd::Zero(n);
  eye.head(2) = from.world_from_body.position_m();
  if (n == 3) {
    eye(2) = from.height_m;
  }
  Eigen::VectorXd low = Eigen::VectorXd::Constant(n, -std::numeric_limits<double>::infinity());
  Eigen::VectorXd high = -low;
  const Eigen::MatrixXd P = prior_information.completeOrthogonalDecomposition().pseudoInverse();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (prior_information.fullPivLu().isInvertible()) {
      low(i) = prior_mean(i) - 6.5 * std::sqrt(P(i, i));
      high(i) = prior_mean(i) + 6.5 * std::sqrt(P(i, i));
    }
    if (is_limited || !std::isfinite(low(i))) {
      const double reach_m =
          sensor.range_max_m + kViewCertain_sigma * limit_softness(sensor, z.V).distance_m;
      low(i) = std::max(low(i), eye(i) - reach_m);
      high(i) = std::min(high(i), eye(i) + reach_m);
    }
    if (low(i) >= high(i)) {
      return std::nullopt;
    }
  }
  models::SensorModel open = sensor;
  open.range_min_m = sensor.kind == models::SensorKind::kBearing ||
                             sensor.kind == models::SensorKind::kRangeBearing
                         ? 1e-9
                         : 0.0;
  open.range_max_m = std::numeric_limits<double>::infinity();
  open.fov_rad = 2.0 * kPi;
  open.depth_min_m = 0.0;
  const LimitSoftness softness = limit_softness(sensor, z.V);
  const auto probability = [&](const models::PositionVector& y) {
    return view_probability(sensor, softness, from, y);
  };
  const auto exponent = [&](const models::PositionVector& y) {
    const double in_view = is_limited ? probability(y) : 1.0;
    if (!models::in_view(open, from, y) || !(in_view > 0.0)) {
      return -std::numeric_limits<double>::infinity();
    }
    const models::PositionVector off = y - believed;
    const models::MeasurementVector e =
        models::innovation(sensor, z.z, models::observe(sensor, from, y));
    return -0.5 * (off.dot(Omega * off) + e.dot(W * e)) + std::log(in_view);
  };
  DenseMoments out;
  std::vector<double> exponents;
  for (int pass = 0; pass < 3; ++pass) {
    const int count = pass < 2 ? (n == 3 ? 40 : 120) : points;
    const Eigen::VectorXd step = (high - low) / count;
    double most = -std::numeric_limits<double>::infinity();
    const auto visit = [&](const auto& use) {
      models::PositionVector y(n);
      std::size_t index = 0;
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
          for (int k = 0; k < (n == 3 ? count : 1); ++k) {
            y(0) = low(0) + step(0) * (i + 0.5);
            y(1) = low(1) + step(1) * (j + 0.5);
            if (n == 3) {
              y(2) = low(2) + step(2) * (k + 0.5);
            }
            use(y, index++);
          }
        }
      }
    };
    exponents.assign(static_cast<std::size_t>(std::pow(count, n)), 0.0);
    visit([&](const models::PositionVector& y, std::size_t at) {
      exponents[at] = exponent(y);
      most = std::max(most, exponents[at]);
    });
    if (!std::isfinite(most)) {
      return std::nullopt;
    }
    const models::PositionVector corner = low;
    models::PositionVector first = high;
    models::PositionVector last = low;
    double mass = 0.0;
    double in_view = 0.0;
    models::PositionVector sum = models::PositionVector::Zero(n);
    models::PositionMatrix squares = models::PositionMatrix::Zero(n, n);
    visit([&](const models::PositionVector& y, std::size_t at) {
      if (exponents[at] <= most - 16.0) {
        return;
      }
      first = first.cwiseMin(y);
      last = last.cwiseMax(y);
      const double p = std::exp(exponents[at] - most);
      const models::PositionVector off = y - corner;
      mass += p;
      in_view += p * probability(y);
      sum += p * off;
      squares += p * off * off.transpose();
    });
    out.mean = corner + sum / mass;
    out.covariance = squares / mass - sum * sum.transpose() / (mass * mass);
    out.share_in_view = in_view / mass;
    low = first - 1.5 * step;
    high = last + 1.5 * step;
  }
  return out;
}

/// The error of a mean in σ of the reference, and the relative error of a covariance.
struct Difference {
  double mean_sigma = 0.0;
  double covariance_share = 0.0;
};
inline Difference difference(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                             const DenseMoments& oracle) {
  const Eigen::LLT<Eigen::MatrixXd> root(oracle.covariance);
  const Eigen::MatrixXd half = root.matrixL().solve(covariance - oracle.covariance);
  const Eigen::MatrixXd whole = root.matrixL().solve(half.transpose());
  return {root.matrixL().solve(mean - oracle.mean).norm(), whole.cwiseAbs().maxCoeff()};
}

}  // namespace vantage::estimator::test
