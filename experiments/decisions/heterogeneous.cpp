#include <fmt/format.h>

#include "core/cpu_time.hpp"
#include "experiments/decisions/energy_decision.hpp"
#include "experiments/decisions/energy_trial.hpp"
#include "experiments/decisions/heterogeneous_summary.hpp"
#include "experiments/experiment.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::experiments {
namespace {

constexpr int kTrials = 50;  // number of trials in the dissertation
constexpr int kHorizonSmoke = 6;
constexpr int kFlying = 2;  // index of the flying robot

HeterogeneousOutcome outcome_of(const EnergyTrial& trial, const planner::TeamOracle& oracle,
                                const Decided& decided) {
  planner::TeamSet set(oracle);
  set.become(decided.choice);
  HeterogeneousOutcome outcome{decided.value, set.information()};
  for (std::size_t robot = 0; robot < trial.robots.size(); ++robot) {
    const planner::CandidateId id = decided.choice[robot];
    if (id != planner::kNoCandidate) {
      const planner::Candidate& candidate = oracle.candidate(id);
      (robot == kFlying ? outcome.energy_uav : outcome.energy_ugvs) += energy_used(
          trial.energy[robot], trial.robots[robot], candidate.controls, candidate.poses);
    }
  }
  return outcome;
}

// Adds the robots' paths and the number of observations of each target.
void add_picture_rows(UnitRows& rows, const EnergyTrial& trial, const planner::TeamOracle& oracle,
                      const Decided& decided) {
  std::vector<int> looks(trial.team.targets.size());
  for (std::size_t robot = 0; robot < trial.robots.size(); ++robot) {
    std::vector<Pose2> poses = {trial.robots[robot].start};
    if (const planner::CandidateId id = decided.choice[robot]; id != planner::kNoCandidate) {
      const planner::Candidate& candidate = oracle.candidate(id);
      poses.insert(poses.end(), candidate.poses.begin(), candidate.poses.end());
      for (const planner::PredictedMeasurement& measurement : candidate.measurements) {
        ++looks[measurement.target];
      }
    }
    for (const Pose2& pose : poses) {
      rows.tables["ways"].push_back(
          fmt::format("{},{},{:.3f},{:.3f}", decided.method, robot, pose.x_m, pose.y_m));
    }
  }
  for (std::size_t m = 0; m < looks.size(); ++m) {
    const models::StateVector& mean = trial.team.targets[m].prior.mean;
    rows.tables["targets"].push_back(
        fmt::format("{},{:.3f},{:.3f},{}", decided.method, mean.x(), mean.y(), looks[m]));
  }
}

UnitRows run_trial(double price_nats, bool is_pictured, std::uint64_t seed, bool is_smoke) {
  HeterogeneousTrialOptions options;
  options.price_nats = price_nats;
  options.horizon_steps = is_smoke ? kHorizonSmoke : options.horizon_steps;
  UnitRows rows;
  const double start_s = thread_cpu_s();
  const EnergyTrial trial = draw_heterogeneous_trial(seed, options, thread_search());
  const double drawn_s = thread_cpu_s();
  const planner::TeamOracle oracle(trial.team);
  rows.times_s = {{"trajectories", drawn_s - start_s}, {"each alone", thread_cpu_s() - drawn_s}};
  for (const Decided& decided :
       {descent(kMethods[0].name, oracle, true), descent(kMethods[1].name, oracle, false),
        local_search(kMethods[2].name, oracle, true, true)}) {
    const HeterogeneousOutcome outcome = outcome_of(trial, oracle, decided);
    rows.tables["trials"].push_back(fmt::format(
        "{},{:.9f},{:.9f},{:g},{:g},{},{:g}", decided.method, outcome.value, outcome.information,
        outcome.energy_ugvs, outcome.energy_uav, oracle.candidate_count(), decided.messages));
    rows.times_s.emplace_back(decided.method, decided.cpu_s);
    if (is_pictured) {
      add_picture_rows(rows, trial, oracle, decided);
    }
  }
  return rows;
}

std::vector<std::string> choices_of(const HeterogeneousTrialOptions& options) {
  return {
      "Fig. 3.9 shows mud and wind without numbers. Here: rectangles, mud over 36 % of the "
      "arena, wind over 42 %, both over 12 %.",
      fmt::format("The source states neither the targets' prior (here {:g} m, 1σ) nor the metric "
                  "of δ = 4 m (here {:g} m/rad, as in scenario 1).",
                  options.open.prior_position_sigma_m, options.open.yaw_weight_m_per_rad),
      "The source does not state the values of r. Here: 0 to 0.5 in steps of 0.05.",
      "The figure shows the trial in which DLS exceeds the better order of CD most: an extreme "
      "example, not a typical one.",
      "Fig. 3.8 of the source shows information versus energy, and Fig. 3.9 shows one trial."};
}

}  // namespace

Sweep heterogeneous(const Extent& extent) {
  const HeterogeneousTrialOptions options;
  Sweep sweep;
  sweep.plan.setting_columns = "price";
  std::vector<double> prices = {0.0, 0.2, 0.5};
  if (!extent.is_smoke) {
    prices.clear();
    for (int i = 0; i <= 10; ++i) {
      prices.push_back(0.05 * i);
    }
  }
  for (const double price : prices) {
    sweep.plan.settings.push_back({fmt::format("{:.2f}", price)});
  }
  sweep.plan.trials = extent.trials_or(kTrials);
  const models::World world = heterogeneous_world();
  for (const models::Region& region : world.regions) {
    const models::Rectangle& of = region.footprint;
    sweep.plan.parameters[region.name + "_m"] = fmt::format(
        "x {:g}–{:g}, y {:g}–{:g}", of.min_m.x(), of.max_m.x(), of.min_m.y(), of.max_m.y());
    sweep.plan.parameters[region.name + "_cost_per_step"] =
        fmt::format("{:g}", region.cost_per_step);
  }
  sweep.plan.parameters["prior_position_sigma_m"] =
      fmt::format("{}", options.open.prior_position_sigma_m);
  sweep.plan.parameters["yaw_weight_m_per_rad"] =
      fmt::format("{}", options.open.yaw_weight_m_per_rad);
  sweep.plan.tables = {
      {"trials", "method,value,information,energy_ugvs,energy_uav,candidates,messages"},
      {"ways", "method,robot,x_m,y_m"},
      {"targets", "method,x_m,y_m,looks"}};
  sweep.run = [prices, cells = sweep.plan.settings, is_smoke = extent.is_smoke](
                  std::size_t setting, std::uint64_t seed) {
    return run_trial(prices[setting], cells[setting].cells == kPicturedPrice, seed, is_smoke);
  };
  sweep.summarise = [plan = sweep.plan, options](const Tables& tables) {
    Summary summary = summarise_heterogeneous(plan, tables);
    summary.choices = choices_of(options);
    return summary;
  };
  return sweep;
}

}  // namespace vantage::experiments
