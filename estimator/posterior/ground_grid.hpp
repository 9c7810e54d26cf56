#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>

#include "estimator/posterior/posterior_moments.hpp"
#include "estimator/posterior/view_limits.hpp"

// Quadrature of posterior_moments() for sensors to which integration along rays does not apply.

namespace vantage::estimator {

/// Moments of the product p of prior, measurement likelihood and view probability.
struct IntegratedMoments {
  models::PositionVector
      mean_m;  ///< relative to the sensor if computed by Rays; in the world frame if by GroundGrid
  models::PositionMatrix covariance_m2;
  double mahalanobis2 = 0.0;
  double share_in_view = 1.0;
};

/// Quadrature for any sensor that measures targets on the ground, in particular a camera. The
/// density p is evaluated on a grid along the axes of the posterior linearised at its mode.
class GroundGrid {
 public:
  GroundGrid(const PositionPrior& prior, const models::SensorModel& sensor,
             const models::Viewpoint& from, const models::Measurement& measurement,
             const models::MeasurementMatrix& V_inverse)
      : prior_(prior),
        sensor_(sensor),
        from_(from),
        z_(measurement.z),
        W_(V_inverse),
        soft_(limit_softness(sensor, measurement.V)),
        information_(models::PositionMatrix::Zero(2, 2)) {
    const auto seen_m = models::position_from(sensor, from, z_, 2);
    top_m_ = seen_m ? *seen_m : prior.mean_m;
    for (int i = 0; i < kIterations; ++i) {
      const models::MeasurementJacobian H = models::observation_jacobian(sensor, from, top_m_);
      const models::MeasurementVector error = z_ - models::observe(sensor, from, top_m_);
      const models::PositionMatrix HtW = H.transpose() * W_;
      information_ = prior.information + HtW * H;
      const models::PositionVector gradient =
          HtW * error - prior.information * (top_m_ - prior.mean_m);
      const Eigen::LLT<models::PositionMatrix> root(information_);
      if (root.info() != Eigen::Success || !gradient.allFinite()) {
        is_good_ = false;
        return;
      }
      top_m_ += root.solve(gradient);
    }
  }

  // Long function: it computes the exponents of the density at grid points, then the moments of the
  // density. The grid's axes rotate with the robot.
  [[nodiscard]] std::optional<IntegratedMoments> integrate(bool is_limited) const {
    const double c = std::cos(from_.world_from_body.yaw_rad);
    const double s = std::sin(from_.world_from_body.yaw_rad);
    Eigen::Matrix2d world_from_body;
    world_from_body << c, -s, s, c;
    const Eigen::Matrix2d of_body = world_from_body.transpose() * information_ * world_from_body;
    const Eigen::LLT<Eigen::Matrix2d> root(of_body);
    if (!is_good_ || root.info() != Eigen::Success || !top_m_.allFinite()) {
      return std::nullopt;
    }
    std::array<double, kPoints * kPoints> exponent{};
    double most = -std::numeric_limits<double>::infinity();
    const auto point_m = [&](int i, int j) -> models::PositionVector {
      const Eigen::Vector2d u(kSpacing_sigma * (i - kPoints / 2),
                              kSpacing_sigma * (j - kPoints / 2));
      const Eigen::Vector2d offset_m = root.matrixU().solve(u);  // Ω = L Lᵀ: covariance L⁻ᵀ L⁻¹
      return top_m_ + world_from_body * offset_m;
    };
    for (int i = 0; i < kPoints; ++i) {
      for (int j = 0; j < kPoints; ++j) {
        const models::PositionVector y_m = point_m(i, j);
        double& here = exponent[static_cast<std::size_t>(i * kPoints + j)];
        here = -std::numeric_limits<double>::infinity();
        const double in_view = is_limited ? view_probability(sensor_, soft_, from_, y_m) : 1.0;
        if (!is_in_front(y_m) || !(in_view > 0.0)) {
          continue;
        }
        const models::MeasurementVector error = z_ - models::observe(sensor_, from_, y_m);
        const models::PositionVector off_m = y_m - prior_.mean_m;
        here = -0.5 * (error.dot(W_ * error) + off_m.dot(prior_.information * off_m)) +
               std::log(in_view);
        most = std::max(most, here);
      }
    }
    if (!std::isfinite(most)) {
      return std::nullopt;
    }
    double mass = 0.0;
    double in_view = 0.0;
    models::PositionVector sum = models::PositionVector::Zero(2);
    models::PositionMatrix sum_of_squares = models::PositionMatrix::Zero(2, 2);
    for (int i = 0; i < kPoints; ++i) {
      for (int j = 0; j < kPoints; ++j) {
        const double p = std::exp(exponent[static_cast<std::size_t>(i * kPoints + j)] - most);
        if (!(p > 0.0)) {
          continue;
        }
        const models::PositionVector y_m = point_m(i, j);
        const models::PositionVector off_m = y_m - top_m_;
        mass += p;
        in_view += p * view_probability(sensor_, soft_, from_, y_m);
        sum += p * off_m;
        sum_of_squares += p * off_m * off_m.transpose();
      }
    }
    IntegratedMoments total;
    const models::PositionVector shift_m = sum / mass;
    total.mean_m = top_m_ + shift_m;
    total.covariance_m2 = sum_of_squares / mass - shift_m * shift_m.transpose();
    total.mahalanobis2 = -2.0 * most;
    total.share_in_view = in_view / mass;
    return total;
  }

 private:
  static constexpr int kIterations = 5;
  static constexpr int kPoints = 31;
  static constexpr double kSpacing_sigma = 1.0 / 3.0;

  [[nodiscard]] bool is_in_front(const models::PositionVector& y_m) const {
    models::SensorModel all = sensor_;
    all.range_min_m = 0.0;
    all.range_max_m = std::numeric_limits<double>::infinity();
    all.fov_rad = 2.0 * kPi;
    all.depth_min_m = 0.0;
    return models::in_view(all, from_, y_m);
  }

  const PositionPrior& prior_;
  const models::SensorModel& sensor_;
  const models::Viewpoint& from_;
  const models::MeasurementVector z_;
  const models::MeasurementMatrix W_;
  const LimitSoftness soft_;
  models::PositionVector top_m_;
  models::PositionMatrix information_;
  bool is_good_ = true;
};

}  // namespace vantage::estimator
