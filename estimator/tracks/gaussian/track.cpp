#include "estimator/tracks/gaussian/track.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "estimator/posterior/posterior_moments.hpp"
#include "estimator/posterior/unscented.hpp"
#include "estimator/posterior/view_limits.hpp"
#include "models/sensor/law.hpp"
#include "models/target/law.hpp"

namespace vantage::estimator {

namespace {

using models::Information;
using models::MeasurementJacobian;
using models::MeasurementMatrix;
using models::MeasurementVector;
using models::StateMatrix;

/// Returns ∂z/∂state from ∂z/∂position: a sensor measures position only.
MeasurementJacobian state_jacobian(const MeasurementJacobian& by_position, Eigen::Index dim) {
  MeasurementJacobian H = MeasurementJacobian::Zero(by_position.rows(), dim);
  H.leftCols(by_position.cols()) = by_position;
  return H;
}

Eigen::Index position_rows(Eigen::Index state_rows) { return state_rows == 3 ? 3 : 2; }

/// Distance from the mean, along each axis of the belief, of the corners at which h is compared
/// with its tangent.
constexpr double kCorner_sigma = 1.5;
/// Distance from the mean within which a linearised posterior must be in view. The limits then have
/// no effect on it.
constexpr double kClear_sigma = 3.0;
/// View probability that corresponds to kClear_sigma for soft limits: Φ(3).
constexpr double kClear = 0.99865;

/// Linearisation of h at a belief's mean.
struct Tangent {
  models::PositionVector mean_m;
  MeasurementVector expected;
  MeasurementJacobian H;  ///< ∂h/∂position
};

/// Calls `visit` with y = mean + L u for the corners u of a cube of half side `reach`. If
/// `with_axes`, also calls it for the points on the axes at the distance of the corners. Stops and
/// returns false when `visit` returns false.
template <class Visit>
bool for_all_around(const models::PositionVector& mean_m, const models::PositionMatrix& L,
                    double reach, bool with_axes, const Visit& visit) {
  const Eigen::Index n = mean_m.size();
  models::PositionVector u(n);
  for (int corner = 0; corner < (1 << n); ++corner) {
    for (Eigen::Index i = 0; i < n; ++i) {
      u(i) = ((corner >> i) & 1) == 0 ? -reach : reach;
    }
    if (!visit(models::PositionVector(mean_m + L * u))) {
      return false;
    }
  }
  for (Eigen::Index i = 0; with_axes && i < n; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double far = side * reach * std::sqrt(static_cast<double>(n));
      if (!visit(models::PositionVector(mean_m + far * L.col(i)))) {
        return false;
      }
    }
  }
  return true;
}

/// Returns L with L Lᵀ = covariance. Its columns rotate with the robot, so that the linearity test
/// does not depend on the world's x axis.
models::PositionMatrix root_of(const models::PositionMatrix& covariance_m2,
                               const models::Viewpoint& from) {
  models::PositionMatrix world_from_body =
      models::PositionMatrix::Identity(covariance_m2.rows(), covariance_m2.cols());
  const double c = std::cos(from.world_from_body.yaw_rad);
  const double s = std::sin(from.world_from_body.yaw_rad);
  world_from_body.topLeftCorner<2, 2>() << c, -s, s, c;
  const models::PositionMatrix of_body =
      world_from_body.transpose() * covariance_m2 * world_from_body;
  const models::PositionMatrix L = of_body.llt().matrixL();
  return world_from_body * L;
}

bool is_linear_enough(const Tangent& tangent, const models::PositionMatrix& P_pp,
                      const models::SensorModel& sensor, const models::Viewpoint& from,
                      const Eigen::LLT<MeasurementMatrix>& noise) {
  if (!tangent.H.allFinite() || !tangent.expected.allFinite()) {
    return false;
  }
  return sensor.kind.law().is_linear ||
         for_all_around(tangent.mean_m, root_of(P_pp, from), kCorner_sigma, false,
                        [&](const models::PositionVector& y_m) {
                          const MeasurementVector bend =
                              models::innovation(sensor, models::observe(sensor, from, y_m),
                                                 tangent.expected) -
                              tangent.H * (y_m - tangent.mean_m);
                          return bend.dot(noise.solve(bend)) <= kBendMax * kBendMax;
                        });
}

bool is_clear_of_limits(const models::Gaussian& posterior, Eigen::Index n,
                        const models::SensorModel& sensor, const LimitSoftness& softness,
                        const models::Viewpoint& from) {
  const models::PositionVector mean_m = posterior.mean.head(n);
  return for_all_around(mean_m, root_of(posterior.covariance.topLeftCorner(n, n), from),
                        kClear_sigma / std::sqrt(static_cast<double>(n)), true,
                        [&](const models::PositionVector& y_m) {
                          return view_probability(sensor, softness, from, y_m) >= kClear;
                        });
}

/// Changes the position's marginal from `prior` to `posterior`; the rest of the state follows
/// through its correlation. Returns false, belief unchanged, when the result is not positive
/// definite.
bool shift_position(Information& belief, const PositionPrior& prior,
                    const PositionMoments& posterior) {
  const Eigen::Index n = prior.mean_m.size();
  const Eigen::LLT<models::PositionMatrix> root(posterior.covariance_m2);
  const models::PositionMatrix Omega = root.solve(models::PositionMatrix::Identity(n, n));
  Information shifted = belief;
  shifted.matrix.topLeftCorner(n, n) += Omega - prior.information;
  shifted.vector.head(n) += Omega * posterior.mean_m - prior.information * prior.mean_m;
  shifted.matrix = (0.5 * (shifted.matrix + shifted.matrix.transpose())).eval();
  if (!shifted.vector.allFinite() ||
      Eigen::LLT<StateMatrix>(shifted.matrix).info() != Eigen::Success) {
    return false;
  }
  belief = shifted;
  return true;
}

/// True if h is nearly linear over the whole state, by the same measure as is_linear_enough().
bool is_state_linear_enough(const models::Gaussian& prior, const MeasurementJacobian& H,
                            const MeasurementVector& expected, const models::SensorModel& sensor,
                            const models::Viewpoint& from,
                            const Eigen::LLT<MeasurementMatrix>& noise) {
  if (!H.allFinite() || !expected.allFinite()) {
    return false;
  }
  const Eigen::Index n = prior.mean.size();
  const StateMatrix L = prior.covariance.llt().matrixL();
  for (int corner = 0; corner < (1 << n); ++corner) {
    models::StateVector u(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      u(i) = ((corner >> i) & 1) == 0 ? -kCorner_sigma : kCorner_sigma;
    }
    const models::StateVector away = L * u;
    const MeasurementVector bend =
        models::innovation(
            sensor, models::observe_state(sensor, from, models::StateVector(prior.mean + away)),
            expected) -
        H * away;
    if (!(bend.dot(noise.solve(bend)) <= kBendMax * kBendMax)) {
      return false;
    }
  }
  return true;
}

/// Adds the information of a linear measurement `z` = H x + v, v ~ N(0, V).
void add_linear(Information& belief, const MeasurementJacobian& H,
                const Eigen::LLT<MeasurementMatrix>& noise, const MeasurementVector& z) {
  const MeasurementJacobian weighted = noise.solve(H);  // V⁻¹ H
  belief.matrix += H.transpose() * weighted;
  belief.matrix = (0.5 * (belief.matrix + belief.matrix.transpose())).eval();
  belief.vector += weighted.transpose() * z;
}

/// As measure(), for a sensor that measures the velocity of a target whose state has one.
Use measure_state(Information& belief, const models::Gaussian& prior,
                  const models::SensorModel& sensor, const models::Viewpoint& from,
                  const models::Measurement& measurement,
                  const Eigen::LLT<MeasurementMatrix>& noise, double gate_sigma) {
  const auto is_beyond_gate = [&](double mahalanobis2) {
    return gate_sigma > 0.0 && mahalanobis2 > gate_sigma * gate_sigma;
  };
  const MeasurementVector expected = models::observe_state(sensor, from, prior.mean);
  const MeasurementJacobian H = models::state_jacobian(sensor, from, prior.mean);
  if (is_state_linear_enough(prior, H, expected, sensor, from, noise)) {
    const MeasurementVector nu = models::innovation(sensor, measurement.z, expected);
    const MeasurementMatrix S = H * prior.covariance * H.transpose() + measurement.V;
    const MeasurementVector whitened = S.llt().matrixL().solve(nu);
    if (is_beyond_gate(whitened.squaredNorm())) {
      return Use::kGated;
    }
    add_linear(belief, H, noise, nu + H * prior.mean);
    return Use::kUsed;
  }
  const auto updated = unscented_update(prior, sensor, from, measurement);
  if (!updated) {
    return Use::kSingular;
  }
  if (is_beyond_gate(updated->mahalanobis2)) {
    return Use::kGated;
  }
  const auto after = models::to_information(updated->belief);
  if (!after) {
    return Use::kSingular;
  }
  belief = *after;
  return Use::kUsed;
}

}  // namespace

