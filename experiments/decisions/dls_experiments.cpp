#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "experiments/decisions/energy_sweep.hpp"
#include "experiments/decisions/energy_trial.hpp"
#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/sweep/compare.hpp"

namespace vantage::experiments {
namespace {

using planner::TeamOracle;

constexpr double kBestShare = 0.1;

std::vector<Decided> decide_four_ways(const TeamOracle& oracle) {
  return {local_search("naive", oracle, false, false), local_search("lazy", oracle, true, false),
          local_search("warm", oracle, false, true),
          local_search("lazy + warm", oracle, true, true)};
}

std::vector<Decided> decide_by_all(const TeamOracle& oracle) {
  const planner::TeamProblem best = best_share(oracle, kBestShare);
  return {descent("cd cheap first", oracle, false), descent("cd dear first", oracle, true),
          local_search("dls", oracle, true, true),
          local_search("dls best 10 %", TeamOracle(best), true, true)};
}

double fewer_percent(double of_ours, double of_naive) {
  return of_naive > 0.0 ? 100.0 * (1.0 - of_ours / of_naive) : 0.0;
}

Summary summarise_savings(const Tables& tables) {
  const EnergySamples samples(tables);
  Summary summary;
  summary.files["summary.csv"] = samples.csv();
  summary.figure_script = dls_savings_figure();
  summary.figures = {"dls-savings"};
  summary.choices = energy_choices();
  for (const int n : samples.team_sizes()) {
    const MethodSamples& naive = samples.of(n, "naive");
    const MethodSamples& both = samples.of(n, "lazy + warm");
    const double fewer_calls = fewer_percent(both.calls.mean(), naive.calls.mean());
    const double fewer_adopted = fewer_percent(both.adopted.mean(), naive.adopted.mean());
    summary.compared.push_back(compare_range(
        fmt::format("{} robots: reduction of the oracle calls", n), fewer_calls, 80, 92, "%"));
    summary.compared.push_back(
        compare_range(fmt::format("{} robots: reduction of the adopted proposals", n),
                      fewer_adopted, 0, 60, "%"));
    summary.lines.push_back(fmt::format(
        "{:2} robots, N = {:6.0f} candidates: {:5.3f} N oracle calls instead of {:5.2f} N ({:.1f} "
        "% fewer; {:.1f} % if the N calls for the single candidates are added to both), {:.2f} "
        "proposals adopted instead of {:.2f}, {:.1f} messages instead of {:.1f}",
        n, samples.candidates(n), both.calls.mean(), naive.calls.mean(), fewer_calls,
        fewer_percent(1.0 + both.calls.mean(), 1.0 + naive.calls.mean()), both.adopted.mean(),
        naive.adopted.mean(), both.messages.mean(), naive.messages.mean()));
  }
  const int n = samples.team_sizes().back();
  const auto mean_s = [&](const char* part) { return samples.cpu_s(n, part).mean(); };
  summary.time_lines.push_back(fmt::format(
      "Mean CPU time with {} robots: candidate trajectories {:.3f} s (published: < 2 s), gains of "
      "single candidates {:.4f} s, local search lazy + warm {:.4f} s; naive {:.3f} s, or {:.2f} s "
      "if calls share no results",
      n, mean_s("trajectories"), mean_s("each alone"), mean_s("lazy + warm"), mean_s("naive"),
      samples.of(n, "naive").calls.mean() * samples.candidates(n) *
          mean_s("one call from scratch")));
  return summary;
}

// J of distributed local search (DLS) minus J of the better order of coordinate descent, over the
// trials of each team size.
struct Gaps {
  std::map<int, Sample> of_dls;
  std::map<int, Sample> of_best_share;
  Sample slope;  ///< by trial: least-squares slope of the gap over the number of robots
};

double slope_of(const std::map<int, double>& gap_by_robots) {
  const auto count = static_cast<double>(gap_by_robots.size());
  double n_sum = 0.0;
  double gap_sum = 0.0;
  for (const auto& [n, gap] : gap_by_robots) {
    n_sum += n;
    gap_sum += gap;
  }
  double above = 0.0;
  double below = 0.0;
  for (const auto& [n, gap] : gap_by_robots) {
    above += (n - n_sum / count) * (gap - gap_sum / count);
    below += std::pow(n - n_sum / count, 2);
  }
  return below > 0.0 ? above / below : 0.0;
}

Gaps gaps_of(const Tables& tables) {
  std::map<std::pair<int, int>, std::map<std::string, double>> values;  // by robots and trial
  for (const Record& record : tables.at("trials")) {
    values[{robots_of(record.unit.setting), record.unit.trial}][record.cells[1]] = record.number(2);
  }
  Gaps gaps;
  std::map<int, std::map<int, double>> by_trial;
  for (const auto& [at, by_method] : values) {
    const auto& [robots, trial] = at;
    const double cd = std::max(by_method.at("cd cheap first"), by_method.at("cd dear first"));
    gaps.of_dls[robots].add(by_method.at("dls") - cd);
    gaps.of_best_share[robots].add(by_method.at("dls best 10 %") - cd);
    by_trial[trial][robots] = by_method.at("dls") - cd;
  }
  for (const auto& [trial, gap_by_robots] : by_trial) {
    gaps.slope.add(slope_of(gap_by_robots));
  }
  return gaps;
}

Summary summarise_objective(const Tables& tables) {
  const EnergySamples samples(tables);
  const Gaps gaps = gaps_of(tables);
  Summary summary;
  summary.files["summary.csv"] = samples.csv();
  summary.figure_script = dls_objective_figure();
  summary.figures = {"dls-objective"};
  summary.choices = energy_choices();
  for (const int n : samples.team_sizes()) {
    const auto value = [&](const char* method) { return samples.of(n, method).value.mean(); };
    const double cd = std::max(value("cd cheap first"), value("cd dear first"));
    summary.compared.push_back(compare_claim(
        fmt::format("{} robots: mean J of DLS minus mean J of the better order of CD", n),
        fmt::format("{:.2f} nats; mean difference to the better order of each trial: {}",
                    value("dls") - cd, mean_text(gaps.of_dls.at(n))),
        "≥ 0", value("dls") >= cd));
    summary.compared.push_back(compare_claim(
        fmt::format("{} robots: mean J of DLS with the best 10 % of the candidates, minus CD", n),
        fmt::format("{:.2f} nats; mean difference to the better order of each trial: {}",
                    value("dls best 10 %") - cd, mean_text(gaps.of_best_share.at(n))),
        "> 0", value("dls best 10 %") > cd));
    summary.lines.push_back(
        fmt::format("{:2} robots, N = {:6.0f} candidates: value J = {:.2f} for DLS, {:.2f} for DLS "
                    "with the best 10 % of the candidates, {:.2f} for coordinate descent with "
                    "cheap robots first, {:.2f} with expensive robots first",
                    n, samples.candidates(n), value("dls"), value("dls best 10 %"),
                    value("cd cheap first"), value("cd dear first")));
  }
  const double least = gaps.slope.mean() - gaps.slope.half_interval();
  summary.compared.push_back(
      {"growth of the gap between DLS and the better order of CD, per robot",
       mean_text(gaps.slope) + " nats", "grows with the number of robots",
       least > 0.0 ? "none: it holds" : "no significant growth: the interval contains 0"});
  return summary;
}

}  // namespace

Sweep dls_savings(const Extent& extent) {
  return energy_sweep(extent, decide_four_ways, summarise_savings);
}

Sweep dls_objective(const Extent& extent) {
  return energy_sweep(extent, decide_by_all, summarise_objective);
}

}  // namespace vantage::experiments
