#include "estimator/tracks/samples/samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/angle.hpp"
#include "estimator/posterior/confinement.hpp"
#include "estimator/posterior/missed_detection.hpp"
#include "estimator/posterior/view_limits.hpp"

namespace vantage::estimator {
namespace {

using State = Samples::State;
constexpr std::size_t kSize = Samples::kCount;
using Weights = std::array<double, kSize>;

/// Returns points of N(0, I) with exact mean 0 and covariance I; for each point, its negative is
/// included. They are low-discrepancy points in the unit cube (Roberts 2018, multiples of the
/// powers of 1/φ₄), transformed by Box and Muller (1958).
std::array<State, kSize> standard_points() {
  constexpr double kPhi = 1.1673039782614187;  // φ⁵ = φ + 1
  std::array<State, kSize> points;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; i < kSize / 2; ++i) {
    std::array<double, 4> u;
    double step = 1.0;
    for (double& each : u) {
      step /= kPhi;
      const double at = 0.5 + static_cast<double>(i + 1) * step;
      each = at - std::floor(at);
    }
    State& z = points[i];
    for (std::size_t pair = 0; pair < 4; pair += 2) {
      const double r = std::sqrt(-2.0 * std::log(1.0 - u[pair]));
      z(static_cast<Eigen::Index>(pair)) = r * std::cos(2.0 * kPi * u[pair + 1]);
      z(static_cast<Eigen::Index>(pair + 1)) = r * std::sin(2.0 * kPi * u[pair + 1]);
    }
    covariance += 2.0 * z * z.transpose() / static_cast<double>(kSize);
  }
  const Eigen::LLT<Eigen::Matrix4d> root(covariance);
  for (std::size_t i = 0; i < kSize / 2; ++i) {
    points[i] = root.matrixL().solve(points[i]).eval();
    points[i + kSize / 2] = -points[i];
  }
  return points;
}

const std::array<State, kSize>& points() {
  static const std::array<State, kSize> all = standard_points();
  return all;
}

/// Returns a hash of `key`.
/// Source: Steele, Lea, Flood, Fast splittable pseudorandom number generators (2014).
std::uint64_t mixed(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15U;
  key = (key ^ (key >> 30U)) * 0xbf58476d1ce4e5b9U;
  key = (key ^ (key >> 27U)) * 0x94d049bb133111ebU;
  return key ^ (key >> 31U);
}

/// Pairing of kSize items with kSize others. Item i is paired with a i + b; a is odd, so that each
/// item is used once.
class Pairing {
 public:
  explicit Pairing(std::uint64_t bits) : a_((bits >> 8U) | 1U), b_(bits >> 40U) {}
  std::size_t operator()(std::size_t i) const { return (a_ * i + b_) % kSize; }

