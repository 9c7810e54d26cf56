#include <algorithm>
#include <ctime>
#include <functional>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "planner/team/decision/coordinate_descent.hpp"
#include "planner/team/decision/distributed_local_search.hpp"
#include "planner/team/decision/team_set.hpp"
#include "tools/experiment/energy_trial.hpp"
#include "tools/experiment/experiment.hpp"
#include "tools/experiment/figures.hpp"
#include "tools/experiment/sample.hpp"

namespace vantage::tools {
namespace {

using planner::DistributedOptions;
using planner::TeamDecision;
using planner::TeamOracle;

constexpr int kTrials = 50;  // as the dissertation
constexpr double kBestShare = 0.1;

const planner::SearchCapacity kCapacity{2'000'000, 60'000'000, 16, 16, 1};

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// What one way to decide took and found in one trial.
struct Outcome {
  std::string method;
  double value = 0.0;
  double calls_per_candidate = 0.0;  ///< the valuing of each one alone included
  double adopted = 0.0;
  double messages = 0.0;
  double cpu_s = 0.0;
};

using Decide = std::function<TeamDecision(const TeamOracle& oracle)>;

Outcome measure(const std::string& method, const TeamOracle& oracle, const Decide& decide) {
  const double start_s = thread_cpu_s();
  const TeamDecision decision = decide(oracle);
  Outcome outcome;
  outcome.cpu_s = thread_cpu_s() - start_s;
  outcome.method = method;
  outcome.value = decision.value;
  const double candidates = std::max(1, oracle.candidate_count());
  outcome.calls_per_candidate = 1.0 + static_cast<double>(decision.oracle_calls) / candidates;
  outcome.adopted = static_cast<double>(decision.adopted);
  outcome.messages = static_cast<double>(decision.messages);
  return outcome;
}

Decide local_search(bool lazy, bool warm_start) {
  return [=](const TeamOracle& oracle) {
    return distributed_local_search(oracle, DistributedOptions{1.0, lazy, warm_start},
                                    Deadline::never());
  };
}

Decide descent(bool dearest_first) {
  return [=](const TeamOracle& oracle) {
    planner::DescentOptions options;
    options.order.resize(static_cast<std::size_t>(oracle.robot_count()));
    std::iota(options.order.begin(), options.order.end(), 0);
    if (dearest_first) {
      std::reverse(options.order.begin(), options.order.end());
    }
    return coordinate_descent(oracle, options);
  };
}

// Seconds of one oracle call that keeps nothing from call to call: every target from the first step
// on, for full teams of random candidates.
double from_scratch_call_s(const TeamOracle& oracle, std::uint64_t seed) {
  constexpr int kCalls = 300;
  std::vector<TeamOracle::Looks> looks;
  double sink = 0.0;
  const double start_s = thread_cpu_s();
  for (int call = 0; call < kCalls; ++call) {
    for (int m = 0; m < oracle.target_count(); ++m) {
      looks.clear();
      for (int robot = 0; robot < oracle.robot_count(); ++robot) {
        const auto count = static_cast<std::uint64_t>(oracle.end(robot) - oracle.begin(robot));
        const auto drawn = static_cast<planner::CandidateId>(
            (seed + static_cast<std::uint64_t>(call) * 7919U) % std::max<std::uint64_t>(1, count));
        const std::vector<planner::Look>& all = oracle.candidate(oracle.begin(robot) + drawn).looks;
        const auto [begin, end] = std::equal_range(
            all.begin(), all.end(), planner::Look{static_cast<std::uint16_t>(m), 0, {}},
            [](const planner::Look& a, const planner::Look& b) { return a.target < b.target; });
        looks.emplace_back(begin, end);
      }
      sink += oracle.follow(m, 0, oracle.start_of(m), looks, nullptr);
    }
  }
  // Used, so that nothing of it can be left out.
  return (thread_cpu_s() - start_s + 0.0 * sink) / kCalls;
}

// One trial by every method, in the order in which they are told of.
using RunTrial = std::function<std::vector<Outcome>(const TeamOracle& oracle)>;

struct MethodSummary {
  Sample value;
  Sample calls;
  Sample adopted;
  Sample messages;
  Sample cpu_s;
};

// All trials for n = 2 … 10 robots: every row, and a summary by n and method.
class EnergySweep {
 public:
  EnergySweep(const ExperimentOptions& options, RunTrial run_trial)
      : options_(options),
        trials_(options.smoke        ? 2
                : options.trials > 0 ? options.trials
                                     : kTrials),
        robots_max_(options.smoke ? 4 : 10),
        run_trial_(std::move(run_trial)) {}

