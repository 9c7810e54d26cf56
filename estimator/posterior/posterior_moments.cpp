#include "estimator/posterior/posterior_moments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Cholesky>

#include "estimator/posterior/gauss_legendre.hpp"
#include "estimator/posterior/ground_grid.hpp"
#include "estimator/posterior/view_limits.hpp"
#include "models/sensor/law.hpp"

namespace vantage::estimator {
namespace {

using models::PositionMatrix;
using models::PositionVector;

/// Terms are neglected if their exponent is this much below the largest one (5σ of a Gaussian).
constexpr double kNegligible = 12.5;
constexpr int kZoomsMax = 10;
/// Share of the mass in view below which the limits are assumed to be wrong.
constexpr double kContradiction = 1e-3;
/// Share of the mass in view above which the limits have no effect.
constexpr double kAllInView = 1.0 - 1e-6;
constexpr double kLeastRange_m = 1e-9;

struct Interval {
  double low = 0.0;
  double high = 0.0;
  [[nodiscard]] double width() const { return high - low; }
};

/// Integrals along one ray, times exp(−top): of p, of p r, of p r², and of p within the limits; r
/// is the distance.
struct RayIntegral {
  double top = -std::numeric_limits<double>::infinity();
  double mass = 0.0;
  double first = 0.0;
  double second = 0.0;
  double in_view = 0.0;
  /// Logarithm of the mass without the factor exp(−top).
  double log_mass = -std::numeric_limits<double>::infinity();
};

/// Quadrature of prior, measurement and limits along rays from the sensor.
class Rays {
 public:
  Rays(const PositionPrior& prior, const models::SensorModel& sensor, const models::Viewpoint& from,
       const models::Measurement& measurement, const models::MeasurementMatrix& V_inverse)
      : sensor_(sensor),
        law_(sensor.kind.law()),
        from_(from),
        z_(measurement.z),
        W_(V_inverse),
        soft_(limit_softness(sensor, measurement.V)),
        dim_(prior.mean_m.size()),
        Omega_(prior.information),
        linear_(PositionVector::Zero(dim_)),
        eye_m_(PositionVector::Zero(dim_)) {
    eye_m_.head<2>() = from.world_from_body.position_m();
    if (dim_ == 3) {
      eye_m_(2) = from.height_m;
    }
    const PositionVector offset_m = prior.mean_m - eye_m_;
    linear_ = Omega_ * offset_m;
    constant_ = -0.5 * offset_m.dot(linear_);
    believed_rad_ = std::atan2(offset_m.y(), offset_m.x()) - from.world_from_body.yaw_rad;
    if (law_.is_linear) {  // the likelihood is itself Gaussian
      const models::MeasurementJacobian H =
          models::observation_jacobian(sensor, from, prior.mean_m);
      const models::MeasurementJacobian HtW = H.transpose() * W_;
      Omega_ += HtW * H;
      linear_ += HtW * z_;
      constant_ -= 0.5 * z_.dot(W_ * z_);
    }
  }

  [[nodiscard]] const PositionVector& eye_m() const { return eye_m_; }

  /// Returns the moments; nullopt if p is zero everywhere or unbounded.
  [[nodiscard]] std::optional<IntegratedMoments> integrate(bool is_limited) const {
    return dim_ == 3 ? integrate_over<32, 32>(is_limited) : integrate_over<64, 1>(is_limited);
  }

 private:
  [[nodiscard]] bool has_full_view() const { return models::has_full_view(sensor_); }

  /// Returns the angle beyond the edge of the field of view up to which p is not negligible, rad.
  [[nodiscard]] double softest_rad() const {
    const double reach = std::sqrt(2.0 * kNegligible);
    const double nearest_m =
        std::max(sensor_.range_min_m - reach * soft_.distance_m, kLeastRange_m);
    return reach * std::hypot(soft_.angle_rad, soft_.distance_m / nearest_m);
  }

