#include <cstdio>
#include <ctime>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "core/deadline.hpp"
#include "scenario/reader/overrides.hpp"
#include "trial/recipe.hpp"
#include "trial/trial.hpp"

// What a trial in virtual time costs: one line a scenario, wall and CPU time, memory, and what
// comes of it for one robot in one planning round. --json prints the trial's summary instead, for
// comparing two builds to the bit.

namespace {

double cpu_s() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double peak_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

int run(const std::string& path, const vantage::scenario::Overrides& overrides, bool as_json) {
  const vantage::scenario::Scenario scenario = vantage::scenario::load_scenario_with(path, overrides);
  const double cpu_begin_s = cpu_s();
  const std::int64_t begin_ns = vantage::monotonic_ns();
  vantage::trial::Trial trial(scenario, vantage::trial::trial_recipes(scenario), "");
  const double built_s = cpu_s() - cpu_begin_s;
  trial.advance_to(trial.planned_end());
  const vantage::logs::TrialSummary summary = trial.result().summary;
  const double used_s = cpu_s() - cpu_begin_s;
  const double wall_s = static_cast<double>(vantage::monotonic_ns() - begin_ns) * 1e-9;
  if (as_json) {
    fmt::print("{}\n", vantage::logs::to_json(summary).dump(2));
    return 0;
  }
  const double rounds =
      scenario.duration_s / (scenario.planner.step_s * scenario.planner.execute_steps);
  const auto robots = static_cast<double>(scenario.robots.size());
  fmt::print(
      "{:.0f} robots, {} targets, {:g} s: wall {:.2f} s, cpu {:.2f} s ({:.2f} s to build), "
      "peak {:.0f} MB, {:.3f} ms a robot-round, {} plans, {} collisions\n",
      robots, scenario.targets.size(), scenario.duration_s, wall_s, used_s, built_s, peak_mb(),
      1e3 * (used_s - built_s) / (robots * rounds), summary.plans, summary.collisions);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What a trial in virtual time costs.");
  std::string path;
  vantage::scenario::Overrides overrides;
  bool as_json = false;
  app.add_option("scenario", path)->required();
  app.add_option("--seed", overrides.seed);
  app.add_option("--duration-s", overrides.duration_s);
  app.add_option("--nodes", overrides.node_budget);
  app.add_option("--planner", overrides.planner);
  app.add_flag("--json", as_json);
  CLI11_PARSE(app, argc, argv);
  try {
    return run(path, overrides, as_json);
  } catch (const std::exception& error) {
    fmt::print(stderr, "trial_bench: {}\n", error.what());
    return 2;
  }
}
