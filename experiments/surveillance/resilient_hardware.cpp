#include <array>

#include <fmt/format.h>

#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/surveillance/two_targets_trial.hpp"
#include "experiments/sweep/cases.hpp"
#include "experiments/sweep/compare.hpp"

namespace vantage::experiments {
namespace {

constexpr int kTrials = 10;
constexpr int kSmokeSteps = 12;

// The jammed robot (index); −1: chosen by the attacker.
struct Jam {
  const char* name;
  int robot;
};
constexpr std::array<Jam, 3> kJams = {{{"first", 0}, {"second", 1}, {"worst", -1}}};
constexpr std::array<const char*, 2> kMethods = {"cd", "rain"};

struct JamCase {
  Jam jam;
  bool is_rain;
  [[nodiscard]] const char* method() const { return kMethods[is_rain ? 1 : 0]; }
  [[nodiscard]] std::string cells() const { return fmt::format("{},{}", jam.name, method()); }
};

// Returns two cases for each of kJams: coordinate descent, then RAIN.
std::vector<JamCase> all_cases() {
  std::vector<JamCase> cases;
  for (const Jam& jam : kJams) {
    cases.push_back({jam, false});
    cases.push_back({jam, true});
  }
  return cases;
}

WatchSetting setting_of(const JamCase& of, bool is_smoke) {
  WatchSetting setting = two_targets_setting(of.jam.robot);
  if (is_smoke) {
    setting.task_steps = kSmokeSteps;
  }
  return setting;
}

UnitRows run_unit(const JamCase& of, bool is_smoke, std::uint64_t seed) {
  const WatchSetting setting = setting_of(of, is_smoke);
  const WatchRun run = watch(setting, two_targets_starts(setting, seed), of.is_rain);
  const Visits first = visits(setting, run, 0);
  const Visits second = visits(setting, run, 1);
  UnitRows rows;
  rows.tables["trials"] = {fmt::format("{},{},{:.4f},{:.4f},{:.4f}", first.switches,
                                       second.switches, first.home_share, second.home_share,
                                       run.entropy_nats.back())};
  for (std::size_t t = 0; t < run.attacked.size(); ++t) {
    for (std::size_t i = 0; i < run.poses[t].size(); ++i) {
      const Eigen::Vector2d at_m = run.poses[t + 1][i].position_m();
      rows.tables["ways"].push_back(
          fmt::format("{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:d}", i, t + 1, at_m.x(), at_m.y(),
                      (at_m - setting.landmarks_m[0].head<2>()).norm(),
                      (at_m - setting.landmarks_m[1].head<2>()).norm(), run.attacked[t][i] != 0));
    }
  }
  return rows;
}

// Long function: it adds the rows of the page one by one.
Summary summarise(const Tables& tables) {
  struct Trials {
    std::array<Sample, 2> switches;
    std::array<Sample, 2> home_share;
    Sample entropy_nats;
    int sticking = 0;   ///< trials in which neither robot switches
    int switching = 0;  ///< trials in which both switch
  };
  const std::vector<JamCase> cases = all_cases();
  std::vector<Trials> of(cases.size());
  for (const Record& record : tables.at("trials")) {
    Trials& trials = of[record.unit.setting];
    for (const std::size_t robot : {0U, 1U}) {
      trials.switches[robot].add(record.number(robot));
      trials.home_share[robot].add(record.number(2 + robot));
    }
    trials.entropy_nats.add(record.number(4));
    trials.sticking += record.number(0) == 0.0 && record.number(1) == 0.0 ? 1 : 0;
    trials.switching += record.number(0) > 0.0 && record.number(1) > 0.0 ? 1 : 0;
  }
  Summary summary;
  std::string csv =
      "jammed,method,trials,switches_1,switches_1_ci95,switches_2,switches_2_ci95,home_share_1,"
      "home_share_1_ci95,home_share_2,home_share_2_ci95,entropy_nats,entropy_nats_ci95,sticking,"
      "switching\n";
  for (std::size_t i = 0; i < of.size(); ++i) {
    const Trials& trials = of[i];
    csv += fmt::format("{},{}", cases[i].cells(), trials.entropy_nats.size());
    for (const auto* measure : {&trials.switches, &trials.home_share}) {
      for (const Sample& sample : *measure) {
        csv += fmt::format(",{:.4f},{:.4f}", sample.mean(), sample.half_interval());
      }
    }
    csv += fmt::format(",{:.4f},{:.4f},{},{}\n", trials.entropy_nats.mean(),
                       trials.entropy_nats.half_interval(), trials.sticking, trials.switching);
    const std::size_t runs = trials.entropy_nats.size();
    const std::string ours = fmt::format(
        "switches per trial: first robot {}, second {}; no robot switches in {} of {} trials, both "
        "robots in {}",
        mean_text(trials.switches[0]), mean_text(trials.switches[1]), trials.sticking, runs,
        trials.switching);
    const std::string what = fmt::format("jammed robot: {}, {}", cases[i].jam.name,
                                         cases[i].is_rain ? "resilient" : "without resilience");
    summary.compared.push_back(cases[i].is_rain
                                   ? compare_claim(what, ours, "both switch between the targets",
                                                   trials.switching == static_cast<int>(runs))
                                   : compare_claim(what, ours, "each stays at its nearest target",
                                                   trials.sticking == static_cast<int>(runs)));
  }
  summary.files["summary.csv"] = csv;
  for (const Record& record : tables.at("ways")) {
    if (record.unit.trial == 0) {
      const JamCase& way_of = cases[record.unit.setting];
      const std::string file = fmt::format("ways_{}_{}.txt", way_of.jam.name, way_of.method());
      for (std::size_t column = 0; column < record.cells.size(); ++column) {
        summary.files[file] += record.cells[column] + " ";
      }
      summary.files[file] += "\n";
    }
  }
  summary.figure_script = resilient_hardware_figure();
  summary.figures = {"resilient-hardware"};
  summary.choices = {
      "Simulated, not flown, without measurement noise: true positions of robots and targets equal "
      "the estimates.",
      "The source does not state the jammed robot. Here three cases: always the robot that plans "
      "first, always the robot that plans second, or in each round the robot with the larger gain. "
      "The figure shows the first case.",
      "Targets 4 m apart with a random walk of 0.01 m²/s; primitives, noise, T and τ as in "
      "config/lab.yaml; a new plan every two steps; ten trials of two minutes, with one random "
      "start in each half of the world."};
  return summary;
}

}  // namespace

Sweep resilient_hardware(const Extent& extent) {
  const std::vector<JamCase> cases = all_cases();
  Sweep sweep = sweep_over("jammed,method", cases, kTrials, extent, run_unit);
  const WatchSetting setting = setting_of(cases.front(), extent.is_smoke);
  sweep.plan.parameters = {{"task_steps", std::to_string(setting.task_steps)},
                           {"plan_steps", std::to_string(setting.plan_steps)},
                           {"replan_steps", std::to_string(setting.replan_steps)},
                           {"q_m2ps", fmt::format("{}", setting.landmark_model.q)},
                           {"prior_sigma_m", fmt::format("{}", setting.prior_sigma_m)},
                           {"delta_m", fmt::format("{}", setting.delta_m)}};
  sweep.plan.tables = {{"trials", "switches_1,switches_2,home_share_1,home_share_2,entropy_nats"},
                       {"ways", "robot,step,x_m,y_m,to_first_m,to_second_m,is_jammed"}};
  sweep.summarise = summarise;
  return sweep;
}

}  // namespace vantage::experiments