bool is_same(const models::Gaussian& a, const models::Gaussian& b) {
  return a.mean == b.mean && a.covariance == b.covariance;
}

std::optional<Information> propagate(const models::TargetModel& model, double step_s,
                                     const Information& information, Time last_seen, Time from,
                                     Time to) {
  // For a constant state the inversion would only add rounding errors.
  if (to == from || model.kind.law().is_constant) {
    return information;
  }
  const std::optional<models::Gaussian> belief = models::to_gaussian(information);
  if (!belief) {
    return std::nullopt;
  }
  return models::to_information(models::predict_unseen(*belief, model, to_seconds(to - from),
                                                       to_seconds(from - last_seen), step_s));
}

Use measure(Information& belief, const models::SensorModel& sensor, const models::Viewpoint& from,
            const models::Measurement& measurement, double gate_sigma) {
  const Eigen::Index n = position_rows(belief.vector.size());
  const std::optional<models::Gaussian> prior = models::to_gaussian(belief);
  const Eigen::LLT<MeasurementMatrix> noise(measurement.V);
  if (!prior || noise.info() != Eigen::Success) {
    return Use::kSingular;
  }
  if (belief.vector.size() == 4 && models::measures_velocity(sensor)) {
    return measure_state(belief, *prior, sensor, from, measurement, noise, gate_sigma);
  }
  const auto is_beyond_gate = [&](double mahalanobis2) {
    return gate_sigma > 0.0 && mahalanobis2 > gate_sigma * gate_sigma;
  };
  const models::PositionMatrix P_pp = prior->covariance.topLeftCorner(n, n);
  Tangent tangent;
  tangent.mean_m = prior->mean.head(n);
  tangent.expected = models::observe(sensor, from, tangent.mean_m);
  tangent.H = models::observation_jacobian(sensor, from, tangent.mean_m);
  const bool can_only_linearise = !can_integrate(sensor, n);
  if (can_only_linearise || is_linear_enough(tangent, P_pp, sensor, from, noise)) {
    const MeasurementJacobian H = state_jacobian(tangent.H, belief.vector.size());
    const MeasurementVector nu = models::innovation(sensor, measurement.z, tangent.expected);
    const models::Gaussian posterior = models::update(*prior, H, measurement.V, nu);
    if (can_only_linearise ||
        is_clear_of_limits(posterior, n, sensor, limit_softness(sensor, measurement.V), from)) {
      const MeasurementMatrix S = tangent.H * P_pp * tangent.H.transpose() + measurement.V;
      const MeasurementVector whitened = S.llt().matrixL().solve(nu);
      if (is_beyond_gate(whitened.squaredNorm())) {
        return Use::kGated;
      }
      add_linear(belief, H, noise, nu + tangent.H * tangent.mean_m);
      return Use::kUsed;
    }
  }
  const Eigen::LLT<models::PositionMatrix> spread(P_pp);
  if (spread.info() != Eigen::Success) {
    return Use::kSingular;
  }
  const PositionPrior before{tangent.mean_m, spread.solve(models::PositionMatrix::Identity(n, n))};
  const auto after = posterior_moments(before, sensor, from, measurement);
  if (!after) {
    return Use::kSingular;
  }
  if (is_beyond_gate(after->mahalanobis2)) {
    return Use::kGated;
  }
  return shift_position(belief, before, *after) ? Use::kUsed : Use::kSingular;
}

