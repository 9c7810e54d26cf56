// Resilient mapping, trial by trial: a table of the final entropy, curves over time and maps.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/deadline.hpp"
#include "planner/mapping/resilient_mapping.hpp"
#include "tools/experiment/mapping_trial.hpp"
#include "tools/experiment/mapping_worlds.hpp"

namespace vantage {
namespace {

using experiment::AttackKind;

void write_map(const std::string& path, const models::OccupancyBelief& map) {
  std::ofstream out(path);
  for (int row = 0; row < map.geometry().rows; ++row) {
    for (int column = 0; column < map.geometry().columns; ++column) {
      out << fmt::format("{:.3f} ", map.occupancy(row * map.geometry().columns + column));
    }
    out << '\n';
  }
}

void write_outcome(const std::string& stem, const experiment::MappingOutcome& outcome) {
  write_map(stem + "_half.txt", outcome.halfway);
  write_map(stem + "_end.txt", outcome.map);
  std::ofstream out(stem + "_poses.txt");
  const std::size_t robots = outcome.steps.front().poses.size();
  for (std::size_t robot = 0; robot < robots; ++robot) {
    for (std::size_t t = 0; t < outcome.steps.size(); ++t) {
      const experiment::MappingStep& step = outcome.steps[t];
      const bool attacked =
          std::binary_search(step.attacked.begin(), step.attacked.end(), static_cast<int>(robot));
      out << fmt::format("{} {:.3f} {:.3f} {}\n", t, step.poses[robot].x_m, step.poses[robot].y_m,
                         attacked ? 1 : 0);
    }
    out << "\n\n";
  }
}

// Sum of what both planners would keep after the greedy worst attack, from the same states.
struct RoundValues {
  double descent_nats = 0.0;
  double rain_nats = 0.0;
  int rounds = 0;
  int rain_better = 0;
};

double kept_nats(planner::MappingSearch& search, const std::vector<planner::MapRoute>& routes,
                 int attacks) {
  std::mt19937_64 unused;
  std::vector<const planner::MapRoute*> left;
  for (const planner::MapRoute& route : routes) {
    left.push_back(&route);
  }
  for (const int robot :
       experiment::attacked_robots(AttackKind::kWorstCase, attacks, routes, search, unused)) {
    left[static_cast<std::size_t>(robot)] = nullptr;
  }
  return search.value(left);
}

// A planner that plans both ways, notes what both are worth and goes one way.
experiment::MappingTeamPlanner comparing(bool resilient, RoundValues& sums) {
  return [resilient, &sums](planner::MappingSearch& search, std::span<const Pose2> starts,
                            int attacks) {
    std::vector<planner::MapRoute> descent =
        experiment::plan_by_coordinate_descent(search, starts, attacks);
    std::vector<planner::MapRoute> rain =
        planner::plan_mapping_resiliently(search, starts, attacks);
    const double descent_nats = kept_nats(search, descent, attacks);
    const double rain_nats = kept_nats(search, rain, attacks);
    sums.descent_nats += descent_nats;
    sums.rain_nats += rain_nats;
    ++sums.rounds;
    sums.rain_better += rain_nats > descent_nats ? 1 : 0;
    return resilient ? rain : descent;
  };
}

}  // namespace
}  // namespace vantage

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): a main of its own
  std::string world = "squares";
  std::string attack = "worst";
  std::string out = ".";
  int trials = 2;
  int first_trial = 0;
  experiment::MappingSetup setup;
  double side_m = 16.0;
  bool compare = false;
  bool drop = false;
  bool with_fsmi = false;
  CLI::App app("Resilient mapping: CSV of entropy by trial and step, maps of the first trial");
  app.add_option("--world", world, "squares or corridors");
  app.add_option("--attack", attack, "none, random or worst");
  app.add_option("--attacks", setup.attacks, "robots attacked at a time");
  app.add_option("--trials", trials, "seeds 0 …");
  app.add_option("--first-trial", first_trial, "the first seed");
  app.add_option("--steps", setup.steps, "of 1 s");
  app.add_option("--frontier", setup.search.frontier_nats_per_m, "pull of the frontier, nats/m");
  app.add_option("--side", side_m, "of the world, m");
  app.add_flag("--compare", compare, "value both planners in every round");
  app.add_flag("--drop-beams", drop, "drop whole dependent beams");
  app.add_flag("--fsmi", with_fsmi, "FSMI instead of CSQMI");
  app.add_option("--out", out, "folder");
  CLI11_PARSE(app, argc, argv);

  setup.world = world == "squares" ? experiment::square_obstacles_world(side_m)
                                   : experiment::corridor_world(side_m);
  setup.attack = attack == "none"     ? AttackKind::kNone
                 : attack == "random" ? AttackKind::kRandom
                                      : AttackKind::kWorstCase;
  if (drop) {
    setup.views.dependence = planner::BeamDependence::kDropBeams;
  }
  if (with_fsmi) {
    setup.views.measure = planner::BeamMeasure::kFsmi;
  }
  models::OccupancyBelief truth(
      models::GridGeometry::covering(setup.world.bounds, setup.resolution_m), 1.0);
  const models::OccupancyGrid grid = models::rasterise(setup.world, setup.resolution_m);
  for (int cell = 0; cell < grid.geometry.size(); ++cell) {
    truth.add_log_odds(cell, grid.occupied[static_cast<std::size_t>(cell)] != 0 ? 2.0 : -2.0);
  }
  const std::string stem = fmt::format("{}/{}_{}_{}", out, world, attack, setup.attacks);
  write_map(fmt::format("{}/{}_truth.txt", out, world), truth);
  std::ofstream csv(stem + ".csv");
  csv << "planner,trial,step,entropy_nats\n";
  for (int trial = first_trial; trial < first_trial + trials; ++trial) {
    for (const bool resilient : {false, true}) {
      RoundValues rounds;
      setup.planner = compare ? comparing(resilient, rounds)
                      : resilient
                          ? experiment::MappingTeamPlanner(planner::plan_mapping_resiliently)
                          : experiment::plan_by_coordinate_descent;
      const std::string name = resilient ? "rain" : "descent";
      const std::int64_t begin_ns = monotonic_ns();
      const experiment::MappingOutcome outcome =
          experiment::run_mapping_trial(setup, static_cast<std::uint64_t>(trial));
      for (std::size_t t = 0; t < outcome.steps.size(); ++t) {
        csv << fmt::format("{},{},{},{:.2f}\n", name, trial, t, outcome.steps[t].entropy_nats);
      }
      fmt::print(
          "{} {} {}: {:.0f} {:.0f} {:.0f} nats, {} stops, {} nodes, {} cells, wrong {:.4f}, {:.2f} "
          "s\n",
          stem, trial, name, outcome.steps.front().entropy_nats, outcome.halfway.entropy_nats(),
          outcome.steps.back().entropy_nats, outcome.stopped, outcome.nodes, outcome.beam_cells,
          outcome.wrong_share, 1e-9 * static_cast<double>(monotonic_ns() - begin_ns));
      if (compare) {
        fmt::print(
            "  kept after the worst attack, mean of {} rounds: descent {:.1f} nats, RAIN {:.1f}, "
            "RAIN better in {}\n",
            rounds.rounds, rounds.descent_nats / rounds.rounds, rounds.rain_nats / rounds.rounds,
            rounds.rain_better);
      }
      std::fflush(stdout);
      csv.flush();
      if (trial == first_trial) {
        write_outcome(stem + "_" + name, outcome);
      }
    }
  }
  return 0;
}
