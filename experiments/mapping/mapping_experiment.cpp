#include <array>

#include <fmt/format.h>

#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/mapping/mapping_rows.hpp"
#include "experiments/mapping/mapping_trial.hpp"
#include "experiments/mapping/mapping_worlds.hpp"
#include "experiments/sweep/cases.hpp"
#include "experiments/sweep/compare.hpp"
#include "planner/mapping/resilient_mapping.hpp"

namespace vantage::experiments {
namespace {

constexpr int kTrials = 50;  // number of trials in the dissertation
constexpr int kSmokeSteps = 4;
constexpr std::array<int, 3> kAttacks = {1, 2, 3};
constexpr int kDrawnAttacks = 2;

enum class Variant { kPlain, kDropBeams, kFsmi, kNoFrontier };
constexpr std::array<const char*, 4> kVariants = {"plain", "drop-beams", "fsmi", "no-frontier"};

const char* name_of(AttackKind attack) {
  switch (attack) {
    case AttackKind::kNone:
      return "none";
    case AttackKind::kRandom:
      return "random";
    case AttackKind::kWorstCase:
      return "worst";
    case AttackKind::kBestAlone:
      return "best_alone";
    case AttackKind::kPreviousPlans:
      return "previous";
  }
  return "?";
}

struct MappingCase {
  bool is_corridors = false;
  AttackKind attack = AttackKind::kWorstCase;
  int attacks = kDrawnAttacks;
  Variant variant = Variant::kPlain;
  bool is_rain = false;

