#include "logs/metrics/trial_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/index.hpp"
#include "logs/metrics/set_means.hpp"
#include "logs/metrics/track_names.hpp"
#include "scenario/energy_cost.hpp"
#include "scenario/search_name.hpp"

namespace vantage::logs {
namespace {

// Number of newer steps that must have begun before a step is evaluated. Late messages then still
// count, and the simulator's truth, which has another rate, has passed the step's time.
constexpr std::int64_t kStepsOfGrace = 2;
/// Maximum number of stored pairs of process and run with a count of lost messages.
constexpr std::size_t kRunsMax = 4096;

}  // namespace

TrialMetrics::TrialMetrics(const scenario::Scenario& scenario, Time start)
    : world_(scenario.world),
      specs_(scenario.robots),
      execute_steps_(scenario.planner.execute_steps),
      start_(start),
      step_us_(from_seconds(scenario.planner.step_s).count()),
      position_dim_(scenario.estimator.target_model.position_dim),
      prior_entropy_nats_(
          isotropic_entropy_nats(scenario.estimator.undiscovered_position_sigma_m, position_dim_)),
      has_ids_(std::all_of(scenario.robots.begin(), scenario.robots.end(),
                           [](const auto& robot) { return robot.detection.detects_ids; })),
      sums_(scenario.targets.size()),
      robot_sums_(static_cast<int>(scenario.targets.size()), position_dim_, prior_entropy_nats_) {
  summary_.seed = scenario.seed;
  summary_.scenario = scenario.name;
  summary_.algorithm = scenario::search_name(scenario.planner);
  summary_.targets = static_cast<int>(scenario.targets.size());
  for (const scenario::TargetSpec& target : scenario.targets) {
    TargetStatus& status = targets_.emplace_back();
    status.name = target.name;
    status.entropy_nats = prior_entropy_nats_;
  }
  for (const scenario::RobotSpec& robot : scenario.robots) {
    robots_[robot.name];
  }
}

void TrialMetrics::on_truth(const models::TruthFrame& frame) {
  truth_.add(frame);
  poses_.on_truth(frame);
}

void TrialMetrics::discover(int target_id, const std::string& robot, Time time) {
  if (target_id < 0 || target_id >= summary_.targets) {
    return;
  }
  const double time_s = to_seconds(time - start_);
  TargetStatus& target = targets_[index(target_id)];
  if (!target.discovered_s || time_s < *target.discovered_s) {
    target.discovered_s = time_s;
    target.discovered_by = robot;
  }
}

std::vector<models::TargetBelief> TrialMetrics::named(const std::string& robot,
                                                      const ReceivedBelief& received) {
  std::vector<models::TargetBelief> targets =
      assign_ids_by_position(received.targets, truth_, summary_.targets, received.time);
  for (const models::TargetBelief& target : targets) {
    const auto at_m = truth_.target_position_m(target.target_id, received.time);
    const auto estimate = position_estimate(target, "", received.time, 2);
    if (at_m && estimate && (estimate->mean_m.head<2>() - at_m->head<2>()).norm() < kOspaCutoff_m) {
      discover(target.target_id, robot, received.time);
    }
  }
  return targets;
}

void TrialMetrics::on_belief(const models::RobotBelief& belief) {
  for (const models::TargetBelief& target : belief.targets) {
    discover(target.target_id, belief.robot, belief.stamp.time);
  }
  const std::int64_t index = to_utime(belief.stamp.time) / step_us_;
  if (index <= newest_judged_) {
    return;
  }
  pending_[index][belief.robot] = {belief.stamp.time, belief.targets};
  while (pending_.begin()->first + kStepsOfGrace <= pending_.rbegin()->first) {
    judge(pending_.begin()->second);
    newest_judged_ = pending_.begin()->first;
    pending_.erase(pending_.begin());
  }
}

void TrialMetrics::judge(const Step& step) {
  TeamEstimate team;
  step_of_robots_ = {};
  for (const auto& [robot, received] : step) {
    const std::vector<models::TargetBelief> targets =
        has_ids_ ? received.targets : named(robot, received);
    robot_sums_.add(robot, received.time, to_seconds(received.time - start_), targets, truth_,
                    step_of_robots_);
    for (const models::TargetBelief& belief : targets) {
      if (const auto estimate = position_estimate(belief, robot, received.time, position_dim_)) {
        team.offer(belief.target_id, *estimate);
      }
    }
  }
  ++steps_;
  judge_targets(team);
}

void TrialMetrics::judge_targets(const TeamEstimate& team) {
  double squared_error_m2 = 0.0;
  int errors = 0;
  int unknown = 0;
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    TargetStatus& status = targets_[i];
    const PositionEstimate* estimate = team.find(static_cast<int>(i));
    status.estimate = estimate != nullptr ? std::optional(*estimate) : std::nullopt;
    status.error_m = std::nullopt;
    status.entropy_nats = estimate != nullptr ? estimate->entropy_nats : prior_entropy_nats_;
    sums_[i].entropy_nats += status.entropy_nats;
    if (estimate == nullptr) {
      ++unknown;
      continue;
    }
    const auto truth_m = truth_.target_position_m(static_cast<int>(i), estimate->time);
    if (truth_m) {
      const models::PositionVector true_m = truth_m->head(position_dim_);
      const double squared_m2 = (estimate->mean_m - true_m).squaredNorm();
      nees_sum_ += estimate->nees(true_m);
      status.error_m = std::sqrt(squared_m2);
      sums_[i].squared_error_m2 += squared_m2;
      ++sums_[i].errors;
      squared_error_m2 += squared_m2;
      ++errors;
    }
  }
  if (errors > 0) {
    rmse_sum_m_ += std::sqrt(squared_error_m2 / errors);
    ++steps_with_error_;
  }
  unknown_share_sum_ += targets_.empty() ? 0.0 : unknown / static_cast<double>(targets_.size());
}

