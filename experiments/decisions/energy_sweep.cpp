#include "experiments/decisions/energy_sweep.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/cpu_time.hpp"
#include "experiments/decisions/energy_trial.hpp"

namespace vantage::experiments {
namespace {

using planner::TeamOracle;

constexpr int kTrials = 50;  // number of trials in the dissertation
constexpr int kRobotsMin = 2;
constexpr int kRobotsMax = 10;
constexpr int kRobotsMaxSmoke = 4;

// Returns the CPU time of one oracle call without caching, s. Every target is evaluated from the
// first step on, for full teams of random candidates.
double from_scratch_call_s(const TeamOracle& oracle, std::uint64_t seed) {
  constexpr int kCalls = 300;
  std::vector<planner::TargetCourses::Measurements> measurements;
  double sink = 0.0;
  const double start_s = thread_cpu_s();
  for (int call = 0; call < kCalls; ++call) {
    for (int m = 0; m < oracle.target_count(); ++m) {
      measurements.clear();
      for (int robot = 0; robot < oracle.robot_count(); ++robot) {
        const auto count = static_cast<std::uint64_t>(oracle.end(robot) - oracle.begin(robot));
        const auto drawn = static_cast<planner::CandidateId>(
            (seed + static_cast<std::uint64_t>(call) * 7919U) % std::max<std::uint64_t>(1, count));
        const std::vector<planner::PredictedMeasurement>& all =
            oracle.candidate(oracle.begin(robot) + drawn).measurements;
        const auto [begin, end] = std::equal_range(
            all.begin(), all.end(),
            planner::PredictedMeasurement{static_cast<std::uint16_t>(m), 0, {}},
            [](const planner::PredictedMeasurement& a, const planner::PredictedMeasurement& b) {
              return a.target < b.target;
            });
        measurements.emplace_back(begin, end);
      }
      sink += oracle.courses().follow(m, 0, oracle.courses().open_loop_course(m), measurements,
                                      nullptr);
    }
  }
  // The result is used, so that the compiler cannot remove the computation.
  return (thread_cpu_s() - start_s + 0.0 * sink) / kCalls;
}

UnitRows run_trial_of(
    int robots, std::uint64_t seed,
    const std::function<std::vector<Decided>(const planner::TeamOracle&)>& decide) {
  UnitRows rows;
  const double start_s = thread_cpu_s();
  const EnergyTrial drawn = draw_energy_trial(robots, seed, EnergyTrialOptions{}, thread_search());
  const double drawn_s = thread_cpu_s();
  const TeamOracle oracle(drawn.team);
  rows.times_s = {{"trajectories", drawn_s - start_s}, {"each alone", thread_cpu_s() - drawn_s}};
  for (const Decided& by : decide(oracle)) {
    rows.tables["trials"].push_back(fmt::format("{},{},{:.9f},{:.6f},{:g},{:g}",
                                                oracle.candidate_count(), by.method, by.value,
                                                by.calls_per_candidate, by.adopted, by.messages));
    rows.times_s.emplace_back(by.method, by.cpu_s);
  }
  rows.times_s.emplace_back("one call from scratch", from_scratch_call_s(oracle, seed));
  return rows;
}

}  // namespace

int robots_of(std::size_t setting) { return kRobotsMin + static_cast<int>(setting); }

Sweep energy_sweep(const Extent& extent,
                   std::function<std::vector<Decided>(const planner::TeamOracle&)> decide,
                   std::function<Summary(const Tables&)> summarise) {
  const EnergyTrialOptions options;
  Sweep sweep;
  sweep.plan.setting_columns = "robots";
  const int robots_max = extent.is_smoke ? kRobotsMaxSmoke : kRobotsMax;
  for (int robots = kRobotsMin; robots <= robots_max; ++robots) {
    sweep.plan.settings.push_back({std::to_string(robots)});
  }
  sweep.plan.trials = extent.trials_or(kTrials);
  sweep.plan.parameters = {
      {"prior_position_sigma_m", fmt::format("{}", options.prior_position_sigma_m)},
      {"prior_velocity_sigma_mps", fmt::format("{}", options.prior_velocity_sigma_mps)},
      {"acceleration_q", fmt::format("{}", options.acceleration_q)},
      {"yaw_weight_m_per_rad", fmt::format("{}", options.yaw_weight_m_per_rad)}};
  sweep.plan.tables = {{"trials", "candidates,method,value,calls_per_candidate,adopted,messages"}};
  sweep.run = [decide = std::move(decide)](std::size_t setting, std::uint64_t seed) {
    return run_trial_of(robots_of(setting), seed, decide);
  };
  sweep.summarise = std::move(summarise);
  return sweep;
}

std::vector<std::string> energy_choices() {
  const EnergyTrialOptions options;
  return {
      fmt::format("The source does not state the targets' prior. Here: {:g} m, {:g} m/s (1σ).",
                  options.prior_position_sigma_m, options.prior_velocity_sigma_mps),
      fmt::format("The source does not state the targets' q. Here: {:g} m²/s³.",
                  options.acceleration_q),
      fmt::format("The source does not state how much a turn adds to the distance δ = 2 m. Here: "
                  "{:g} m/rad, for which ten robots have nearly the published N ≈ 12 500.",
                  options.yaw_weight_m_per_rad),
      "Oracle calls are those of the decision only: the search already computes the gain of each "
      "single candidate. Results also give the numbers with these N calls."};
}

EnergySamples::EnergySamples(const Tables& tables) {
  for (const Record& record : tables.at("trials")) {
    const int robots = robots_of(record.unit.setting);
    candidates_[robots].add(record.number(0));
    MethodSamples& samples = methods_[robots][record.cells[1]];
    samples.value.add(record.number(2));
    samples.calls.add(record.number(3));
    samples.adopted.add(record.number(4));
    samples.messages.add(record.number(5));
  }
  for (const Record& record : tables.at("times")) {
    times_[robots_of(record.unit.setting)][record.cells[0]].add(record.number(1));
  }
}

std::vector<int> EnergySamples::team_sizes() const {
  std::vector<int> sizes;
  for (const auto& [robots, methods] : methods_) {
    sizes.push_back(robots);
  }
  return sizes;
}

std::string EnergySamples::csv() const {
  std::string text =
      "robots,method,candidates,value,value_sd,value_ci95,calls_per_candidate,calls_sd,adopted,"
      "adopted_sd,messages\n";
  for (const auto& [robots, methods] : methods_) {
    for (const auto& [method, s] : methods) {
      text += fmt::format("{},{},{:.1f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.4f},{:.4f},{:.4f}\n",
                          robots, method, candidates(robots), s.value.mean(), s.value.deviation(),
                          s.value.half_interval(), s.calls.mean(), s.calls.deviation(),
                          s.adopted.mean(), s.adopted.deviation(), s.messages.mean());
    }
  }
  return text;
}

}  // namespace vantage::experiments