  ExperimentResult run() {
    planner::ReducedValueIteration search(kCapacity);
    std::string rows =
        "robots,trial,candidates,method,value,calls_per_candidate,adopted,messages\n";
    std::string times = "robots,trial,method,cpu_s\n";
    int done = 0;
    for (int n = kRobotsMin; n <= robots_max_; ++n) {
      for (int trial = 0; trial < trials_; ++trial) {
        const double start_s = thread_cpu_s();
        const EnergyTrial drawn = draw_energy_trial(
            n, options_.seed + static_cast<std::uint64_t>(trial), EnergyTrialOptions{}, search);
        const double drawn_s = thread_cpu_s();
        const TeamOracle oracle(drawn.team);
        const double alone_s = thread_cpu_s();
        candidates_[n].add(oracle.candidate_count());
        times += fmt::format("{},{},trajectories,{:.6f}\n", n, trial, drawn_s - start_s);
        times += fmt::format("{},{},each alone,{:.6f}\n", n, trial, alone_s - drawn_s);
        for (const Outcome& outcome : run_trial_(oracle)) {
          note(n, outcome);
          rows += fmt::format("{},{},{},{},{:.9f},{:.6f},{:g},{:g}\n", n, trial,
                              oracle.candidate_count(), outcome.method, outcome.value,
                              outcome.calls_per_candidate, outcome.adopted, outcome.messages);
          times += fmt::format("{},{},{},{:.6f}\n", n, trial, outcome.method, outcome.cpu_s);
        }
        note_times(n, drawn_s - start_s, alone_s - drawn_s,
                   from_scratch_call_s(oracle, options_.seed));
        if (options_.progress) {
          const int all = (robots_max_ - kRobotsMin + 1) * trials_;
          options_.progress(static_cast<double>(++done) / all);
        }
      }
    }
    ExperimentResult result;
    result.files["trials.csv"] = rows;
    result.files["times.csv"] = times;
    result.files["summary.csv"] = summary();
    result.settings = {{"trials", trials_},
                       {"robots_max", robots_max_},
                       {"prior_position_sigma_m", EnergyTrialOptions{}.prior_position_sigma_m},
                       {"prior_velocity_sigma_mps", EnergyTrialOptions{}.prior_velocity_sigma_mps},
                       {"acceleration_q", EnergyTrialOptions{}.acceleration_q},
                       {"yaw_weight_m_per_rad", EnergyTrialOptions{}.yaw_weight_m_per_rad}};
    return result;
  }

  [[nodiscard]] int robots_max() const { return robots_max_; }
  [[nodiscard]] double candidates(int n) const { return candidates_.at(n).mean(); }
  [[nodiscard]] const MethodSummary& of(int n, const std::string& method) const {
    return summaries_.at(n).at(method);
  }

  /// CPU seconds of trajectories and of valuing each alone, and of one call from scratch.
  struct Times {
    Sample trajectories_s;
    Sample alone_s;
    Sample from_scratch_call_s;
  };
  [[nodiscard]] const Times& times(int n) const { return times_.at(n); }

  static constexpr int kRobotsMin = 2;

 private:
  void note_times(int n, double trajectories_s, double alone_s, double from_scratch_call_s) {
    times_[n].trajectories_s.add(trajectories_s);
    times_[n].alone_s.add(alone_s);
    times_[n].from_scratch_call_s.add(from_scratch_call_s);
  }

  void note(int n, const Outcome& outcome) {
    MethodSummary& summary = summaries_[n][outcome.method];
    summary.value.add(outcome.value);
    summary.calls.add(outcome.calls_per_candidate);
    summary.adopted.add(outcome.adopted);
    summary.messages.add(outcome.messages);
    summary.cpu_s.add(outcome.cpu_s);
  }