  /// Returns the distance x beyond a limit of uncertainty `sigma_m` at which exp(slope x − ½ a x²)
  /// times the tail of the limit, exp(−½ x²/σ²), becomes negligible. `slope` is the outward slope
  /// of the exponent at the limit.
  [[nodiscard]] static double softness_m(double slope, double a, double sigma_m) {
    if (!(sigma_m > 0.0)) {
      return 0.0;
    }
    const double steep = a + 1.0 / (sigma_m * sigma_m);
    return std::max(0.0, slope / steep) + std::sqrt(2.0 * kNegligible / steep);
  }

  /// Returns the interval of possible bearings, measured from the body's x axis.
  [[nodiscard]] Interval bearings_rad(bool is_limited) const {
    const double half_rad =
        is_limited && !has_full_view() ? std::min(kPi, 0.5 * sensor_.fov_rad + softest_rad()) : kPi;
    if (!law_.measures_bearing) {
      // The full circle is cut opposite to the prior mean, so that the interval can be narrowed
      // around the mean.
      const double middle_rad = half_rad == kPi ? believed_rad_ : 0.0;
      return {middle_rad - half_rad, middle_rad + half_rad};
    }
    const double z_rad = z_(z_.rows() - 1);
    const double reach_rad =
        std::min(kPi, std::sqrt(2.0 * kNegligible / W_(z_.rows() - 1, z_.rows() - 1)));
    const Interval noise{z_rad - reach_rad, z_rad + reach_rad};
    // Beyond ±π the intersection of the noise interval and the field of view could be two
    // intervals.
    if (half_rad == kPi || noise.low < -kPi || noise.high > kPi) {
      return half_rad == kPi ? noise : Interval{-half_rad, half_rad};
    }
    return {std::max(noise.low, -half_rad), std::min(noise.high, half_rad)};
  }

  /// Returns the sensor's limits of the distance along the ray.
  [[nodiscard]] Interval distances_m(double cos_elevation, double depth_share) const {
    Interval r{sensor_.range_min_m, sensor_.range_max_m};
    if (law_.measures_bearing) {
      r.low = std::max(r.low, kLeastRange_m) / std::max(cos_elevation, kLeastRange_m);
    }
    if (law_.depth_per_m != nullptr) {
      r.low = std::max(r.low, sensor_.depth_min_m / depth_share);
    }
    return r;
  }