void TrialMetrics::on_map(const models::RobotMap& map) {
  map_entropies_nats_[map.robot] = map.entropy_nats;
}

std::optional<double> TrialMetrics::map_entropy_nats() const {
  if (map_entropies_nats_.empty()) {
    return std::nullopt;
  }
  double sum_nats = 0.0;
  for (const auto& [robot, entropy_nats] : map_entropies_nats_) {
    sum_nats += entropy_nats;
  }
  return sum_nats / static_cast<double>(map_entropies_nats_.size());
}

void TrialMetrics::on_plan(const models::RobotPlan& plan) {
  rounds_.insert(plan.round);
  if (plan.late) {
    rounds_late_.insert(plan.round);
  }
  ++plans_;
  fallbacks_ += plan.source == models::PlanSource::kSearched ? 0 : 1;
  robots_[plan.robot].plan = plan;
  summary_.energy_nats += energy_nats(plan);
}

double TrialMetrics::energy_nats(const models::RobotPlan& plan) const {
  const auto spec = std::find_if(specs_.begin(), specs_.end(),
                                 [&](const auto& each) { return each.name == plan.robot; });
  double used = 0.0;
  for (int step = 0; spec != specs_.end() && step < execute_steps_; ++step) {
    const models::TrajectoryPoint point =
        models::at(plan.trajectory, plan.trajectory.start_time + Duration{step * step_us_});
    used += spec->energy.price_nats * scenario::step_cost(spec->energy, &world_, point.control,
                                                          point.world_from_body.position_m());
  }
  return used;
}

void TrialMetrics::on_contact(const models::CollisionReport& contact) {
  ++(contact.kind == models::CollisionKind::kCollision ? collisions_ : separation_violations_);
}

void TrialMetrics::on_vehicle(const models::VehicleStatus& status) {
  robots_[status.robot].state = status.state;
}

void TrialMetrics::on_health(const models::ProcessHealth& health) {
  std::int64_t lost = 0;
  for (const models::NamedCount& counter : health.counters) {
    lost += counter.name.ends_with(".lost") ? counter.count : 0;
  }
  const std::pair run(health.process, health.stamp.run_id);
  if (lost_.contains(run) || lost_.size() < kRunsMax) {
    lost_[run] = lost;
  }
}

std::int64_t TrialMetrics::messages_lost() const {
  std::int64_t total = 0;
  for (const auto& [run, lost] : lost_) {
    total += lost;
  }
  return total;
}

TrialSummary TrialMetrics::finish(Time end, std::optional<std::int64_t> messages_lost) {
  for (const auto& [index, step] : std::exchange(pending_, {})) {
    judge(step);
    newest_judged_ = index;
  }
  TrialSummary out = summary_;
  out.duration_s = to_seconds(end - start_);
  out.collisions = collisions_;
  out.separation_violations = separation_violations_;
  out.min_separation_m = truth_.min_separation_m();
  const auto steps = static_cast<double>(std::max<std::int64_t>(steps_, 1));
  double entropy_sum_nats = 0.0;
  std::int64_t errors = 0;
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const TargetSums& sums = sums_[i];
    out.discovery_time_s.push_back(targets_[i].discovered_s);
    out.discovered += targets_[i].discovered_s ? 1 : 0;
    errors += sums.errors;
    out.rmse_per_target_m.push_back(
        sums.errors > 0
            ? std::optional(std::sqrt(sums.squared_error_m2 / static_cast<double>(sums.errors)))
            : std::nullopt);
    const double entropy_nats = steps_ > 0 ? sums.entropy_nats / steps : prior_entropy_nats_;
    out.entropy_per_target_nats.push_back(entropy_nats);
    entropy_sum_nats += entropy_nats;
  }
  if (!targets_.empty()) {
    out.entropy_nats = entropy_sum_nats / static_cast<double>(targets_.size());
  }
  if (steps_with_error_ > 0) {
    out.rmse_m = rmse_sum_m_ / static_cast<double>(steps_with_error_);
    out.position_nees = nees_sum_ / static_cast<double>(errors);
  }
  out.undiscovered_share = steps_ > 0 ? unknown_share_sum_ / steps : 1.0;
  out.per_robot = robot_sums_.means(out.duration_s);
  out.rounds = rounds();
  out.rounds_late = rounds_late();
  out.fallbacks = fallbacks_;
  out.map_entropy_nats = map_entropy_nats();
  out.poses = poses_.means();
  out.plans = plans_;
  out.plans_missing = std::max<std::int64_t>(0, rounds() * std::ssize(robots_) - plans_);
  out.messages_lost = messages_lost.value_or(this->messages_lost());
  return out;
}

}  // namespace vantage::logs
