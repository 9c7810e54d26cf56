#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/surveillance/camp_world.hpp"
#include "experiments/surveillance/restricted_mean.hpp"
#include "experiments/surveillance/surveillance_trial.hpp"
#include "experiments/sweep/cases.hpp"
#include "experiments/sweep/compare.hpp"
#include "experiments/team/attackers.hpp"

namespace vantage::experiments {
namespace {

constexpr int kTrials = 50;  // number of trials in the dissertation
constexpr int kRobots = 5;
constexpr int kAttacks = 2;
constexpr int kReplanMax = 10;
constexpr int kDrawnReplan = 5;
constexpr int kSmokeSteps = 20;
constexpr double kSmokeDelta_m = 4.0;

// One setting of the sweep. Settings are in pairs: coordinate descent, then RAIN.
struct WatchCase {
  NamedAttacker attacker;
  int replan_steps;
  int attacks;
  bool is_rain;
  [[nodiscard]] std::string cells() const {
    return fmt::format("{},{},{},{}", attacker.name, replan_steps, attacks,
                       is_rain ? "rain" : "cd");
  }
  [[nodiscard]] bool is_drawn() const {
    return attacker.attacker == kAttackers.front().attacker && replan_steps == kDrawnReplan &&
           attacks == kAttacks;
  }
};

// Attacker and number of attacks that are compared for all values of T_REPLAN.
struct Attacked {
  NamedAttacker attacker;
  int attacks;
};
constexpr std::array<Attacked, 3> kAttacked = {
    {{kAttackers[0], kAttacks}, {kAttackers[1], kAttacks}, {kAttackers[0], kAttacks + 1}}};

// Returns the cases of all values of T_REPLAN for each of kAttacked. The last pair has one attack,
// by the first attacker.
std::vector<WatchCase> all_cases() {
  std::vector<WatchCase> cases;
  const auto add = [&](const NamedAttacker& attacker, int replan_steps, int attacks) {
    cases.push_back({attacker, replan_steps, attacks, false});
    cases.push_back({attacker, replan_steps, attacks, true});
  };
  for (const auto& [attacker, attacks] : kAttacked) {
    for (int replan_steps = 1; replan_steps <= kReplanMax; ++replan_steps) {
      add(attacker, replan_steps, attacks);
    }
  }
  add(kAttackers.front(), kDrawnReplan, kAttacks - 1);
  return cases;
}

// Columns of the table of runs, in their order.
enum Measure : std::size_t {
  kInterval,
  kWithEnds,
  kByLandmark,
  kAge,
  kAbsence,
  kRestrictedByLandmark = 9,
  kRestricted,
  kMeasures
};
constexpr const char* kColumns =
    "interval,interval_with_ends,interval_by_landmark,age,absence,longest,never_seen,entropy_nats,"
    "turns_on_the_spot,restricted_by_landmark,restricted";
constexpr std::array<std::pair<Measure, const char*>, 6> kCompared = {
    {{kInterval, "mean interval between two observations"},
     {kWithEnds, "mean interval, waits at both ends included"},
     {kByLandmark, "mean interval: average of the landmarks' means"},
     {kAge, "mean time since the last observation"},
     {kRestrictedByLandmark, "time unobserved, restricted mean per landmark"},
     {kRestricted, "time unobserved, restricted mean over all landmarks"}}};

WatchSetting setting_of(const WatchCase& of, bool is_smoke) {
  WatchSetting setting = surveillance_setting(of.replan_steps, of.attacks);
  setting.attacker = of.attacker.attacker;
  if (is_smoke) {
    setting.task_steps = kSmokeSteps;
    setting.delta_m = kSmokeDelta_m;
  }
  return setting;
}

UnitRows run_unit(const WatchCase& of, bool is_smoke, std::uint64_t seed) {
  const WatchSetting setting = setting_of(of, is_smoke);
  const WatchRun run = watch(setting, surveillance_starts(setting, kRobots, seed), of.is_rain);
  const Revisits times = revisits(run.seen);
  const TimeUnobserved unobserved = time_unobserved(run.seen);
  UnitRows rows;
  rows.tables["runs"] = {
      fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{},{},{:.6f},{},{:.6f},{:.6f}",
                  times.interval, times.interval_with_ends, times.interval_by_landmark, times.age,
                  times.absence, times.longest, times.never_seen, run.entropy_nats.back(),
                  run.turns_on_the_spot, unobserved.by_landmark, unobserved.pooled)};
  for (std::size_t t = 0; of.is_drawn() && t < run.attacked.size(); ++t) {
    for (std::size_t i = 0; i < run.poses[t].size(); ++i) {
      const Pose2& at = run.poses[t + 1][i];
      rows.tables["ways"].push_back(fmt::format("{},{},{:.2f},{:.2f},{:d}", i, t + 1, at.x_m,
                                                at.y_m, run.attacked[t][i] != 0));
    }
  }
  return rows;
}

// Values of one setting, by measure and trial; NaN for a missing value.
using Runs = std::array<std::vector<double>, kMeasures>;

Sample sample_of(const std::vector<double>& values) {
  Sample sample;
  for (const double value : values) {
    if (std::isfinite(value)) {
      sample.add(value);
    }
  }
  return sample;
}

// Returns the reduction by RAIN for each trial; both methods have the same starts.
Sample reduction_by_rain(const std::vector<double>& descent, const std::vector<double>& rain) {
  std::vector<double> less;
  for (std::size_t i = 0; i < std::min(descent.size(), rain.size()); ++i) {
    less.push_back(descent[i] - rain[i]);
  }
  return sample_of(less);
}

double share_less(const Runs& descent, const Runs& rain, Measure measure) {
  return 100.0 * (1.0 - sample_of(rain[measure]).mean() / sample_of(descent[measure]).mean());
}

std::vector<Runs> runs_of(const Tables& tables, std::size_t settings) {
  std::vector<Runs> runs(settings);
  for (const Record& record : tables.at("runs")) {
    for (std::size_t measure = 0; measure < kMeasures; ++measure) {
      runs[record.unit.setting][measure].push_back(record.number(measure));
    }
  }
  return runs;
}

std::string summary_csv(const std::vector<WatchCase>& cases, const std::vector<Runs>& runs) {
  std::string text = "attacker,replan_steps,attacks,method,trials";
  for (const std::string& column : cells_of(kColumns)) {
    text += fmt::format(",{0},{0}_ci95", column);
  }
  text += "\n";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    text += fmt::format("{},{}", cases[i].cells(), runs[i][kInterval].size());
    for (const std::vector<double>& values : runs[i]) {
      const Sample sample = sample_of(values);
      text += fmt::format(",{:.4f},{:.4f}", sample.mean(), sample.half_interval());
    }
    text += "\n";
  }
  return text;
}