  /// Integrates along the ray with unit vector `u`, at `bearing_rad` from the body's x axis.
  /// Long function: it distinguishes the cases of one integrand.
  [[nodiscard]] RayIntegral along(const PositionVector& u, double bearing_rad, double cos_elevation,
                                  bool is_limited) const {
    RayIntegral out;
    // exponent(r) = −½ a r² + c r + e
    double a = dim_ == 3 ? u.dot(Omega_ * u)
                         : u(0) * (Omega_(0, 0) * u(0) + Omega_(0, 1) * u(1)) +
                               u(1) * (Omega_(1, 0) * u(0) + Omega_(1, 1) * u(1));
    double c = u.dot(linear_);
    double e = constant_;
    double depth_share = 1.0;
    const auto bearing_error_rad = [&] { return wrap_to_pi(z_(z_.rows() - 1) - bearing_rad); };
    if (law_.measures_range) {
      const double scale = sensor_.calibration.range_scale;
      const double z_m = z_(0) - sensor_.calibration.range_bias_m;
      a += scale * scale * W_(0, 0);
      c += scale * W_(0, 0) * z_m;
      e -= 0.5 * W_(0, 0) * z_m * z_m;
      if (law_.measures_bearing) {
        const double error_rad = bearing_error_rad();
        c += scale * W_(0, 1) * error_rad;
        e -= (W_(0, 1) * z_m + 0.5 * W_(1, 1) * error_rad) * error_rad;
      }
    } else if (law_.measures_bearing) {
      const double error_rad = bearing_error_rad();
      e -= 0.5 * W_(0, 0) * error_rad * error_rad;
    } else if (law_.depth_per_m != nullptr) {
      depth_share = law_.depth_per_m(sensor_, bearing_rad, cos_elevation, u(2));
      if (depth_share <= 1e-6) {
        return out;
      }
      const PositionVector at_m = eye_m_ + u;
      const models::MeasurementVector error = z_ - models::observe(sensor_, from_, at_m);
      e -= 0.5 * error.dot(W_ * error);
    }
    const Interval limits = distances_m(cos_elevation, depth_share);
    const double soft_low_m =
        soft_.distance_m /
        (law_.measures_bearing ? std::max(cos_elevation, kLeastRange_m) : depth_share);
    Interval r = is_limited ? limits : Interval{0.0, std::numeric_limits<double>::infinity()};
    if (!(r.low < r.high)) {
      return out;
    }
    // Peak of the exponent on the interval, and the distance from it beyond which p is negligible.
    const double peak = a > 0.0 ? std::clamp(c / a, r.low, r.high) : (c > 0.0 ? r.high : r.low);
    if (!std::isfinite(peak)) {
      return out;
    }
    out.top = (c - 0.5 * a * peak) * peak + e;
    const double slope = std::abs(c - a * peak);
    const double reach_m =
        2.0 * kNegligible / (slope + std::sqrt(slope * slope + 2.0 * kNegligible * a));
    const Interval soft{
        is_limited ? std::max(0.0, r.low - softness_m(a * r.low - c, a, soft_low_m)) : 0.0,
        is_limited ? r.high + softness_m(c - a * r.high, a, soft_.distance_m) : r.high};
    r = {peak == r.low ? soft.low : std::max(soft.low, peak - reach_m),
         peak == r.high ? soft.high : std::min(soft.high, peak + reach_m)};
    if (!std::isfinite(r.width())) {
      return RayIntegral{};
    }
    const double middle_m = 0.5 * (r.low + r.high);
    const double half_m = 0.5 * r.width();
    const bool is_soft = soft_.distance_m > 0.0 || soft_.angle_rad > 0.0;
    const double depth_per_m =
        law_.depth_per_m != nullptr ? depth_share : std::numeric_limits<double>::infinity();
    const auto view_probability = [&](double r_m) {
      if (!is_soft) {
        return models::in_view(sensor_, from_, eye_m_ + r_m * u) ? 1.0 : 0.0;
      }
      return estimator::view_probability(sensor_, soft_, r_m, r_m * cos_elevation, bearing_rad,
                                         depth_per_m * r_m);
    };
    // A separate loop lets the compiler keep the sums in registers.
    std::array<double, kLegendrePoints> shares;
    for (std::size_t i = 0; i < kLegendrePoints; ++i) {
      const double from_peak_m =
          middle_m + kLegendreSide[i % 2] * half_m * kLegendreNode[i / 2] - peak;
      // exponent(r) − top, without the cancellation of large terms.
      shares[i] = std::exp((c - a * peak - 0.5 * a * from_peak_m) * from_peak_m);
    }
    for (std::size_t i = 0; i < kLegendrePoints; ++i) {
      const double r_m = middle_m + kLegendreSide[i % 2] * half_m * kLegendreNode[i / 2];
      // Jacobian of the polar coordinates at r
      const double spread = dim_ == 3 ? r_m * r_m * cos_elevation : r_m;
      const double in_view = view_probability(r_m);
      const double likely = half_m * kLegendreWeight[i / 2] * spread * shares[i];
      const double p = is_limited ? likely * in_view : likely;
      out.mass += p;
      out.first += p * r_m;
      out.second += p * r_m * r_m;
      out.in_view += likely * in_view;
    }
    out.log_mass = out.top + std::log(out.mass);
    return out;
  }

