#include "logs/metrics/set_means.hpp"

#include <utility>

#include "logs/metrics/team_estimate.hpp"

namespace vantage::logs {

void SetSums::on_truth(const models::TruthFrame& frame) {
  truth_.add(frame);
  while (!pending_.empty() && pending_.front().time <= frame.stamp.time) {
    judge(pending_.front());
    pending_.pop_front();
  }
}

void SetSums::on_belief(const models::RobotBelief& belief) {
  Pending received{belief.robot, belief.stamp.time, {}};
  for (const models::TargetBelief& target : belief.targets) {
    if (const auto estimate = position_estimate(target, belief.robot, belief.stamp.time, 2)) {
      received.estimates.push_back({target.target_id, estimate->mean_m.head<2>()});
    }
  }
  pending_.push_back(std::move(received));
}

void SetSums::judge(const Pending& belief) {
  std::vector<Labelled> truth;
  for (int id = 0; id < targets_; ++id) {
    if (const auto at_m = truth_.target_position_m(id, belief.time)) {
      truth.push_back({id, at_m->head<2>()});
    }
  }
  if (truth.empty()) {
    return;
  }
  Robot& robot = robots_[belief.robot];
  const SetError error = robot.judge.judge(truth, belief.estimates);
  robot.first = robot.beliefs == 0 ? belief.time : robot.first;
  robot.last = belief.time;
  ++robot.beliefs;
  robot.ospa_m += error.ospa_m;
  robot.matched_rmse_m += error.matched_rmse_m;
}

std::optional<SetMeans> SetSums::means() const {
  if (robots_.empty()) {
    return std::nullopt;
  }
  SetMeans means;
  for (const auto& [name, robot] : robots_) {
    const auto beliefs = static_cast<double>(robot.beliefs) * static_cast<double>(robots_.size());
    means.ospa_m += robot.ospa_m / beliefs;
    means.matched_rmse_m += robot.matched_rmse_m / beliefs;
    const double judged_min = to_seconds(robot.last - robot.first) / 60.0;
    if (judged_min > 0.0) {
      means.swaps_per_min += static_cast<double>(robot.judge.swaps()) / judged_min /
                             static_cast<double>(robots_.size());
    }
  }
  return means;
}

}  // namespace vantage::logs
