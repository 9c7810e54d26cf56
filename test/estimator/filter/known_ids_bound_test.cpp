#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "models/sensor/clutter.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"

// Lower bound on the cost of unknown detection ids, for any filter. The test uses no code of the
// estimator. Targets move by the model of the lab's filter, so the posterior of one target is known
// exactly, as particles.
//
// Each target is tracked twice on the same observations. *Known ids*: the filter knows which
// detection is the target's. *Oracle*: the filter knows which detections belong to other targets,
// and only has to separate the target's own detection from false alarms. A filter without ids has
// less information than the oracle. The posterior mean has the minimum mean square error for its
// information.

namespace vantage {
namespace {

constexpr int kTargets = 5;
constexpr double kStep_s = 0.5;
constexpr double kSpeed_mps = 1.0;
constexpr int kUnjudgedSteps = 20;

unsigned from_environment(const char* name, unsigned otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : static_cast<unsigned>(std::stoul(text));
}

/// The motion model of config/lab.yaml.
const models::TargetModel kMotion{models::TargetKind::kDampedOscillator,
                                  2,
                                  0.0,
                                  {{0.0, 0.0}, {1.75, 0.83}, {0.47, 0.29}, {0.24, 0.41}}};

models::SensorModel lab_sensor() {
  models::SensorModel sensor;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 1.0;
  sensor.range_sigma_m = 0.3;
  sensor.bearing_sigma_rad = radians(5.0);
  return sensor;
}

using State = Eigen::Vector4d;

struct Motion {
  Eigen::Matrix4d A = kMotion.transition(kStep_s);
  Eigen::Matrix4d root = Eigen::Matrix4d(kMotion.process_noise(kStep_s)).llt().matrixL();
};

State normal_state(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  return {normal(rng), normal(rng), normal(rng), normal(rng)};
}

State stationary(std::mt19937_64& rng) {
  const models::DampedOscillator& s = kMotion.oscillator;
  return normal_state(rng).cwiseProduct(State(s.position_sigma_m.x(), s.position_sigma_m.y(),
                                              s.velocity_sigma_mps.x(), s.velocity_sigma_mps.y()));
}

/// Returns the density of a false alarm in (range, bearing): a position uniform over the visible
/// ring, measured with the sensor's noise.
double false_density(const models::SensorModel& sensor, double z_m) {
  constexpr int kRings = 200;
  double sum = 0.0;
  double area = 0.0;
  for (int i = 0; i < kRings; ++i) {
    const double r_m =
        sensor.range_min_m + (sensor.range_max_m - sensor.range_min_m) * (i + 0.5) / kRings;
    const double off = (z_m - r_m) / sensor.range_sigma_m;
    sum += r_m * std::exp(-0.5 * off * off);
    area += r_m;
  }
  return sum / area / (std::sqrt(2.0 * kPi) * sensor.range_sigma_m) / (2.0 * kPi);
}

/// The exact posterior of one target.
class Posterior {
 public:
  Posterior(std::size_t particles, std::mt19937_64& rng) : rng_(rng()), states_(particles) {
    for (State& state : states_) {
      state = stationary(rng_);
    }
    next_.resize(particles);
    likelihoods_.resize(particles);
  }

  void move(const Motion& motion) {
    for (State& state : states_) {
      state = motion.A * state + motion.root * normal_state(rng_);
    }
  }