  // Long function: it integrates over an array of rays, and first narrows the array to the
  // directions that contain the mass.
  template <std::size_t Bearings, std::size_t Elevations>
  [[nodiscard]] std::optional<IntegratedMoments> integrate_over(bool is_limited) const {
    std::array<RayIntegral, Bearings * Elevations> rays;
    std::array<PositionVector, Bearings * Elevations> directions;
    Interval bearing_rad = bearings_rad(is_limited);
    Interval elevation_rad{-0.5 * kPi, 0.5 * kPi};
    const auto middle = [](const Interval& of, std::size_t i, std::size_t count) {
      return of.low + of.width() * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    };
    const auto direction_of = [&](std::size_t i, std::size_t j) {
      const double at_rad = from_.world_from_body.yaw_rad + middle(bearing_rad, i, Bearings);
      PositionVector direction = PositionVector::Zero(dim_);
      direction.head<2>() << std::cos(at_rad), std::sin(at_rad);
      if (dim_ == 3) {
        const double up_rad = middle(elevation_rad, j, Elevations);
        direction.head<2>() *= std::cos(up_rad);
        direction(2) = std::sin(up_rad);
      }
      return direction;
    };
    double most = 0.0;
    double peak = 0.0;
    for (int zoom = 0;; ++zoom) {
      most = -std::numeric_limits<double>::infinity();
      peak = most;
      for (std::size_t i = 0; i < Bearings; ++i) {
        for (std::size_t j = 0; j < Elevations; ++j) {
          const double cos_elevation =
              dim_ == 3 ? std::cos(middle(elevation_rad, j, Elevations)) : 1.0;
          RayIntegral& ray = rays[i * Elevations + j];
          PositionVector& direction = directions[i * Elevations + j];
          direction = direction_of(i, j);
          ray = along(direction, middle(bearing_rad, i, Bearings), cos_elevation, is_limited);
          most = std::max(most, ray.log_mass);
          peak = std::max(peak, ray.top);
        }
      }
      if (!std::isfinite(most)) {
        return std::nullopt;
      }
      // The relevant directions, plus one on each side.
      std::size_t first_i = Bearings;
      std::size_t last_i = 0;
      std::size_t first_j = Elevations;
      std::size_t last_j = 0;
      for (std::size_t i = 0; i < Bearings; ++i) {
        for (std::size_t j = 0; j < Elevations; ++j) {
          if (rays[i * Elevations + j].log_mass > most - kNegligible) {
            first_i = std::min(first_i, i);
            last_i = std::max(last_i, i);
            first_j = std::min(first_j, j);
            last_j = std::max(last_j, j);
          }
        }
      }
      const bool is_wide_i = 2 * (last_i - first_i + 3) > Bearings;
      const bool is_wide_j = 2 * (last_j - first_j + 3) > Elevations;
      if ((is_wide_i && is_wide_j) || zoom == kZoomsMax) {
        break;
      }
      const auto narrowed = [](const Interval& of, std::size_t first, std::size_t last,
                               std::size_t count) {
        const double step = of.width() / static_cast<double>(count);
        return Interval{std::max(of.low, of.low + step * (static_cast<double>(first) - 1.0)),
                        std::min(of.high, of.low + step * (static_cast<double>(last) + 2.0))};
      };
      bearing_rad = is_wide_i ? bearing_rad : narrowed(bearing_rad, first_i, last_i, Bearings);
      elevation_rad =
          is_wide_j ? elevation_rad : narrowed(elevation_rad, first_j, last_j, Elevations);
    }

    double mass = 0.0;
    double in_view = 0.0;
    PositionVector sum = PositionVector::Zero(dim_);
    PositionMatrix sum_of_squares = PositionMatrix::Zero(dim_, dim_);
    for (std::size_t i = 0; i < Bearings; ++i) {
      for (std::size_t j = 0; j < Elevations; ++j) {
        const RayIntegral& ray = rays[i * Elevations + j];
        const double weight = std::exp(ray.top - most);
        if (!(weight > 0.0)) {
          continue;
        }
        const PositionVector& direction = directions[i * Elevations + j];
        mass += weight * ray.mass;
        in_view += weight * ray.in_view;
        sum += weight * ray.first * direction;
        sum_of_squares += weight * ray.second * direction * direction.transpose();
      }
    }
    IntegratedMoments total;
    total.mean_m = sum / mass;
    total.covariance_m2 = sum_of_squares / mass - total.mean_m * total.mean_m.transpose();
    total.mahalanobis2 = std::max(0.0, -2.0 * peak);
    total.share_in_view = in_view / mass;
    return total;
  }