// Returns the corners of all boxes, buildings first: index, x0, y0, x1, y1.
std::string boxes_text() {
  std::string text;
  const std::size_t buildings = camp_landmarks_m().size();
  const models::World camp = camp_world();
  for (std::size_t i = 0; i < camp.obstacles.size(); ++i) {
    const models::Rectangle& of = camp.obstacles[i].footprint;
    text += fmt::format("{} {} {} {} {}\n", i < buildings ? "building" : "tree", of.min_m.x(),
                        of.min_m.y(), of.max_m.x(), of.max_m.y());
  }
  return text;
}

std::map<std::string, std::string> way_files(const Tables& tables,
                                             const std::vector<WatchCase>& cases) {
  std::map<std::string, std::string> files = {{"boxes.txt", boxes_text()}};
  for (const models::PositionVector& at_m : camp_landmarks_m()) {
    files["landmarks.txt"] += fmt::format("{} {} {}\n", at_m.x(), at_m.y(), at_m.z());
  }
  for (const Record& record : tables.at("ways")) {
    if (record.unit.trial == 0) {
      const char* of = cases[record.unit.setting].is_rain ? "rain" : "cd";
      files[fmt::format("ways_{}.txt", of)] +=
          fmt::format("{} {} {} {} {}\n", record.cells[0], record.cells[1], record.cells[2],
                      record.cells[3], record.cells[4]);
    }
  }
  return files;
}