bool can_discover(const models::SensorModel& sensor) {
  return sensor.kind.law().position_from != nullptr;
}

std::optional<Information> discover(const scenario::EstimatorSpec& spec,
                                    const models::SensorModel& sensor,
                                    const models::Viewpoint& from,
                                    const models::Measurement& measurement) {
  const int n = spec.target_model.position_dim;
  if (!can_discover(sensor)) {
    return std::nullopt;
  }
  PositionPrior prior{models::PositionVector::Zero(n), models::PositionMatrix::Zero(n, n)};
  prior.mean_m.head<2>() = from.world_from_body.position_m();
  if (sensor.measurement_dim(n) < n) {
    const auto seen_m = models::position_from(sensor, from, measurement.z, n);
    if (!seen_m) {
      return std::nullopt;
    }
    const MeasurementJacobian J = models::observation_jacobian(sensor, from, *seen_m);
    const MeasurementMatrix JJt = J * J.transpose();
    const MeasurementJacobian JJt_inv_J = JJt.llt().solve(J);
    const models::PositionMatrix silent =
        models::PositionMatrix::Identity(n, n) - J.transpose() * JJt_inv_J;
    prior = {*seen_m, silent / (spec.prior_position_sigma_m * spec.prior_position_sigma_m)};
    if (!prior.information.allFinite()) {
      return std::nullopt;
    }
  }
  const auto seen = posterior_moments(prior, sensor, from, measurement);
  if (!seen) {
    return std::nullopt;
  }
  const Eigen::Index dim = spec.target_model.dim();
  models::Gaussian found{models::StateVector::Zero(dim), models::StateMatrix::Zero(dim, dim)};
  found.mean.head(n) = seen->mean_m;
  found.covariance.topLeftCorner(n, n) = seen->covariance_m2;
  if (const auto velocity_variance = spec.target_model.kind.law().velocity_variance) {
    found.covariance.diagonal().tail<2>() = velocity_variance(spec.target_model);
  } else {
    found.covariance.diagonal().tail(dim - n).setConstant(spec.prior_velocity_sigma_mps *
                                                          spec.prior_velocity_sigma_mps);
  }
  return models::to_information(found);
}

bool doubt(Track& track, const scenario::EstimatorSpec& spec, const models::SensorModel& sensor,
           const models::Viewpoint& from, const models::Measurement& measurement, Time time) {
  const auto found = discover(spec, sensor, from, measurement);
  auto belief = models::to_gaussian(track.information);
  if (!found || !belief) {
    return false;
  }
  const auto there = models::to_gaussian(*found);
  if (!there) {
    return false;
  }
  const models::StateVector off = there->mean - belief->mean;
  belief->covariance += kDoubt * (there->covariance + off * off.transpose());
  const auto doubted = models::to_information(*belief);
  if (doubted) {
    track.information = *doubted;
    track.doubted = time;
  }
  return doubted.has_value();
}

}  // namespace vantage::estimator
