#include "logs/metrics/team_estimate.hpp"

#include <cmath>
#include <numbers>
#include <tuple>

#include <Eigen/Cholesky>

namespace vantage::logs {
namespace {

const double kLog2PiE = std::log(2.0 * std::numbers::pi * std::numbers::e);

}  // namespace

double PositionEstimate::sigma_m() const {
  return std::sqrt(covariance_m2.trace() / static_cast<double>(covariance_m2.rows()));
}

double PositionEstimate::nees(const models::PositionVector& true_m) const {
  const models::PositionVector error_m = mean_m - true_m;
  return error_m.dot(covariance_m2.llt().solve(error_m));
}

std::optional<PositionEstimate> position_estimate(const models::TargetBelief& belief,
                                                  const std::string& robot, Time time,
                                                  int position_dim) {
  const std::optional<models::Gaussian> gaussian = models::to_gaussian(belief.information);
  if (!gaussian || gaussian->mean.size() < position_dim) {
    return std::nullopt;
  }
  PositionEstimate out;
  out.robot = robot;
  out.time = time;
  out.last_seen = belief.last_seen;
  out.mean_m = gaussian->mean.head(position_dim);
  out.covariance_m2 = gaussian->covariance.topLeftCorner(position_dim, position_dim);
  const Eigen::LLT<models::PositionMatrix> factor(out.covariance_m2);
  if (factor.info() != Eigen::Success) {
    return std::nullopt;
  }
  double half_log_det = 0.0;
  for (int i = 0; i < position_dim; ++i) {
    half_log_det += std::log(factor.matrixLLT()(i, i));
  }
  out.entropy_nats = 0.5 * position_dim * kLog2PiE + half_log_det;
  return out;
}

double isotropic_entropy_nats(double sigma_m, int position_dim) {
  return position_dim * (0.5 * kLog2PiE + std::log(sigma_m));
}

void TeamEstimate::offer(int target_id, const PositionEstimate& candidate) {
  const auto [entry, is_new] = best_.try_emplace(target_id, candidate);
  if (is_new) {
    return;
  }
  const PositionEstimate& best = entry->second;
  if (std::tuple(candidate.entropy_nats, -to_utime(candidate.last_seen), candidate.robot) <
      std::tuple(best.entropy_nats, -to_utime(best.last_seen), best.robot)) {
    entry->second = candidate;
  }
}

const PositionEstimate* TeamEstimate::find(int target_id) const {
  const auto entry = best_.find(target_id);
  return entry == best_.end() ? nullptr : &entry->second;
}

}  // namespace vantage::logs
