#include "estimator/tracks/gaussian/position_hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "estimator/posterior/missed_detection.hpp"
#include "estimator/posterior/unscented.hpp"
#include "models/target/law.hpp"

namespace vantage::estimator {
namespace {

using models::Gaussian;
using models::PositionVector;

constexpr int kBearings = 36;            ///< cells of the first grid around a full circle
constexpr int kRanges = 16;              ///< cells of the first grid along the range
constexpr double kCellOverlap = 1.2;     ///< σ of a cell, relative to that of a uniform density
constexpr double kWeightMin = 1e-4;      ///< weight below which a hypothesis is dropped
constexpr double kMergeDistance = 0.7;   ///< σ; hypotheses whose means are nearer are merged
constexpr double kContradiction = 1e-6;  ///< likelihood, relative to that of a perfect match

double largest_eigenvalue(const Eigen::Matrix2d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(symmetric, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(1);
}

/// Returns the distance from `p_m` to the farthest point of `area`, m.
double farthest_m(const models::Rectangle& area, const Eigen::Vector2d& p_m) {
  return (area.max_m - p_m).cwiseAbs().cwiseMax((p_m - area.min_m).cwiseAbs()).norm();
}

bool is_free(const models::World& world, const Eigen::Vector2d& at_m) {
  return models::clearance_m(world, at_m) >= 0.0;
}

Gaussian moments_of(double weight_a, const Gaussian& a, double weight_b, const Gaussian& b) {
  const double share = weight_b / (weight_a + weight_b);
  const models::StateVector apart = b.mean - a.mean;
  Gaussian out = a;
  out.mean += share * apart;
  out.covariance = (1.0 - share) * a.covariance + share * b.covariance +
                   share * (1.0 - share) * apart * apart.transpose();
  return out;
}

/// Returns the belief of a target in a cell of the polar grid.
Gaussian cell_belief(const scenario::EstimatorSpec& spec, const Eigen::Vector2d& centre_m,
                     double direction_rad, double range_sigma_m, double across_sigma_m) {
  const Eigen::Index dim = spec.target_model.dim();
  Gaussian out{models::StateVector::Zero(dim), models::StateMatrix::Zero(dim, dim)};
  out.mean.head<2>() = centre_m;
  const Eigen::Rotation2Dd turn(direction_rad);
  out.covariance.topLeftCorner<2, 2>() =
      turn.toRotationMatrix() *
      Eigen::Vector2d(range_sigma_m * range_sigma_m, across_sigma_m * across_sigma_m).asDiagonal() *
      turn.toRotationMatrix().transpose();
  if (const auto velocity_variance = spec.target_model.kind.law().velocity_variance) {
    out.covariance.diagonal().tail<2>() = velocity_variance(spec.target_model);
  } else {
    out.covariance.diagonal().tail(dim - 2).setConstant(spec.prior_velocity_sigma_mps *
                                                        spec.prior_velocity_sigma_mps);
  }
  return out;
}

}  // namespace

void PositionHypotheses::offer(const Hypothesis& candidate) {
  if (size_ < kMax) {
    hypotheses_[index(size_++)] = candidate;
    return;
  }
  const auto least = std::min_element(
      hypotheses_.begin(), hypotheses_.end(),
      [](const Hypothesis& a, const Hypothesis& b) { return a.weight < b.weight; });
  if (least->weight < candidate.weight) {
    *least = candidate;
  }
}

bool PositionHypotheses::start(const scenario::EstimatorSpec& spec, const models::World& world,
                               const models::SensorModel& sensor, const models::Viewpoint& from,
                               const models::Measurement& measurement) {
  size_ = 0;
  if (spec.target_model.position_dim != 2) {
    return false;
  }
  const Pose2& eye = from.world_from_body;
  const double span_m =
      std::min(sensor.range_max_m, farthest_m(world.bounds, eye.position_m())) - sensor.range_min_m;
  const double step_m = span_m / kRanges;
  const double turn_rad = sensor.fov_rad / kBearings;
  const double uniform = kCellOverlap / std::sqrt(12.0);
  for (int i = 0; i < kRanges; ++i) {
    const double range_m = sensor.range_min_m + (i + 0.5) * step_m;
    for (int j = 0; j < kBearings; ++j) {
      const double direction_rad = eye.yaw_rad - 0.5 * sensor.fov_rad + (j + 0.5) * turn_rad;
      const Eigen::Vector2d at_m =
          eye.position_m() +
          range_m * Eigen::Vector2d(std::cos(direction_rad), std::sin(direction_rad));
      if (!is_free(world, at_m) || !can_report(sensor, from, world, PositionVector(at_m))) {
        continue;
      }
      const auto updated = unscented_update(
          cell_belief(spec, at_m, direction_rad, uniform * step_m, uniform * turn_rad * range_m),
          sensor, from, measurement);
      if (updated && updated->relative_likelihood > kContradiction) {
        offer({range_m * updated->likelihood, updated->belief});
      }
    }
  }
  if (size_ > 0) {
    reduce();
  }
  return size_ > 0;
}

void PositionHypotheses::predict(const models::TargetModel& model, double dt_s) {
  for (int i = 0; i < size_; ++i) {
    Gaussian& belief = hypotheses_[index(i)].belief;
    belief = models::predict(belief, model, dt_s);
  }
}

bool PositionHypotheses::measure(const models::SensorModel& sensor, const models::Viewpoint& from,
                                 const models::Measurement& measurement) {
  const PositionHypotheses before = *this;
  double best = 0.0;
  int kept = 0;
  for (int i = 0; i < size_; ++i) {
    const Hypothesis& old = before.hypotheses_[index(i)];
    const auto updated = unscented_update(old.belief, sensor, from, measurement);
    if (updated) {
      best = std::max(best, updated->relative_likelihood);
      hypotheses_[index(kept++)] = {old.weight * updated->likelihood, updated->belief};
    }
  }
  if (best < kContradiction) {
    *this = before;
    return false;
  }
  size_ = kept;
  reduce();
  return true;
}

void PositionHypotheses::miss(const models::World& world, const models::SensorModel& sensor,
                              const models::Viewpoint& from, double detection_probability) {
  for (int i = 0; i < size_; ++i) {
    Hypothesis& each = hypotheses_[index(i)];
    const Eigen::Vector2d mean_m = each.belief.mean.head<2>();
    if (can_report(sensor, from, world, PositionVector(mean_m))) {
      each.weight *= 1.0 - detection_probability;
    }
  }
  reduce();
}

void PositionHypotheses::confine(const models::World& world) {
  const auto end = hypotheses_.begin() + size_;
  const auto is_possible = [&](const Hypothesis& each) {
    return is_free(world, each.belief.mean.head<2>());
  };
  if (std::none_of(hypotheses_.begin(), end, is_possible)) {
    return;
  }
  const auto kept = std::remove_if(hypotheses_.begin(), end,
                                   [&](const Hypothesis& each) { return !is_possible(each); });
  size_ = static_cast<int>(kept - hypotheses_.begin());
  reduce();
}

void PositionHypotheses::reduce() {
  double sum = 0.0;
  for (int i = 0; i < size_; ++i) {
    sum += hypotheses_[index(i)].weight;
  }
  if (!(sum > 0.0)) {
    for (int i = 0; i < size_; ++i) {  // all hypotheses are equally improbable
      hypotheses_[index(i)].weight = 1.0 / size_;
    }
    return;
  }
  int kept = 0;
  double kept_sum = 0.0;
  for (int i = 0; i < size_; ++i) {
    Hypothesis each = hypotheses_[index(i)];
    each.weight /= sum;
    if (each.weight >= kWeightMin) {
      kept_sum += each.weight;
      hypotheses_[index(kept++)] = each;
    }
  }
  size_ = kept;
  for (int i = 0; i < size_; ++i) {
    hypotheses_[index(i)].weight /= kept_sum;
  }
  merge_similar();
}

void PositionHypotheses::merge_similar() {
  for (int i = 0; i < size_; ++i) {
    for (int j = i + 1; j < size_;) {
      Hypothesis& a = hypotheses_[index(i)];
      const Hypothesis& b = hypotheses_[index(j)];
      const Eigen::Vector2d apart_m = (b.belief.mean - a.belief.mean).head<2>();
      // Two hypotheses are near if they are within the distance by both covariances, so that a wide
      // hypothesis does not absorb a narrow one.
      const auto is_near = [&](const Gaussian& belief) {
        const Eigen::LLT<Eigen::Matrix2d> root(
            Eigen::Matrix2d(belief.covariance.topLeftCorner<2, 2>()));
        return root.info() == Eigen::Success &&
               apart_m.dot(root.solve(apart_m)) < kMergeDistance * kMergeDistance;
      };
      if (is_near(a.belief) && is_near(b.belief)) {
        a = {a.weight + b.weight, moments_of(a.weight, a.belief, b.weight, b.belief)};
        hypotheses_[index(j)] = hypotheses_[index(--size_)];
      } else {
        ++j;
      }
    }
  }
}

std::optional<Gaussian> PositionHypotheses::located(double sigma_max_m) const {
  if (size_ == 0) {
    return std::nullopt;
  }
  double weight = 0.0;
  Gaussian out = hypotheses_[0].belief;
  Eigen::Matrix2d within = Eigen::Matrix2d::Zero();
  for (int i = 0; i < size_; ++i) {
    const Hypothesis& each = hypotheses_[index(i)];
    out = moments_of(weight, out, each.weight, each.belief);
    weight += each.weight;
    within += each.weight * each.belief.covariance.topLeftCorner<2, 2>();
  }
  const double total_m2 = largest_eigenvalue(out.covariance.topLeftCorner<2, 2>());
  const bool is_one_mode = total_m2 <= kOneMode * largest_eigenvalue(within / weight);
  return is_one_mode && total_m2 <= sigma_max_m * sigma_max_m ? std::optional(out) : std::nullopt;
}

}  // namespace vantage::estimator
