#include <cmath>

#include "models/target/kinds/kinds.hpp"

// A target that stays in an area: on each axis ÿ = −(σ_v²/σ_p²)(y − c) − γ ẏ + white noise of
// density 2 γ σ_v²; state (y₁, y₂, ẏ₁, ẏ₂). Source: Uhlenbeck, Ornstein, On the theory of the
// Brownian motion (1930), part II.

namespace vantage::models::target_kinds {
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

AxisStep axis_step(const DampedOscillator& of, Eigen::Index axis, double t) {
  const double omega = of.velocity_sigma_mps(axis) / of.position_sigma_m(axis);
  return axis_step(omega * omega, of.damping_per_s(axis), t);
}

StateMatrix oscillator_transition(const TargetModel& model, double dt_s) {
  StateMatrix A = StateMatrix::Identity(4, 4);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const AxisStep step = axis_step(model.oscillator, i, dt_s);
    A(i, i) = step.a;
    A(i, i + 2) = step.b;
    A(i + 2, i) = step.c;
    A(i + 2, i + 2) = step.d;
  }
  return A;
}

// W restores the stationary covariance that A reduces.
StateMatrix oscillator_noise(const TargetModel& model, double dt_s, int /*steps_unseen*/) {
  const DampedOscillator& of = model.oscillator;
  StateMatrix W = StateMatrix::Zero(4, 4);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const AxisStep step = axis_step(of, i, dt_s);
    const double p = of.position_sigma_m(i) * of.position_sigma_m(i);
    const double v = of.velocity_sigma_mps(i) * of.velocity_sigma_mps(i);
    W(i, i) = p - (step.a * step.a * p + step.b * step.b * v);
    W(i, i + 2) = of.damping_per_s(i) * v * step.b * step.b;
    W(i + 2, i) = W(i, i + 2);
    W(i + 2, i + 2) = v - (step.c * step.c * p + step.d * step.d * v);
  }
  return W;
}

std::optional<std::string_view> broken_oscillator_rule(const TargetModel& model) {
  const DampedOscillator& of = model.oscillator;
  const auto are_positive = [](const Eigen::Vector2d& values) {
    return values.allFinite() && values.minCoeff() > 0.0;
  };
  if (!of.center_m.allFinite()) {
    return "center_m: must be finite";
  }
  if (!are_positive(of.position_sigma_m)) {
    return "position_sigma_m: must be > 0";
  }
  if (!are_positive(of.velocity_sigma_mps)) {
    return "velocity_sigma_mps: must be > 0";
  }
  if (!are_positive(of.damping_per_s)) {
    return "damping_per_s: must be > 0";
  }
  return std::nullopt;
}

}  // namespace

constinit const TargetLaw damped_oscillator{
    .name = "damped_oscillator",
    .has_velocity = true,
    .uses_oscillator = true,
    .transition = oscillator_transition,
    .process_noise = oscillator_noise,
    .center_m = [](const TargetModel& model) { return model.oscillator.center_m; },
    .velocity_variance =
        [](const TargetModel& model) {
          return Eigen::Vector2d(model.oscillator.velocity_sigma_mps.cwiseAbs2());
        },
    .broken_rule = broken_oscillator_rule};

}  // namespace vantage::models::target_kinds