  /// Updates the particles with `candidates`, at most one of which originates from the target.
  /// If `is_told`, no candidate is a false alarm.
  void look(const models::SensorModel& sensor, const Eigen::Vector2d& eye_m,
            const std::vector<models::Measurement>& candidates, bool is_told,
            const models::DetectionModel& detection) {
    const double p_D = detection.detection_probability;
    const double scale = 2.0 * kPi * sensor.range_sigma_m * sensor.bearing_sigma_rad;
    std::array<double, 32> others{};  // intensity of false alarms at each candidate
    for (std::size_t j = 0; j < candidates.size(); ++j) {
      others[j] = detection.clutter_per_look * false_density(sensor, candidates[j].z(0));
    }
    double total = 0.0;
    bool is_seen = false;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const Eigen::Vector2d off_m = states_[i].head<2>() - eye_m;
      const double r_m = off_m.norm();
      const bool in_view = r_m >= sensor.range_min_m && r_m < sensor.range_max_m;
      is_seen = is_seen || in_view;
      double likelihood = is_told && !candidates.empty() ? 0.0 : 1.0 - (in_view ? p_D : 0.0);
      for (std::size_t j = 0; in_view && j < candidates.size(); ++j) {
        const double range = (candidates[j].z(0) - r_m) / sensor.range_sigma_m;
        const double bearing = wrap_to_pi(candidates[j].z(1) - std::atan2(off_m.y(), off_m.x())) /
                               sensor.bearing_sigma_rad;
        const double fit = std::exp(-0.5 * (range * range + bearing * bearing)) / scale;
        likelihood += p_D * fit / (is_told ? 1.0 : others[j]);
      }
      total += likelihood;
      likelihoods_[i] = total;
    }
    if (!is_seen && !(is_told && !candidates.empty())) {
      return;
    }
    if (!(total > 0.0)) {
      start_anew(eye_m, candidates.front());
      return;
    }
    const double first = std::uniform_real_distribution<double>()(rng_);
    std::size_t from = 0;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const double at =
          total * (static_cast<double>(i) + first) / static_cast<double>(states_.size());
      while (from + 1 < states_.size() && likelihoods_[from] < at) {
        ++from;
      }
      next_[i] = states_[from];
    }
    states_.swap(next_);
  }

  [[nodiscard]] Eigen::Vector2d mean_m() const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const State& state : states_) {
      sum += state.head<2>();
    }
    return sum / static_cast<double>(states_.size());
  }
  [[nodiscard]] double variance_m2() const {
    const Eigen::Vector2d mean = mean_m();
    double sum = 0.0;
    for (const State& state : states_) {
      sum += (state.head<2>() - mean).squaredNorm();
    }
    return sum / static_cast<double>(states_.size());
  }

 private:
  /// Re-initialises the particles around the measurement if no particle fits the measurement.
  void start_anew(const Eigen::Vector2d& eye_m, const models::Measurement& z) {
    std::normal_distribution<double> normal;
    for (State& state : states_) {
      const double r_m = std::clamp(z.z(0) + std::sqrt(z.V(0, 0)) * normal(rng_), 0.1, 1.0);
      const double angle_rad = z.z(1) + std::sqrt(z.V(1, 1)) * normal(rng_);
      state = stationary(rng_);
      state.head<2>() = eye_m + r_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    }
  }

  std::mt19937_64 rng_;
  std::vector<State> states_;
  std::vector<State> next_;
  std::vector<double> likelihoods_;  ///< cumulative sums of the likelihoods
};

/// Errors summed over targets and time.
struct Errors {
  double squared_m2 = 0.0;
  double believed_m2 = 0.0;
  int samples = 0;
  void add(const Posterior& posterior, const Eigen::Vector2d& true_m) {
    squared_m2 += (posterior.mean_m() - true_m).squaredNorm();
    believed_m2 += posterior.variance_m2();
    ++samples;
  }
  [[nodiscard]] double rmse_m() const { return std::sqrt(squared_m2 / samples); }
};
struct Both {
  Errors known_ids;
  Errors oracle;
};

// Moves each robot to the unassigned target with the largest variance relative to its distance.
void chase(std::vector<Eigen::Vector2d>& eyes_m, const std::vector<Posterior>& beliefs) {
  std::vector<char> is_taken(beliefs.size(), 0);
  for (Eigen::Vector2d& eye_m : eyes_m) {
    std::size_t chosen = 0;
    double most = -1.0;
    for (std::size_t t = 0; t < beliefs.size(); ++t) {
      const double worth = beliefs[t].variance_m2() / (0.5 + (beliefs[t].mean_m() - eye_m).norm());
      if (is_taken[t] == 0 && worth > most) {
        most = worth;
        chosen = t;
      }
    }
    is_taken[chosen] = 1;
    const Eigen::Vector2d way_m = beliefs[chosen].mean_m() - eye_m;
    eye_m += std::min(1.0, kSpeed_mps * kStep_s / std::max(1e-9, way_m.norm())) * way_m;
  }
}

enum class Chase { kByKnownIds, kByOracle };