  const models::SensorModel& sensor_;
  const models::SensorLaw& law_;
  const models::Viewpoint& from_;
  const models::MeasurementVector z_;
  const models::MeasurementMatrix W_;  // V⁻¹
  const LimitSoftness soft_;
  const Eigen::Index dim_;
  // Gaussian part of p as a function of the offset from the sensor: prior and linear measurement
  PositionMatrix Omega_;
  PositionVector linear_;
  double constant_ = 0.0;
  PositionVector eye_m_;
  double believed_rad_ = 0.0;  // bearing of the prior's mean from the body's x axis
};

template <class Integral>
std::optional<IntegratedMoments> within_limits(const Integral& integral) {
  const std::optional<IntegratedMoments> unlimited = integral.integrate(false);
  if (!unlimited || unlimited->share_in_view > kAllInView ||
      unlimited->share_in_view < kContradiction) {
    return unlimited;
  }
  std::optional<IntegratedMoments> limited = integral.integrate(true);
  if (!limited) {
    return unlimited;
  }
  limited->mahalanobis2 = unlimited->mahalanobis2;
  return limited;
}

/// True if the likelihood of z has a closed form along each ray from the sensor.
bool is_along_rays(const models::SensorModel& sensor, Eigen::Index position_dim) {
  const models::SensorLaw& law = sensor.kind.law();
  return law.is_linear || law.measures_range || law.measures_bearing ||
         (law.depth_per_m != nullptr && position_dim == 3);
}

}  // namespace

bool can_integrate(const models::SensorModel& sensor, Eigen::Index position_dim) {
  return position_dim == 2 || is_along_rays(sensor, position_dim);
}

std::optional<PositionMoments> posterior_moments(const PositionPrior& prior,
                                                 const models::SensorModel& sensor,
                                                 const models::Viewpoint& from,
                                                 const models::Measurement& measurement) {
  const Eigen::LLT<models::MeasurementMatrix> noise(measurement.V);
  if (noise.info() != Eigen::Success) {
    return std::nullopt;
  }
  const models::MeasurementMatrix V_inverse =
      noise.solve(models::MeasurementMatrix::Identity(measurement.V.rows(), measurement.V.cols()));
  const Eigen::Index n = prior.mean_m.size();
  if (!can_integrate(sensor, n)) {
    return std::nullopt;
  }
  std::optional<IntegratedMoments> total;
  PositionVector eye_m;
  if (!is_along_rays(sensor, n)) {
    total = within_limits(GroundGrid(prior, sensor, from, measurement, V_inverse));
    eye_m = PositionVector::Zero(2);
  } else {
    const Rays rays(prior, sensor, from, measurement, V_inverse);
    total = within_limits(rays);
    eye_m = rays.eye_m();
  }
  if (!total || !total->mean_m.allFinite() || !total->covariance_m2.allFinite()) {
    return std::nullopt;
  }
  PositionMoments moments;
  moments.mean_m = eye_m + total->mean_m;
  moments.covariance_m2 = 0.5 * (total->covariance_m2 + total->covariance_m2.transpose());
  moments.mahalanobis2 = total->mahalanobis2;
  if (Eigen::LLT<PositionMatrix>(moments.covariance_m2).info() != Eigen::Success) {
    return std::nullopt;
  }
  return moments;
}

}  // namespace vantage::estimator