  // True if the values of both planners' plans are recorded in each round.
  [[nodiscard]] bool is_compared() const {
    return !is_corridors && attack == AttackKind::kWorstCase && attacks == kDrawnAttacks &&
           variant == Variant::kPlain;
  }
  // True if maps and paths are stored.
  [[nodiscard]] bool is_drawn() const {
    return is_rain && attack == AttackKind::kWorstCase && attacks == kDrawnAttacks &&
           variant == Variant::kPlain;
  }
  [[nodiscard]] bool is_in_dissertation() const {
    return variant == Variant::kPlain &&
           (attack == AttackKind::kWorstCase || attack == AttackKind::kRandom);
  }
  [[nodiscard]] std::string group() const {
    return fmt::format("{},{},{},{}", is_corridors ? "corridors" : "squares", name_of(attack),
                       attacks, kVariants[static_cast<std::size_t>(variant)]);
  }
  [[nodiscard]] std::string cells() const { return group() + (is_rain ? ",rain" : ",descent"); }
};

// Two cases per setting: case 2i uses coordinate descent, case 2i + 1 RAIN.
std::vector<MappingCase> all_cases() {
  std::vector<MappingCase> cases;
  for (const bool is_corridors : {false, true}) {
    for (const AttackKind attack :
         {AttackKind::kWorstCase, AttackKind::kRandom, AttackKind::kBestAlone}) {
      for (const int attacks : kAttacks) {
        cases.push_back({is_corridors, attack, attacks, Variant::kPlain, false});
      }
    }
  }
  for (const Variant variant : {Variant::kDropBeams, Variant::kFsmi, Variant::kNoFrontier}) {
    cases.push_back({false, AttackKind::kWorstCase, kDrawnAttacks, variant, false});
  }
  for (const bool is_corridors : {false, true}) {
    cases.push_back(
        {is_corridors, AttackKind::kPreviousPlans, kDrawnAttacks, Variant::kPlain, false});
  }
  std::vector<MappingCase> both;
  for (MappingCase of : cases) {
    for (const bool is_rain : {false, true}) {
      of.is_rain = is_rain;
      both.push_back(of);
    }
  }
  return both;
}

double kept_nats(planner::MappingSearch& search, const std::vector<planner::MapRoute>& routes,
                 int attacks) {
  std::mt19937_64 unused;
  std::vector<const planner::MapRoute*> left;
  for (const planner::MapRoute& route : routes) {
    left.push_back(&route);
  }
  for (const int robot : attacked_robots(AttackKind::kWorstCase, attacks, routes, search, unused)) {
    left[static_cast<std::size_t>(robot)] = nullptr;
  }
  return search.value(left);
}

// Plans with both methods, records the values that remain after the greedy worst attack, and uses
// one of the plans.
MappingTeamPlanner comparing(bool is_rain, std::vector<std::string>& rounds) {
  return [is_rain, &rounds](planner::MappingSearch& search, std::span<const Pose2> starts,
                            int attacks) {
    std::vector<planner::MapRoute> descent = plan_by_coordinate_descent(search, starts, attacks);
    std::vector<planner::MapRoute> rain =
        planner::plan_mapping_resiliently(search, starts, attacks);
    rounds.push_back(fmt::format("{},{:.6f},{:.6f}", rounds.size(),
                                 kept_nats(search, descent, attacks),
                                 kept_nats(search, rain, attacks)));
    return is_rain ? rain : descent;
  };
}

MappingSetup setup_of(const MappingCase& of, bool is_smoke) {
  MappingSetup setup;
  setup.world = of.is_corridors ? corridor_world() : square_obstacles_world();
  setup.steps = is_smoke ? kSmokeSteps : of.is_corridors ? 100 : 50;
  setup.attack = of.attack;
  setup.attacks = of.attacks;
  if (of.is_rain) {
    setup.planner = planner::plan_mapping_resiliently;
  }
  if (of.variant == Variant::kDropBeams) {
    setup.views.dependence = planner::BeamDependence::kDropBeams;
  } else if (of.variant == Variant::kFsmi) {
    setup.views.measure = planner::BeamMeasure::kFsmi;
  } else if (of.variant == Variant::kNoFrontier) {
    setup.search.frontier_nats_per_m = 0.0;
  }
  return setup;
}

UnitRows run_unit(const MappingCase& of, bool is_smoke, std::uint64_t seed) {
  MappingSetup setup = setup_of(of, is_smoke);
  UnitRows rows;
  if (of.is_compared()) {
    setup.planner = comparing(of.is_rain, rows.tables["rounds"]);
  }
  const MappingOutcome outcome = run_mapping_trial(setup, seed);
  for (std::size_t t = 0; t < outcome.steps.size(); ++t) {
    rows.tables["entropy"].push_back(fmt::format("{},{:.4f}", t, outcome.steps[t].entropy_nats));
  }
  rows.tables["ends"] = {
      fmt::format("{:.4f},{:.4f},{:.4f},{},{:.6f},{}", outcome.steps.front().entropy_nats,
                  outcome.halfway.entropy_nats(), outcome.steps.back().entropy_nats,
                  outcome.stopped, outcome.wrong_share, outcome.nodes)};
  if (of.is_drawn()) {
    add_map_rows(rows, "half", outcome.halfway);
    add_map_rows(rows, "end", outcome.map);
    add_path_rows(rows, outcome);
  }
  return rows;
}

// Entropy at the end and after half of the steps of one setting, by trial.
struct EndSamples {
  Sample halfway_nats;
  Sample end_nats;
  Sample wrong_share;
  std::vector<double> end_by_trial_nats;
};

std::vector<EndSamples> ends_of(const Tables& tables, std::size_t settings) {
  std::vector<EndSamples> ends(settings);
  for (const Record& record : tables.at("ends")) {
    EndSamples& of = ends[record.unit.setting];
    of.halfway_nats.add(record.number(1));
    of.end_nats.add(record.number(2));
    of.wrong_share.add(record.number(4));
    of.end_by_trial_nats.push_back(record.number(2));
  }
  return ends;
}

// Returns the final entropy of RAIN minus that of coordinate descent, by trial. Both use the same
// start, noise and random attacks.
Sample rain_less_descent(const EndSamples& descent, const EndSamples& rain) {
  Sample difference;
  for (std::size_t trial = 0; trial < rain.end_by_trial_nats.size(); ++trial) {
    difference.add(rain.end_by_trial_nats[trial] - descent.end_by_trial_nats[trial]);
  }
  return difference;
}

std::string rounds_line(const Tables& tables) {
  Sample descent;
  Sample rain;
  int better = 0;
  for (const Record& record : tables.at("rounds")) {
    descent.add(record.number(1));
    rain.add(record.number(2));
    better += record.number(2) > record.number(1) ? 1 : 0;
  }
  return fmt::format(
      "Squares, worst case, two attacks, both planners from the same states: after the attack "
      "coordinate descent keeps {:.1f} nats per round, RAIN {:.1f}; RAIN keeps more in {} of {} "
      "rounds",
      descent.mean(), rain.mean(), better, rain.size());
}

Summary summarise(const Tables& tables) {
  const std::vector<MappingCase> cases = all_cases();
  const std::vector<EndSamples> ends = ends_of(tables, cases.size());
  Summary summary;
  std::string csv =
      "world,attack,attacks,variant,planner,trials,halfway_nats,halfway_sd,end_nats,end_sd,"
      "end_ci95,wrong_share\n";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const EndSamples& of = ends[i];
    csv += fmt::format("{},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.6f}\n", cases[i].cells(),
                       of.end_nats.size(), of.halfway_nats.mean(), of.halfway_nats.deviation(),
                       of.end_nats.mean(), of.end_nats.deviation(), of.end_nats.half_interval(),
                       of.wrong_share.mean());
  }
  for (std::size_t i = 0; i + 1 < cases.size(); i += 2) {
    const Sample less = rain_less_descent(ends[i], ends[i + 1]);
    const std::string ours =
        fmt::format("{} nats, paired by trial: CD {}, RAIN {}", mean_text(less),
                    mean_text(ends[i].end_nats), mean_text(ends[i + 1].end_nats));
    const std::string what = "final entropy, RAIN minus CD: " + cases[i].group();
    if (cases[i].is_in_dissertation()) {
      summary.compared.push_back(compare_claim(what, ours, "< 0", less.mean() < 0.0));
    } else {
      summary.lines.push_back("Not in the source: " + what + ": " + ours);
    }
  }
  summary.lines.push_back(rounds_line(tables));
  const auto cells = [&](std::size_t setting) { return cases[setting].cells(); };
  summary.files = map_files(
      tables, {{"squares", square_obstacles_world()}, {"corridors", corridor_world()}}, cells);
  summary.files["summary.csv"] = csv;
  summary.files["curves.csv"] = entropy_curves(tables, cells);
  summary.figure_script = resilient_mapping_figures();
  summary.figures = {"resilient-mapping-maps", "resilient-mapping-entropy"};
  summary.choices = {
      "The source does not state the number of attacked robots. Here: 1, 2 and 3 of 6.",
      "The source sets T_REPLAN = T_TASK, but chooses new attacks after each planning period. "
      "Here: a new plan and new attacks every 4 steps.",
      "The maps of the source have no scale. Here: 16 m, cells of 0.2 m; the map is then nearly "
      "complete at the end, as in the source.",
      "A scan has 96 beams; planning uses 48 of them. One observation of a cell is correct with 95 "
      "% probability, and a cell's occupancy is clamped at 99 %. The team starts in a square with "
      "a side of 6 m.",
      "The end of a plan is rewarded with 0.5 nats per metre towards the nearest frontier (variant "
      "no-frontier: no reward)."};
  return summary;
}

}  // namespace