 private:
  std::size_t a_;
  std::size_t b_;
};

/// Number of partners tried for a sample that overlaps its partner.
constexpr std::size_t kPairsTried = 4;
/// Random shift of duplicates, as a share of the σ of all samples. Determined by experiment
/// (docs/decisions/0023).
constexpr double kSmear = 0.3;
/// Step between the used points of the table. It is odd, so that each point is used once, and
/// larger than the usual number of duplicates of a sample.
constexpr std::size_t kSmearStep = 101;

/// Applies a collision that happens after `at_s` to a state that moves against the unit vector
/// `away`: reverses the velocity component along `away`. The position is changed as if the state
/// had moved with the new velocity from the start.
void reflect_from(State& state, const Eigen::Vector2d& away, double at_s) {
  const Eigen::Vector2d v_mps = state.tail<2>();
  const Eigen::Vector2d by_x(-v_mps.x(), v_mps.y());
  const Eigen::Vector2d turned_mps = by_x.dot(away) >= 0.0 ? by_x : Eigen::Vector2d(-by_x);
  state.head<2>() += (v_mps - turned_mps) * at_s;
  state.tail<2>() = turned_mps;
}

/// Returns the squared distance of the two positions minus distance_m², m²; the two overlap if the
/// result is negative.
double beyond(const State& one, const State& other, double distance_m) {
  return (one - other).head<2>().squaredNorm() - distance_m * distance_m;
}

/// Time and direction of the first collision of a sample with its partner.
struct Contact {
  double at_s;
  Eigen::Vector2d away;  ///< unit vector from the partner to this sample
};
std::optional<Contact> contact(const State& one, const State& other, double distance_m,
                               double dt_s) {
  const Eigen::Vector2d apart_m = one.head<2>() - other.head<2>();
  const Eigen::Vector2d change_mps = one.tail<2>() - other.tail<2>();
  const double closing = -apart_m.dot(change_mps);
  const double square = change_mps.squaredNorm();
  // Computes the first solution t of |apart + change t| = distance.
  const double discriminant = closing * closing - square * beyond(one, other, distance_m);
  if (closing <= 0.0 || discriminant <= 0.0) {
    return std::nullopt;
  }
  const double at_s = (closing - std::sqrt(discriminant)) / square;
  const Eigen::Vector2d away = (apart_m + at_s * change_mps).normalized();
  // Ignores a contact that is too late, or in which only the partner moves towards the other.
  if (at_s > dt_s || one.tail<2>().dot(away) >= 0.0) {
    return std::nullopt;
  }
  return Contact{at_s, away};
}

/// A subset of the samples.
struct Part {
  std::vector<std::size_t> members;
  double weight = 0.0;
  State mean = State::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  double widest_m2 = 0.0;  ///< m²; position variance along `along`
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();

  /// Computes the moments of the members; zero if their weight is zero.
  void describe(const Weights& weights, const std::array<State, kSize>& states) {
    weight = 0.0;
    State sum = State::Zero();
    for (const std::size_t i : members) {
      weight += weights[i];
      sum += weights[i] * states[i];
    }
    mean = weight > 0.0 ? State(sum / weight) : State::Zero();
    covariance.setZero();
    for (std::size_t k = 0; weight > 0.0 && k < members.size(); ++k) {
      const State off = states[members[k]] - mean;
      covariance += weights[members[k]] / weight * off * off.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(
        Eigen::Matrix2d(covariance.topLeftCorner<2, 2>()));
    widest_m2 = axes.eigenvalues()(1);
    along = axes.eigenvectors().col(1);
  }
  /// Returns the approximate reduction of variance by a split; 0 if the part is at most sigma_m
  /// wide.
  [[nodiscard]] double split_gain(double sigma_m) const {
    return widest_m2 > sigma_m * sigma_m ? weight * widest_m2 : 0.0;
  }
};

/// Returns, for each of kSize equal shares of the weight, the sample at its middle.
/// Source: Kitagawa (1996).
std::array<std::size_t, kSize> systematic(const Weights& weights) {
  std::array<std::size_t, kSize> chosen;
  double passed = 0.0;
  std::size_t from = 0;
  for (std::size_t i = 0; i < kSize; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / kSize;
    while (from + 1 < kSize && passed + weights[from] < at) {
      passed += weights[from++];
    }
    chosen[i] = from;
  }
  return chosen;
}

/// Returns the effective number of samples.
/// Source: Kong, Liu, Wong (1994).
double effective_count(const Weights& weights, double sum) {
  double squares = 0.0;
  for (const double weight : weights) {
    squares += weight * weight;
  }
  return sum * sum / squares;
}

}  // namespace

Samples& Samples::operator=(const Samples& other) {
  size_ = other.size_;
  if (size_ > 0) {
    weights_ = other.weights_;
    states_ = other.states_;
  }
  return *this;
}

void Samples::spread(const models::Gaussian& belief) {
  const Eigen::LLT<Eigen::Matrix4d> root(belief.covariance);
  size_ = root.info() == Eigen::Success ? kCount : 0;
  if (empty()) {
    return;
  }
  const Eigen::Matrix4d L = root.matrixL();
  const State mean = belief.mean;
  weights_.fill(1.0 / kCount);
  for (std::size_t i = 0; i < kSize; ++i) {
    states_[i] = mean + L * points()[i];
  }
}

models::Gaussian Samples::moments() const {
  State mean = State::Zero();
  for (std::size_t i = 0; i < kSize; ++i) {
    mean += weights_[i] * states_[i];
  }
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; i < kSize; ++i) {
    const State off = states_[i] - mean;
    covariance += weights_[i] * off * off.transpose();
  }
  return {mean, covariance};
}

