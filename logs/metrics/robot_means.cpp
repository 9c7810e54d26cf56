#include "logs/metrics/robot_means.hpp"

#include <cmath>

#include "core/index.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "logs/metrics/truth_history.hpp"

namespace vantage::logs {

void RobotStep::add(double entropy_nats, std::optional<double> rmse_m) {
  ++robots_;
  entropy_sum_nats_ += entropy_nats;
  robots_with_error_ += rmse_m ? 1 : 0;
  rmse_sum_m_ += rmse_m.value_or(0.0);
}

void RobotStep::add_nees(std::size_t age_class, double nees) {
  ++nees_by_age_[age_class].samples;
  nees_by_age_[age_class].sum += nees;
}

std::optional<double> RobotStep::entropy_nats() const {
  return robots_ > 0 ? std::optional(entropy_sum_nats_ / robots_) : std::nullopt;
}

std::optional<double> RobotStep::rmse_m() const {
  return robots_with_error_ > 0 ? std::optional(rmse_sum_m_ / robots_with_error_) : std::nullopt;
}

RobotSums::RobotSums(int targets, int position_dim, double prior_entropy_nats)
    : targets_(targets),
      position_dim_(position_dim),
      prior_entropy_nats_(prior_entropy_nats),
      nees_(position_dim),
      nees_by_age_(kAgeClasses, NeesSums(position_dim)) {}

void RobotSums::add(const std::string& robot, Time time, double since_start_s,
                    std::span<const models::TargetBelief> beliefs, const TruthHistory& truth,
                    RobotStep& step) {
  Sums& sums = robots_[robot];
  sums.first_known_s.resize(static_cast<std::size_t>(targets_));
  int known = 0;
  int judged = 0;
  double squared_error_m2 = 0.0;
  double entropy_nats = 0.0;
  for (const models::TargetBelief& belief : beliefs) {
    const auto estimate = position_estimate(belief, robot, time, position_dim_);
    if (!estimate || belief.target_id < 0 || belief.target_id >= targets_) {
      continue;
    }
    auto& first_s = sums.first_known_s[index(belief.target_id)];
    first_s = first_s.value_or(since_start_s);
    ++known;
    entropy_nats += estimate->entropy_nats;
    if (const auto truth_m = truth.target_position_m(belief.target_id, time)) {
      const models::PositionVector true_m = truth_m->head(position_dim_);
      squared_error_m2 += (estimate->mean_m - true_m).squaredNorm();
      ++judged;
      const double nees = estimate->nees(true_m);
      const std::size_t age = age_class(to_seconds(time - estimate->last_seen));
      nees_.add(nees);
      nees_by_age_[age].add(nees);
      step.add_nees(age, nees);
    }
  }
  ++sums.steps;
  std::optional<double> rmse_m;
  if (judged > 0) {
    rmse_m = std::sqrt(squared_error_m2 / judged);
    ++sums.steps_with_error;
    sums.rmse_m += *rmse_m;
  }
  if (targets_ > 0) {
    const double mean_nats = (entropy_nats + (targets_ - known) * prior_entropy_nats_) / targets_;
    step.add(mean_nats, rmse_m);
    sums.entropy_nats += mean_nats;
    sums.unknown_share += (targets_ - known) / static_cast<double>(targets_);
  }
}

RobotMeans RobotSums::means(double duration_s) const {
  RobotMeans out;
  const auto robots = static_cast<double>(robots_.size());
  int with_error = 0;
  int discovered = 0;
  double rmse_m = 0.0;
  for (const auto& [robot, sums] : robots_) {
    if (sums.steps_with_error > 0) {
      rmse_m += sums.rmse_m / static_cast<double>(sums.steps_with_error);
      ++with_error;
    }
    out.entropy_nats += sums.entropy_nats / static_cast<double>(sums.steps) / robots;
    out.undiscovered_share += sums.unknown_share / static_cast<double>(sums.steps) / robots;
    for (const std::optional<double>& first_s : sums.first_known_s) {
      discovered += first_s ? 1 : 0;
      out.discovery_time_s += first_s.value_or(duration_s) / (robots * targets_);
    }
  }
  out.discovered = robots > 0.0 ? discovered / robots : 0.0;
  if (with_error > 0) {
    out.rmse_m = rmse_m / with_error;
  }
  out.consistency = nees_.result();
  for (std::size_t i = 0; i < kAgeClasses; ++i) {
    out.consistency_by_age[i] = nees_by_age_[i].result();
  }
  return out;
}

}  // namespace vantage::logs
