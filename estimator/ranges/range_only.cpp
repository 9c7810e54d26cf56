#include "estimator/ranges/range_only.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/LU>

#include "core/angle.hpp"
#include "core/check.hpp"

namespace vantage::estimator {

RangeOnlyFilter::RangeOnlyFilter(RangeOnlySpec spec) : spec_(spec) {
  require(spec.hypotheses >= 8, "hypotheses must be at least 8");
  require(spec.calibration.range_scale > 0.0, "range_scale must be positive");
  require(spec.range_sigma_m > 0.0, "range_sigma_m must be positive");
  require(spec.outlier_share >= 0.0 && spec.outlier_share < 1.0 && spec.outlier_span_m > 0.0,
          "outlier_share must be in [0, 1) and outlier_span_m positive");
  require(spec.restart_window >= 1, "restart_window must be at least 1");
  hypotheses_.reserve(static_cast<std::size_t>(spec.hypotheses));
}

void RangeOnlyFilter::update(const Eigen::Vector2d& robot_m, double range_m) {
  const models::RangeCalibration& calibration = spec_.calibration;
  const double distance_m = (range_m - calibration.range_bias_m) / calibration.range_scale;
  if (!std::isfinite(range_m) || !robot_m.allFinite() || distance_m <= 0.0) {
    ++refused_;
    return;
  }
  if (hypotheses_.empty()) {
    start_ring(robot_m, distance_m);
    return;
  }
  double inlier = 0.0;
  for (BeaconHypothesis& hypothesis : hypotheses_) {
    inlier = std::max(inlier, update(hypothesis, robot_m, range_m));
  }
  normalise_and_drop();
  merge();

  inliers_ += inlier;
  if (++window_ == spec_.restart_window) {
    if (inliers_ < 0.5 * window_) {  // the ring came from an outlier
      ++restarts_;
      hypotheses_.clear();
    }
    window_ = 0;
    inliers_ = 0.0;
  }
}

void RangeOnlyFilter::start_ring(const Eigen::Vector2d& robot_m, double distance_m) {
  const int n = spec_.hypotheses;
  const double step_rad = 2.0 * kPi / n;
  const double sigma_m = spec_.range_sigma_m / spec_.calibration.range_scale;
  // Neighbours overlap at about one σ, so the ring is covered evenly.
  const double tangential_m = std::max(0.6 * distance_m * step_rad, sigma_m);
  const double sagitta_m = 0.5 * tangential_m * tangential_m / distance_m;
  const double radial_m = std::hypot(sigma_m, std::min(sagitta_m, tangential_m));
  for (int i = 0; i < n; ++i) {
    const double bearing_rad = step_rad * i;
    Eigen::Matrix2d axes;
    axes << std::cos(bearing_rad), -std::sin(bearing_rad), std::sin(bearing_rad),
        std::cos(bearing_rad);
    const Eigen::Vector2d variances(radial_m * radial_m, tangential_m * tangential_m);
    hypotheses_.push_back({1.0 / n, robot_m + distance_m * axes.col(0),
                           axes * variances.asDiagonal() * axes.transpose()});
  }
}

double RangeOnlyFilter::update(BeaconHypothesis& hypothesis, const Eigen::Vector2d& robot_m,
                               double range_m) const {
  const Eigen::Vector2d away_m = hypothesis.mean_m - robot_m;
  const double distance_m = std::max(away_m.norm(), kRangeNearest_m);
  const double scale = spec_.calibration.range_scale;
  const Eigen::RowVector2d H = scale * away_m.transpose() / distance_m;
  const Eigen::Matrix2d& P = hypothesis.covariance_m2;
  // Second-order correction for the curvature of the range along the tangent. The correction is
  // negligible for a narrow hypothesis, but amounts to metres for a hypothesis of a new ring.
  const Eigen::Vector2d across(-away_m.y() / distance_m, away_m.x() / distance_m);
  const double curve_m = 0.5 * scale * across.dot(P * across) / distance_m;
  const double S =
      H * P * H.transpose() + spec_.range_sigma_m * spec_.range_sigma_m + 2.0 * curve_m * curve_m;
  const double nu = range_m - (scale * distance_m + spec_.calibration.range_bias_m + curve_m);
  const double inlier =
      (1.0 - spec_.outlier_share) * std::exp(-0.5 * nu * nu / S) / std::sqrt(2.0 * kPi * S);
  const double outlier = spec_.outlier_share / spec_.outlier_span_m;
  const double likelihood = inlier + outlier;
  if (likelihood <= 0.0) {
    hypothesis.weight = 0.0;
    return 0.0;
  }
  const double beta = inlier / likelihood;
  const Eigen::Vector2d K = P * H.transpose() / S;
  hypothesis.mean_m += beta * nu * K;
  hypothesis.covariance_m2 += (beta * (1.0 - beta) * nu * nu - beta * S) * K * K.transpose();
  hypothesis.covariance_m2 =
      (0.5 * (hypothesis.covariance_m2 + hypothesis.covariance_m2.transpose())).eval();
  hypothesis.weight *= likelihood;
  return beta;
}

void RangeOnlyFilter::normalise_and_drop() {
  double total = 0.0;
  for (const BeaconHypothesis& h : hypotheses_) {
    total += h.weight;
  }
  if (!(total > 0.0)) {
    hypotheses_.clear();
    ++restarts_;
    return;
  }
  std::erase_if(hypotheses_,
                [&](const BeaconHypothesis& h) { return h.weight < spec_.weight_min * total; });
  double kept = 0.0;
  for (const BeaconHypothesis& h : hypotheses_) {
    kept += h.weight;
  }
  for (BeaconHypothesis& h : hypotheses_) {
    h.weight /= kept;
  }
  std::stable_sort(hypotheses_.begin(), hypotheses_.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
}

void RangeOnlyFilter::merge() {
  const double limit = spec_.merge_distance_sigma * spec_.merge_distance_sigma;
  // Hypotheses within this distance are always merged, because no single range distinguishes them.
  const double same_m = spec_.merge_distance_sigma * spec_.range_sigma_m;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    for (std::size_t j = hypotheses_.size(); j-- > i + 1;) {
      BeaconHypothesis& a = hypotheses_[i];
      const BeaconHypothesis& b = hypotheses_[j];
      const Eigen::Vector2d apart_m = a.mean_m - b.mean_m;
      // The narrower covariance decides; otherwise a wide hypothesis would absorb a narrow one.
      const Eigen::Matrix2d& narrow = a.covariance_m2.determinant() < b.covariance_m2.determinant()
                                          ? a.covariance_m2
                                          : b.covariance_m2;
      if (apart_m.norm() > same_m && apart_m.dot(narrow.inverse() * apart_m) > limit) {
        continue;
      }
      const double total = a.weight + b.weight;
      const double share = a.weight / total;
      a.covariance_m2 = share * a.covariance_m2 + (1.0 - share) * b.covariance_m2 +
                        share * (1.0 - share) * apart_m * apart_m.transpose();
      a.mean_m -= (1.0 - share) * apart_m;
      a.weight = total;
      hypotheses_.erase(hypotheses_.begin() + static_cast<std::ptrdiff_t>(j));
    }
  }
}

BeaconHypothesis RangeOnlyFilter::best() const {
  return hypotheses_.empty()
             ? BeaconHypothesis{0.0, Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}
             : hypotheses_.front();
}

}  // namespace vantage::estimator