models::Mixture Samples::parts(double sigma_m) const {
  std::vector<Part> parts(1);
  parts[0].members.resize(kSize);
  std::iota(parts[0].members.begin(), parts[0].members.end(), std::size_t{0});
  parts[0].describe(weights_, states_);
  while (parts.size() < kPartsMax) {
    const auto next =
        std::max_element(parts.begin(), parts.end(), [&](const Part& a, const Part& b) {
          return a.split_gain(sigma_m) < b.split_gain(sigma_m);
        });
    if (next->split_gain(sigma_m) <= 0.0) {
      break;
    }
    Part beyond;
    std::vector<std::size_t> members;
    for (const std::size_t i : next->members) {
      const Eigen::Vector2d off_m = (states_[i] - next->mean).head<2>();
      (off_m.dot(next->along) >= 0.0 ? beyond.members : members).push_back(i);
    }
    next->members = std::move(members);
    next->describe(weights_, states_);
    beyond.describe(weights_, states_);
    parts.push_back(std::move(beyond));
  }
  models::Mixture mixture;
  for (const Part& part : parts) {
    if (part.weight > 0.0) {
      mixture.push_back({part.weight, {part.mean, part.covariance}});
      mixture.back().belief.covariance.diagonal() +=
          Eigen::Vector4d(kGrain_m2, kGrain_m2, kGrain_m2ps2, kGrain_m2ps2);
    }
  }
  return mixture;
}

void Samples::predict(const models::TargetModel& model, double dt_s, std::uint64_t key) {
  const Eigen::Matrix4d A = model.transition(dt_s);
  const State offset = model.expected(State::Zero().eval(), dt_s);
  const Eigen::LDLT<Eigen::Matrix4d> factors(model.process_noise(dt_s).eval());
  const Eigen::Vector4d scale = factors.vectorD().cwiseMax(0.0).cwiseSqrt();
  Eigen::Matrix4d root = factors.transpositionsP().transpose() *
                         (Eigen::Matrix4d(factors.matrixL()) * scale.asDiagonal());
  // Each sample receives the noise of one point of the table. One of 16 sign patterns is applied to
  // all points.
  const std::uint64_t bits = mixed(key);
  const Pairing noise_of(bits);
  for (Eigen::Index axis = 0; axis < 4; ++axis) {
    root.col(axis) *= ((bits >> static_cast<unsigned>(axis)) & 1U) == 0 ? 1.0 : -1.0;
  }
  for (std::size_t i = 0; i < kSize; ++i) {
    states_[i] = offset + A * states_[i] + root * points()[noise_of(i)];
  }
}

void Samples::turn_back(const models::Rectangle& bounds) {
  for (State& state : states_) {
    for (const Eigen::Index axis : {0, 1}) {
      const Folded inside = fold(state(axis), bounds.min_m(axis), bounds.max_m(axis));
      state(axis) = inside.position_m;
      state(axis + 2) *= inside.sign;
    }
  }
}

bool Samples::collide_with(const Samples& others, double distance_m, double dt_s,
                           std::uint64_t key) {
  const Pairing partner(mixed(key));
  const std::array<std::size_t, kSize> chosen = systematic(others.weights_);
  bool has_collided = false;
  for (std::size_t i = 0; i < kSize; ++i) {
    // An overlapping pair is impossible and carries no information, so another partner is tried.
    const State* other = nullptr;
    for (std::size_t attempt = 0; attempt < kPairsTried && other == nullptr; ++attempt) {
      const State& next = others.states_[chosen[partner(i + attempt)]];
      other = beyond(states_[i], next, distance_m) >= 0.0 ? &next : nullptr;
    }
    const auto met = other == nullptr || weights_[i] <= 0.0
                         ? std::nullopt
                         : contact(states_[i], *other, distance_m, dt_s);
    if (met) {
      reflect_from(states_[i], met->away, met->at_s);
      has_collided = true;
    }
  }
  return has_collided;
}