// Compares the `runs` of one attacker and number of attacks, in pairs by T_REPLAN.
void compare(const Attacked& attacked, std::span<const Runs> runs, Summary& summary) {
  for (const auto& [measure, label] : kCompared) {
    const std::string what =
        fmt::format("attacked: {}, α = {}: {}", attacked.attacker.text, attacked.attacks, label);
    int better = 0;
    for (std::size_t i = 0; i < runs.size(); i += 2) {
      better += share_less(runs[i], runs[i + 1], measure) > 0.0 ? 1 : 0;
    }
    summary.compared.push_back(
        compare_claim(fmt::format("{}: RAIN below coordinate descent", what),
                      fmt::format("at {} of {} values of T_REPLAN", better, kReplanMax),
                      "at every value", better == kReplanMax));
    const double at_one = share_less(runs[0], runs[1], measure);
    summary.compared.push_back(
        compare_claim(fmt::format("{}: reduction by RAIN at T_REPLAN = 1", what),
                      fmt::format("{:.1f} %", at_one), "≥ 24 %", at_one >= 24.0));
    const double at_last = share_less(runs[runs.size() - 2], runs.back(), measure);
    summary.compared.push_back(compare_claim(
        fmt::format("{}: RAIN reduces the error more at T_REPLAN = 10 than at 1", what),
        fmt::format("{:.1f} % and {:.1f} %", at_last, at_one), "it grows", at_last > at_one));
  }
}

void add_lines(const std::vector<WatchCase>& cases, const std::vector<Runs>& runs,
               Summary& summary) {
  for (std::size_t i = 0; i + 1 < cases.size(); i += 2) {
    std::string line = fmt::format("T_REPLAN = {}, α = {}, attacked: {}:", cases[i].replan_steps,
                                   cases[i].attacks, cases[i].attacker.text);
    for (const auto& [measure, what] : kCompared) {
      line += fmt::format(" {} {} (CD), {} (RAIN), paired reduction {} ({:.0f} %);", what,
                          mean_text(sample_of(runs[i][measure])),
                          mean_text(sample_of(runs[i + 1][measure])),
                          mean_text(reduction_by_rain(runs[i][measure], runs[i + 1][measure])),
                          share_less(runs[i], runs[i + 1], measure));
    }
    summary.lines.push_back(line);
  }
}

Summary summarise(const Tables& tables) {
  const std::vector<WatchCase> cases = all_cases();
  const std::vector<Runs> runs = runs_of(tables, cases.size());
  Summary summary;
  summary.files = way_files(tables, cases);
  summary.files["summary.csv"] = summary_csv(cases, runs);
  summary.figure_script = surveillance_figures();
  summary.figures = {"surveillance-intervals", "surveillance-camp"};
  constexpr std::size_t kOfEach = 2 * kReplanMax;
  for (std::size_t i = 0; i < kAttacked.size(); ++i) {
    compare(kAttacked[i], std::span(runs).subspan(i * kOfEach, kOfEach), summary);
  }
  add_lines(cases, runs, summary);
  summary.choices = {
      "The source does not state the numbers of robots and attacks. Here: five robots as in its "
      "figure; two (\"some\") or three attacked, and one at T_REPLAN = 5.",
      "The map of the camp is our own choice: 120 × 90 m, fifteen buildings with a landmark "
      "each, 24 trees.",
      "The source does not state σ of the range and of the prior. Here: 0.15 m, as in the tracking "
      "experiments, and 1 m.",
      "A search uses the number k of steps for which each landmark was not observed before the "
      "start of the plan.",
      "The attacker chooses robots greedily in each planning round, by the gain of their joint "
      "plans. A second attacker chooses the robots whose single plans gain most.",
      "landmark_watch.hpp describes how each measure counts intervals that have no end; see also "
      "restricted_mean.hpp."};
  return summary;
}

}  // namespace

Sweep surveillance(const Extent& extent) {
  const std::vector<WatchCase> cases = all_cases();
  Sweep sweep =
      sweep_over("attacker,replan_steps,attacks,method", cases, kTrials, extent, run_unit);
  const WatchSetting setting = setting_of(cases.front(), extent.is_smoke);
  sweep.plan.parameters = {{"robots", std::to_string(kRobots)},
                           {"landmarks", std::to_string(setting.landmarks_m.size())},
                           {"task_steps", std::to_string(setting.task_steps)},
                           {"plan_steps", std::to_string(setting.plan_steps)},
                           {"q_m2", fmt::format("{}", setting.landmark_model.q)},
                           {"range_sigma_m", fmt::format("{}", setting.sensor.range_sigma_m)},
                           {"prior_sigma_m", fmt::format("{}", setting.prior_sigma_m)},
                           {"delta_m", fmt::format("{}", setting.delta_m)}};
  sweep.plan.tables = {{"runs", kColumns}, {"ways", "robot,step,x_m,y_m,is_attacked"}};
  sweep.summarise = summarise;
  return sweep;
}

}  // namespace vantage::experiments
