#include "experiments/tracked_targets.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "estimator/confinement.hpp"
#include "estimator/missed_detection.hpp"
#include "estimator/track.hpp"

namespace vantage::experiments {
namespace {

// Gaussian noise with the covariance that `root` is of, which may be singular.
models::StateVector draw(const Eigen::LDLT<models::StateMatrix>& root, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  models::StateVector white(root.rows());
  for (Eigen::Index i = 0; i < white.size(); ++i) {
    white(i) = normal(rng);
  }
  const models::StateVector scaled = root.vectorD().cwiseMax(0.0).cwiseSqrt().cwiseProduct(white);
  return root.transpositionsP().transpose() * (root.matrixL() * scaled).eval();
}

template <class Condition>
bool any_of(std::size_t count, const Condition& holds) {
  for (std::size_t i = 0; i < count; ++i) {
    if (holds(i)) {
      return true;
    }
  }
  return false;
}

// A target that leaves the world comes back the way it would from a mirror.
void reflect(models::StateVector& state, const models::Rectangle& bounds) {
  for (int axis = 0; axis < 2; ++axis) {
    const double inside_m = std::clamp(state(axis), bounds.min_m(axis), bounds.max_m(axis));
    if (inside_m != state(axis)) {
      state(axis) = 2.0 * inside_m - state(axis);
      state(axis + 2) = -state(axis + 2);
    }
  }
}

}  // namespace

TrackedTargets::TrackedTargets(const TargetSetting& setting, const models::World& world,
                               std::uint64_t seed)
    : setting_(setting),
      world_(&world),
      truth_rng_(seed),
      noise_rng_(~seed),
      model_{models::TargetKind::kDoubleIntegrator, 2, setting.q_m2ps3},
      A_(model_.transition(setting.step_s)),
      W_(model_.process_noise(setting.step_s)),
      root_of_W_(W_) {
  std::uniform_real_distribution<double> off_m(-0.5 * setting.start_side_m,
                                               0.5 * setting.start_side_m);
  const Eigen::Vector2d middle_m = 0.5 * (world.bounds.min_m + world.bounds.max_m);
  models::StateMatrix prior = models::StateMatrix::Zero(4, 4);
  prior.diagonal().head(2).setConstant(std::pow(setting.prior_position_sigma_m, 2));
  prior.diagonal().tail(2).setConstant(std::pow(setting.prior_velocity_sigma_mps, 2));
  const Eigen::LDLT<models::StateMatrix> root_of_prior(prior);
  for (int m = 0; m < setting.count; ++m) {
    models::StateVector state = models::StateVector::Zero(4);
    state(0) = middle_m.x() + off_m(truth_rng_);
    state(1) = middle_m.y() + off_m(truth_rng_);
    truth_.push_back(state);
    beliefs_.push_back({state + draw(root_of_prior, truth_rng_), prior});
  }
  is_seen_.assign(truth_.size(), 0);
}

void TrackedTargets::move() {
  for (models::StateVector& state : truth_) {
    state = A_ * state + draw(root_of_W_, truth_rng_);
    reflect(state, world_->bounds);
  }
  for (models::Gaussian& belief : beliefs_) {
    belief = models::predict(belief, A_, W_);
    if (setting_.beliefs_stay_inside) {
      belief = estimator::reflect(belief, world_->bounds);
    }
  }
}

void TrackedTargets::look(const models::SensorModel& sensor, const std::vector<Pose2>& poses,
                          const std::vector<char>& is_blind) {
  for (std::size_t m = 0; m < truth_.size(); ++m) {
    const models::PositionVector target_m = truth_[m].head(2);
    // Where it is not comes first: what robots that do not see it know does not depend on a
    // measurement, and a narrow belief beside a field of view is not touched by it.
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const models::Viewpoint from{poses[i], 0.0};
      if (setting_.detection_probability > 0.0 && is_blind[i] == 0 &&
          !models::in_view(sensor, from, target_m)) {
        beliefs_[m] = estimator::missed_detection(beliefs_[m], sensor, from, *world_,
                                                  setting_.detection_probability);
      }
    }
    is_seen_[m] = 0;
    // There and back by the information would only round it.
    const auto sees = [&](std::size_t i) {
      return is_blind[i] == 0 && models::in_view(sensor, {poses[i], 0.0}, target_m);
    };
    if (setting_.detection_probability <= 0.0 && !any_of(poses.size(), sees)) {
      continue;
    }
    std::optional<models::Information> information = models::to_information(beliefs_[m]);
    for (std::size_t i = 0; information && i < poses.size(); ++i) {
      const models::Viewpoint from{poses[i], 0.0};
      if (is_blind[i] != 0 || !models::in_view(sensor, from, target_m)) {
        continue;
      }
      const models::Measurement z = models::sample(sensor, from, target_m, noise_rng_);
      const bool is_used =
          estimator::measure(*information, sensor, from, z, 0.0) == estimator::Use::kUsed;
      is_seen_[m] = is_used ? 1 : is_seen_[m];
    }
    const auto updated = information ? models::to_gaussian(*information) : std::nullopt;
    beliefs_[m] = updated.value_or(beliefs_[m]);
  }
}

std::vector<TargetStep> TrackedTargets::steps() const {
  std::vector<TargetStep> steps;
  for (std::size_t m = 0; m < truth_.size(); ++m) {
    const models::StateVector error = truth_[m] - beliefs_[m].mean;
    const double nees = error.dot(beliefs_[m].covariance.llt().solve(error));
    steps.push_back({error.head<2>().norm(), nees, is_seen_[m] != 0});
  }
  return steps;
}

}  // namespace vantage::experiments