// Simulates one trial and returns the errors of both filters.
Both trial(unsigned seed, Chase by, int steps, std::size_t particles,
           const models::DetectionModel& detection) {
  std::mt19937_64 rng(seed);
  const Motion motion;
  const models::SensorModel sensor = lab_sensor();
  std::vector<State> targets(kTargets);
  for (State& target : targets) {
    target = stationary(rng);
  }
  std::vector<Posterior> with_ids;
  std::vector<Posterior> oracle;
  for (int t = 0; t < kTargets; ++t) {
    with_ids.emplace_back(particles, rng);
    oracle.emplace_back(particles, rng);
  }
  std::vector<Eigen::Vector2d> eyes_m = {{-3.0, 0.0}, {0.0, 0.0}, {3.0, 0.0}};
  Both out;
  std::vector<models::Measurement> own;
  for (int k = 0; k < steps; ++k) {
    for (std::size_t t = 0; t < targets.size(); ++t) {
      targets[t] = motion.A * targets[t] + motion.root * normal_state(rng);
      with_ids[t].move(motion);
      oracle[t].move(motion);
    }
    chase(eyes_m, by == Chase::kByKnownIds ? with_ids : oracle);
    for (const Eigen::Vector2d& eye_m : eyes_m) {
      const models::Viewpoint from{{eye_m.x(), eye_m.y(), 0.0}, 1.0};
      const auto false_alarms =
          models::sample_clutter(sensor, from, detection.clutter_per_look, rng);
      for (std::size_t t = 0; t < targets.size(); ++t) {
        const models::PositionVector place_m = targets[t].head<2>();
        own.clear();
        if (models::in_view(sensor, from, place_m) &&
            std::uniform_real_distribution<double>()(rng) < detection.detection_probability) {
          own.push_back(models::sample(sensor, from, place_m, rng));
        }
        with_ids[t].look(sensor, eye_m, own, true, detection);
        own.insert(own.end(), false_alarms.begin(), false_alarms.end());
        oracle[t].look(sensor, eye_m, own, false, detection);
      }
    }
    for (std::size_t t = 0; k >= kUnjudgedSteps && t < targets.size(); ++t) {
      out.known_ids.add(with_ids[t], targets[t].head<2>());
      out.oracle.add(oracle[t], targets[t].head<2>());
    }
  }
  return out;
}

struct Ratio {
  double sum = 0.0;
  double squares = 0.0;
  int trials = 0;
  void add(double ratio) {
    sum += ratio;
    squares += ratio * ratio;
    ++trials;
  }
  [[nodiscard]] double mean() const { return sum / trials; }
  [[nodiscard]] double standard_error() const {
    const double variance = std::max(0.0, squares / trials - mean() * mean());
    return std::sqrt(variance / std::max(1, trials - 1));
  }
};

// Runs VANTAGE_BOUND_SEEDS trials from seed VANTAGE_BOUND_FIRST on. Each has VANTAGE_BOUND_STEPS
// steps of half a second and VANTAGE_BOUND_PARTICLES particles.
TEST(KnownIds, ReduceTheErrorBelowTheBoundForUnknownIds) {
  const unsigned first = from_environment("VANTAGE_BOUND_FIRST", 101);
  const unsigned seeds = from_environment("VANTAGE_BOUND_SEEDS", 2);
  const int steps = static_cast<int>(from_environment("VANTAGE_BOUND_STEPS", 200));
  const std::size_t particles = from_environment("VANTAGE_BOUND_PARTICLES", 1000);
  const models::DetectionModel detection{0.9, 1.0, true};
  Ratio same_looks;
  Ratio own_looks;
  for (unsigned seed = first; seed < first + seeds; ++seed) {
    const Both of_known = trial(seed, Chase::kByKnownIds, steps, particles, detection);
    const Both of_oracle = trial(seed, Chase::kByOracle, steps, particles, detection);
    const double known_m = of_known.known_ids.rmse_m();
    same_looks.add(of_known.oracle.rmse_m() / known_m);
    own_looks.add(of_oracle.oracle.rmse_m() / known_m);
    std::cout << seed << ": known ids " << known_m << " m, oracle with the same observations "
              << of_known.oracle.rmse_m() << " m, oracle with separate observations "
              << of_oracle.oracle.rmse_m() << " m; believed over true variance "
              << of_known.known_ids.believed_m2 / of_known.known_ids.squared_m2 << ", "
              << of_known.oracle.believed_m2 / of_known.oracle.squared_m2 << ", "
              << of_oracle.oracle.believed_m2 / of_oracle.oracle.squared_m2 << std::endl;
  }
  std::cout << "ratio with the same observations " << same_looks.mean() << ", standard error "
            << same_looks.standard_error() << "; with separate observations " << own_looks.mean()
            << ", " << own_looks.standard_error() << "\n";
  EXPECT_GT(same_looks.mean(), 1.15);
  EXPECT_GT(own_looks.mean(), 1.15);
}

}  // namespace
}  // namespace vantage