template <class Likelihood>
Weights Samples::weighed(const Likelihood& likelihood) const {
  Weights weights;
  for (std::size_t i = 0; i < kSize; ++i) {
    weights[i] = weights_[i] * likelihood(models::PositionVector(states_[i].head<2>()),
                                          Eigen::Vector2d(states_[i].tail<2>()));
  }
  return weights;
}

bool Samples::take(Weights weights, double least) {
  double sum = 0.0;
  for (const double weight : weights) {
    sum += weight;
  }
  if (!(sum > 0.0) || effective_count(weights, sum) < least) {
    return false;
  }
  for (double& weight : weights) {
    weight /= sum;
  }
  weights_ = weights;
  if (effective_count(weights_, 1.0) >= 0.5 * kCount) {
    return true;
  }
  std::array<State, kSize> chosen;
  double passed = 0.0;
  std::size_t from = 0;
  for (std::size_t i = 0; i < kSize; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / kCount;
    while (from + 1 < kSize && passed + weights_[from] < at) {
      passed += weights_[from++];
    }
    chosen[i] = states_[from];
  }
  states_ = chosen;
  weights_.fill(1.0 / kCount);
  regularise();
  return true;
}

void Samples::regularise() {
  const Eigen::LLT<Eigen::Matrix4d> root(moments().covariance);
  if (root.info() != Eigen::Success) {
    return;
  }
  const Eigen::Matrix4d L = kSmear * Eigen::Matrix4d(root.matrixL());
  for (std::size_t i = 0; i < kSize; ++i) {
    states_[i] += L * points()[(kSmearStep * i) % kSize];
  }
}

bool Samples::keep_out_of(const std::vector<models::Obstacle>& obstacles) {
  bool is_any_inside = false;
  const Weights weights = weighed([&](const models::PositionVector& y_m, const auto&) {
    const Eigen::Vector2d p_m = y_m;
    const bool is_inside =
        std::any_of(obstacles.begin(), obstacles.end(),
                    [&](const models::Obstacle& box) { return box.footprint.contains(p_m); });
    is_any_inside = is_any_inside || is_inside;
    return is_inside ? 0.0 : 1.0;
  });
  return !is_any_inside || take(weights, 1.0);
}

bool Samples::miss(const models::SensorModel& sensor, const models::Viewpoint& from,
                   const models::World& world, double detection_probability) {
  bool is_any_seen = false;
  const Weights weights = weighed([&](const models::PositionVector& y_m, const auto&) {
    const bool is_seen = can_report(sensor, from, world, y_m);
    is_any_seen = is_any_seen || is_seen;
    return is_seen ? 1.0 - detection_probability : 1.0;
  });
  return is_any_seen && take(weights, 0.0);
}

bool Samples::measure(const models::SensorModel& sensor, const models::Viewpoint& from,
                      const models::Measurement& measurement, double gate_sigma) {
  const Eigen::LLT<models::MeasurementMatrix> noise(measurement.V);
  if (noise.info() != Eigen::Success) {
    return false;
  }
  const LimitSoftness softness = limit_softness(sensor, measurement.V);
  bool is_any_near = gate_sigma <= 0.0;
  const Weights weights =
      weighed([&](const models::PositionVector& y_m, const Eigen::Vector2d& velocity_mps) {
        const models::MeasurementVector nu = models::innovation(
            sensor, measurement.z, models::observe(sensor, from, y_m, velocity_mps));
        const double mahalanobis2 = nu.dot(noise.solve(nu));
        is_any_near = is_any_near || mahalanobis2 <= gate_sigma * gate_sigma;
        return view_probability(sensor, softness, from, y_m) * std::exp(-0.5 * mahalanobis2);
      });
  return is_any_near && take(weights, kExplainMin);
}

}  // namespace vantage::estimator