  [[nodiscard]] std::string summary() const {
    std::string text =
        "robots,method,candidates,value,value_sd,value_ci95,calls_per_candidate,calls_sd,adopted,"
        "adopted_sd,messages\n";
    for (const auto& [n, methods] : summaries_) {
      for (const auto& [method, s] : methods) {
        text +=
            fmt::format("{},{},{:.1f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.4f},{:.4f},{:.4f}\n", n,
                        method, candidates(n), s.value.mean(), s.value.deviation(),
                        s.value.half_interval(), s.calls.mean(), s.calls.deviation(),
                        s.adopted.mean(), s.adopted.deviation(), s.messages.mean());
      }
    }
    return text;
  }

  ExperimentOptions options_;
  int trials_;
  int robots_max_;
  RunTrial run_trial_;
  std::map<int, Sample> candidates_;
  std::map<int, Times> times_;
  std::map<int, std::map<std::string, MethodSummary>> summaries_;
};

}  // namespace

ExperimentResult run_dls_savings(const ExperimentOptions& options) {
  EnergySweep sweep(options, [](const TeamOracle& oracle) {
    return std::vector<Outcome>{measure("naive", oracle, local_search(false, false)),
                                measure("lazy", oracle, local_search(true, false)),
                                measure("warm", oracle, local_search(false, true)),
                                measure("lazy + warm", oracle, local_search(true, true))};
  });
  ExperimentResult result = sweep.run();
  result.figure = dls_savings_figure();
  for (int n = EnergySweep::kRobotsMin; n <= sweep.robots_max(); ++n) {
    const MethodSummary& naive = sweep.of(n, "naive");
    const MethodSummary& both = sweep.of(n, "lazy + warm");
    result.report.push_back(fmt::format(
        "{:2} robots, N = {:6.0f}: {:5.2f} N calls instead of {:5.2f} N ({:.1f} % fewer), "
        "{:.2f} proposals adopted instead of {:.2f}, {:.1f} messages instead of {:.1f}",
        n, sweep.candidates(n), both.calls.mean(), naive.calls.mean(),
        100.0 * (1.0 - both.calls.mean() / naive.calls.mean()), both.adopted.mean(),
        naive.adopted.mean(), both.messages.mean(), naive.messages.mean()));
  }
  const int n = sweep.robots_max();
  const EnergySweep::Times& times = sweep.times(n);
  const MethodSummary& naive = sweep.of(n, "naive");
  result.report.push_back(fmt::format(
      "CPU of {} robots, means: trajectories {:.3f} s, each alone {:.4f} s, lazy + warm {:.4f} s; "
      "naive {:.3f} s, and {:.2f} s if every call began from scratch",
      n, times.trajectories_s.mean(), times.alone_s.mean(), sweep.of(n, "lazy + warm").cpu_s.mean(),
      naive.cpu_s.mean(),
      naive.calls.mean() * sweep.candidates(n) * times.from_scratch_call_s.mean()));
  return result;
}

ExperimentResult run_dls_objective(const ExperimentOptions& options) {
  EnergySweep sweep(options, [](const TeamOracle& oracle) {
    std::vector<Outcome> outcomes = {measure("cd cheap first", oracle, descent(false)),
                                     measure("cd dear first", oracle, descent(true)),
                                     measure("dls", oracle, local_search(true, true))};
    const planner::TeamProblem best = best_share(oracle, kBestShare);
    outcomes.push_back(measure("dls best 10 %", TeamOracle(best), local_search(true, true)));
    return outcomes;
  });
  ExperimentResult result = sweep.run();
  result.figure = dls_objective_figure();
  for (int n = EnergySweep::kRobotsMin; n <= sweep.robots_max(); ++n) {
    const auto value = [&](const char* method) { return sweep.of(n, method).value.mean(); };
    result.report.push_back(fmt::format(
        "{:2} robots, N = {:6.0f}: J = {:.2f} of DLS, {:.2f} of its best 10 %, {:.2f} of CD cheap "
        "first, {:.2f} of CD dear first",
        n, sweep.candidates(n), value("dls"), value("dls best 10 %"), value("cd cheap first"),
        value("cd dear first")));
  }
  return result;
}

}  // namespace vantage::tools
