#include "models/target/target_model.hpp"

#include <cmath>

namespace vantage::models {
namespace {

/// The matrix exponential e^{Ft} for one axis, F = [0 1; −k −γ].
struct AxisStep {
  double a, b, c, d;
};

// With h = γ/2 and D = h² − k: b = e^{−ht} sinh(√D t)/√D, a = e^{−ht} cosh(√D t) + h b.
AxisStep axis_step(double k, double damping_per_s, double t) {
  constexpr double kSeries = 1e-3;
  const double h = 0.5 * damping_per_s;
  const double D = h * h - k;
  const double x = D * t * t;
  double even = 0.0;
  double odd = 0.0;
  if (std::abs(x) < kSeries) {
    even = std::exp(-h * t) * (1.0 + x / 2.0 * (1.0 + x / 12.0 * (1.0 + x / 30.0)));
    odd = std::exp(-h * t) * t * (1.0 + x / 6.0 * (1.0 + x / 20.0 * (1.0 + x / 42.0)));
  } else if (D < 0.0) {
    const double omega = std::sqrt(-D);
    even = std::exp(-h * t) * std::cos(omega * t);
    odd = std::exp(-h * t) * std::sin(omega * t) / omega;
  } else {
    const double mu = std::sqrt(D);
    const double slow = std::exp((mu - h) * t);
    const double fast = std::exp(-(mu + h) * t);
    even = 0.5 * (slow + fast);
    odd = 0.5 * (slow - fast) / mu;
  }
  return {even + h * odd, odd, -k * odd, even - h * odd};
}

AxisStep axis_step(const Surroundings& of, Eigen::Index axis, double t) {
  const double omega = of.velocity_sigma_mps(axis) / of.position_sigma_m(axis);
  return axis_step(omega * omega, of.damping_per_s(axis), t);
}

// Returns Σ j over integers j < k, interpolated linearly between integers.
double grown(double steps) {
  const double whole = std::floor(steps);
  return 0.5 * whole * (whole - 1.0) + whole * (steps - whole);
}

}  // namespace

int TargetModel::dim() const { return has_velocity() ? 4 : position_dim; }

StateMatrix TargetModel::transition(double dt_s) const {
  StateMatrix A = StateMatrix::Identity(dim(), dim());
  if (kind == TargetKind::kDoubleIntegrator) {
    A(0, 2) = dt_s;
    A(1, 3) = dt_s;
  } else if (kind == TargetKind::kDampedOscillator) {
    for (Eigen::Index i = 0; i < 2; ++i) {
      const AxisStep step = axis_step(surroundings, i, dt_s);
      A(i, i) = step.a;
      A(i, i + 2) = step.b;
      A(i + 2, i) = step.c;
      A(i + 2, i + 2) = step.d;
    }
  }
  return A;
}

StateVector TargetModel::expected(const StateVector& y, double dt_s) const {
  const StateMatrix A = transition(dt_s);
  if (kind != TargetKind::kDampedOscillator) {
    return A * y;
  }
  StateVector away = y;
  away.head<2>() -= surroundings.center_m;
  away = (A * away).eval();
  away.head<2>() += surroundings.center_m;
  return away;
}

StateMatrix TargetModel::process_noise(double dt_s, int steps_unseen) const {
  StateMatrix W = StateMatrix::Zero(dim(), dim());
  switch (kind) {
    case TargetKind::kStatic:
      break;
    case TargetKind::kRandomWalk:
      W.diagonal().setConstant(q * dt_s);
      break;
    case TargetKind::kDoubleIntegrator:
      W.diagonal().head(2).setConstant(q * dt_s * dt_s * dt_s / 3.0);
      W.diagonal().tail(2).setConstant(q * dt_s);
      W.topRightCorner(2, 2).diagonal().setConstant(q * dt_s * dt_s / 2.0);
      W.bottomLeftCorner(2, 2).diagonal().setConstant(q * dt_s * dt_s / 2.0);
      break;
    case TargetKind::kGrowingUncertainty:
      W.diagonal().setConstant(q * steps_unseen);
      break;
    case TargetKind::kDampedOscillator:  // W restores the stationary covariance that A reduces
      for (Eigen::Index i = 0; i < 2; ++i) {
        const AxisStep step = axis_step(surroundings, i, dt_s);
        const double p = surroundings.position_sigma_m(i) * surroundings.position_sigma_m(i);
        const double v = surroundings.velocity_sigma_mps(i) * surroundings.velocity_sigma_mps(i);
        W(i, i) = p - (step.a * step.a * p + step.b * step.b * v);
        W(i, i + 2) = surroundings.damping_per_s(i) * v * step.b * step.b;
        W(i + 2, i) = W(i, i + 2);
        W(i + 2, i + 2) = v - (step.c * step.c * p + step.d * step.d * v);
      }
      break;
  }
  return W;
}

StateMatrix TargetModel::grown_noise(double from_steps, double to_steps) const {
  return q * (grown(to_steps) - grown(from_steps)) * StateMatrix::Identity(dim(), dim());
}

TargetModel TargetModel::as_planned(double steps_unseen, double step_s) const {
  TargetModel planned = *this;
  if (kind == TargetKind::kGrowingUncertainty) {
    constexpr double kRounding = 1e-6;  // times are rounded to microseconds
    planned.kind = TargetKind::kRandomWalk;
    planned.q *= std::floor(steps_unseen + kRounding) / step_s;
  }
  return planned;
}

}  // namespace vantage::models