Sweep resilient_mapping(const Extent& extent) {
  const std::vector<MappingCase> cases = all_cases();
  Sweep sweep =
      sweep_over("world,attack,attacks,variant,planner", cases, kTrials, extent, run_unit);
  const MappingSetup setup = setup_of({}, extent.is_smoke);
  sweep.plan.parameters = {
      {"robots", std::to_string(setup.robots)},
      {"steps", extent.is_smoke ? std::to_string(kSmokeSteps) : "50, 100 in corridors"},
      {"resolution_m", fmt::format("{}", setup.resolution_m)},
      {"horizon_steps", std::to_string(setup.search.horizon_steps)},
      {"frontier_nats_per_m", fmt::format("{}", setup.search.frontier_nats_per_m)},
      {"beams", std::to_string(setup.scanner.beams)},
      {"planned_beams", std::to_string(setup.planned_beams)},
      {"clamp_log_odds", fmt::format("{}", setup.clamp_log_odds)}};
  sweep.plan.tables = {{"entropy", "step,entropy_nats"},
                       {"ends", "start_nats,halfway_nats,end_nats,stopped,wrong_share,nodes"},
                       {"rounds", "round,descent_kept_nats,rain_kept_nats"},
                       {"maps", "map,row,cells"},
                       {"ways", "robot,step,x_m,y_m,is_attacked"}};
  sweep.summarise = summarise;
  return sweep;
}

}  // namespace vantage::experiments
