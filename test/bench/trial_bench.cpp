#include <cstdio>
#include <ctime>
#include <map>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "core/deadline.hpp"
#include "logs/file/log_index.hpp"
#include "scenario/reader/overrides.hpp"
#include "trial/recipe.hpp"
#include "trial/trial.hpp"

// Measures the cost of a trial in virtual time. Prints one line per scenario with wall and CPU
// time, memory, and the CPU time per robot and planning round. --csv prints a line of a table
// (header: --csv-head). --log FILE writes a new log and prints the bytes that each robot published
// per second. --json instead prints the trial's summary and the bytes that robots sent to each
// other, to compare two builds bit for bit.

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

enum class Form { kWords, kCsv, kJson };

constexpr const char* kCsvHead =
    "robots,targets,duration_s,wall_s,cpu_s,build_s,peak_mb,ms_a_robot_round,plans,fallbacks,"
    "known,collisions";

struct Cost {
  double wall_s = 0.0;
  double cpu_s = 0.0;
  double built_s = 0.0;
};

void print(const vantage::scenario::Scenario& scenario, const Cost& cost,
           const vantage::trial::TrialResult& result, Form form) {
  const vantage::logs::TrialSummary& summary = result.summary;
  if (form == Form::kJson) {
    auto json = vantage::logs::to_json(summary);
    for (const auto& each : result.air_bytes) {
      json["air_bytes"][each.name] = each.count;
    }
    fmt::print("{}\n", json.dump(2));
    return;
  }
  const double rounds =
      scenario.duration_s / (scenario.planner.step_s * scenario.planner.execute_steps);
  const std::size_t robots = scenario.robots.size();
  const double round_ms =
      1e3 * (cost.cpu_s - cost.built_s) / (static_cast<double>(robots) * rounds);
  if (form == Form::kCsv) {
    fmt::print("{},{},{:g},{:.2f},{:.2f},{:.2f},{:.0f},{:.3f},{},{},{},{}\n", robots,
               scenario.targets.size(), scenario.duration_s, cost.wall_s, cost.cpu_s, cost.built_s,
               peak_mb(), round_ms, summary.plans, summary.fallbacks, summary.discovered,
               summary.collisions);
    return;
  }
  fmt::print(
      "{} robots, {} targets, {:g} s: wall {:.2f} s, cpu {:.2f} s ({:.2f} s to build), "
      "peak {:.0f} MB, {:.3f} ms a robot-round, {} plans, {} collisions\n",
      robots, scenario.targets.size(), scenario.duration_s, cost.wall_s, cost.cpu_s, cost.built_s,
      peak_mb(), round_ms, summary.plans, summary.collisions);
}

/// Prints the bytes of each kind of channel that a robot published per second of the trial.
void print_traffic(const vantage::scenario::Scenario& scenario, const std::string& log_path) {
  const vantage::logs::IndexedLog log(log_path);
  std::map<std::string, double> bytes;
  vantage::logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    const std::string channel(event->channel);
    bytes[channel.substr(0, channel.find('_'))] += static_cast<double>(event->data.size());
  }
  const double robot_seconds = static_cast<double>(scenario.robots.size()) * scenario.duration_s;
  for (const auto& [kind, sum] : bytes) {
    fmt::print("{},{},{:.0f}\n", scenario.robots.size(), kind, sum / robot_seconds);
  }
}

int run(const std::string& path, const vantage::scenario::Overrides& overrides, Form form,
        const std::string& log_path) {
  const vantage::scenario::Scenario scenario =
      vantage::scenario::load_scenario_with(path, overrides);
  const double cpu_begin_s = cpu_s();
  const std::int64_t begin_ns = vantage::monotonic_ns();
  Cost cost;
  vantage::trial::TrialResult result;
  {
    vantage::trial::Trial trial(scenario, vantage::trial::trial_recipes(scenario), log_path);
    cost.built_s = cpu_s() - cpu_begin_s;
    trial.advance_to(trial.planned_end());
    result = trial.result();
  }
  cost.cpu_s = cpu_s() - cpu_begin_s;
  cost.wall_s = static_cast<double>(vantage::monotonic_ns() - begin_ns) * 1e-9;
  if (log_path.empty()) {
    print(scenario, cost, result, form);
  } else {
    print_traffic(scenario, log_path);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What a trial in virtual time costs.");
  std::string path;
  vantage::scenario::Overrides overrides;
  std::string log_path;
  bool as_json = false;
  bool as_csv = false;
  app.add_option("scenario", path)->required();
  app.add_option("--log", log_path);
  app.add_flag("--csv", as_csv);
  app.add_flag_callback("--csv-head", [] { fmt::print("{}\n", kCsvHead); });
  app.add_option("--seed", overrides.seed);
  app.add_option("--duration-s", overrides.duration_s);
  app.add_option("--nodes", overrides.node_budget);
  app.add_option("--planner", overrides.planner);
  app.add_flag("--json", as_json);
  CLI11_PARSE(app, argc, argv);
  try {
    return run(path, overrides,
               as_json  ? Form::kJson
               : as_csv ? Form::kCsv
                        : Form::kWords,
               log_path);
  } catch (const std::exception& error) {
    fmt::print(stderr, "trial_bench: {}\n", error.what());
    return 2;
  }
}
