#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "core/cpu_time.hpp"
#include "core/infinity.hpp"
#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/search/search_families.hpp"
#include "experiments/sweep/sample.hpp"
#include "planner/search/catalogue.hpp"

namespace vantage::experiments {
namespace {

using planner::SearchProblem;
using planner::SearchResult;

constexpr int kProblemsPerFamily = 143;  // 1001 problems in seven families
constexpr double kInstructions = 100e6;  // CPU instructions per plan, about 0.03 s
constexpr double kSmokeInstructions = 5e6;
constexpr std::size_t kMemory_bytes = std::size_t{512} << 20U;

// A method and its instructions per node of work in each family, in the order of
// search_families(), measured with callgrind (docs/results/search-or-sampling.md).
struct Method {
  const char* name;
  std::array<double, 7> instructions_per_node;
};
constexpr std::array<Method, 4> kMethods = {{
    {"beam", {1167, 556, 1725, 1848, 1676, 604, 1200}},
    {"arvi", {1753, 649, 1273, 1441, 1311, 813, 740}},
    {"astar", {35493, 8429, 6853, 60922, 29066, 2740, 329385}},
    {"sampling_tree", {6469, 1369, 2046, 9744, 10712, 1743, 35967}},
}};

std::int64_t nodes_of(const Method& method, std::size_t family, double instructions) {
  return std::max<std::int64_t>(1,
                                std::llround(instructions / method.instructions_per_node[family]));
}

bool is_complete(const SearchProblem& problem, const SearchResult& result) {
  return result.found && result.moving_steps == problem.horizon_steps;
}

// Returns the cost of a plan that measures nothing.
double open_loop_cost(const SearchProblem& problem) {
  SearchProblem blind = problem;
  blind.sensors.clear();
  return planner::score(
      blind, std::vector<Pose2>(static_cast<std::size_t>(problem.horizon_steps), problem.start));
}

// Writes the problem so that another implementation can compute the costs of the plans.
void add_problem_rows(const SearchProblem& problem, UnitRows& rows) {
  const models::SensorModel& sensor = problem.sensors.front();
  rows.tables["problems"].push_back(fmt::format(
      "{},{},{},{},{},{},{},{},{},{},{},{:.9f}", problem.targets.size(), problem.horizon_steps,
      problem.step_s, problem.cost == planner::CostKind::kLogDet ? "log_det" : "trace",
      sensor.kind.name(), sensor.range_max_m, sensor.range_min_m, sensor.fov_rad,
      sensor.range_sigma_m, sensor.bearing_sigma_rad, problem.height_m, open_loop_cost(problem)));
  for (const planner::SearchTarget& target : problem.targets) {
    const bool moves = target.model.has_velocity();
    const models::Gaussian& prior = target.prior;
    rows.tables["targets"].push_back(fmt::format(
        "{},{},{},{},{},{},{},{}", target.model.kind.name(), target.model.q, prior.mean(0),
        prior.mean(1), moves ? prior.mean(2) : 0.0, moves ? prior.mean(3) : 0.0,
        prior.covariance(0, 0), moves ? prior.covariance(2, 2) : 0.0));
  }
  if (problem.world != nullptr) {
    for (const models::Obstacle& box : problem.world->obstacles) {
      rows.tables["boxes"].push_back(fmt::format("{},{},{},{}", box.footprint.min_m.x(),
                                                 box.footprint.min_m.y(), box.footprint.max_m.x(),
                                                 box.footprint.max_m.y()));
    }
  }
}

UnitRows run_family(std::size_t family, std::uint64_t seed, double instructions) {
  const planner::OwnedProblem owned = search_families()[family].draw(seed);
  SearchProblem problem = owned.problem;
  problem.seed = seed;
  UnitRows rows;
  for (const char* table : {"plans", "problems", "targets", "boxes", "poses"}) {
    rows.tables[table];
  }
  add_problem_rows(problem, rows);
  for (const Method& method : kMethods) {
    const std::int64_t nodes = nodes_of(method, family, instructions);
    const planner::Algorithm& algorithm = planner::algorithm_called(method.name);
    const auto search = algorithm.make(
        planner::capacity_for(algorithm, problem, kMemory_bytes, static_cast<std::size_t>(nodes)),
        {});
    const double begin_s = thread_cpu_s();
    const SearchResult& result = search->plan(problem, Deadline::nodes(nodes));
    rows.times_s.emplace_back(method.name, thread_cpu_s() - begin_s);
    const bool is_usable = is_complete(problem, result);
    rows.tables["plans"].push_back(fmt::format(
        "{},{},{:.9f},{:.9f},{},{}", method.name, nodes, is_usable ? result.cost : kInfinity,
        result.found ? result.lower_bound : -kInfinity, result.work_nodes,
        result.stop_reason == planner::StopReason::kFinished ? 1 : 0));
    for (std::size_t t = 0; is_usable && t < result.poses.size(); ++t) {
      const Pose2& pose = result.poses[t];
      rows.tables["poses"].push_back(
          fmt::format("{},{},{},{},{}", method.name, t + 1, pose.x_m, pose.y_m, pose.yaw_rad));
    }
  }
  return rows;
}

// Plans of all methods for one problem.
struct ComparedPlans {
  double open_loop = 0.0;
  double bound = -kInfinity;  ///< best of all methods
  double horizon_s = 0.0;
  double targets = 0.0;
  std::map<std::string, double> costs;
};

// Results of one method in one family.
struct Score {
  Sample loss_percent;
  int best = 0;
  int missing = 0;
};

std::map<Unit, ComparedPlans> problems_of(const Tables& tables) {
  std::map<Unit, ComparedPlans> problems;
  for (const Record& record : tables.at("problems")) {
    ComparedPlans& of = problems[record.unit];
    of.targets = record.number(0);
    of.horizon_s = record.number(1) * record.number(2);
    of.open_loop = record.number(11);
  }
  for (const Record& record : tables.at("plans")) {
    ComparedPlans& of = problems[record.unit];
    of.costs[record.cells[0]] = record.number(2);
    of.bound = std::max(of.bound, record.number(3));
  }
  return problems;
}

// Returns the share, in percent, of the certified bound of information that a plan does not gain.
double loss_percent(const ComparedPlans& problem, double cost) {
  return 100.0 * (cost - problem.bound) / (problem.open_loop - problem.bound);
}

// Long function: it writes one table and the data of one figure.
Summary summarise(const Tables& tables) {
  const std::map<Unit, ComparedPlans> problems = problems_of(tables);
  Summary summary;
  std::string& csv = summary.files["summary.csv"];
  std::string& points = summary.files["differences.csv"];
  csv =
      "family,method,problems,loss_percent,loss_ci95,best_percent,missing,"
      "minus_beam_percent,minus_beam_ci95\n";
  points = "family,horizon_s,targets,sampling_minus_beam_percent\n";
  for (std::size_t family = 0; family < search_families().size(); ++family) {
    std::map<std::string, Score> scores;
    std::map<std::string, Sample> minus_beam;
    int count = 0;
    for (const auto& [unit, problem] : problems) {
      const auto lowest =
          std::min_element(problem.costs.begin(), problem.costs.end(),
                           [](const auto& a, const auto& b) { return a.second < b.second; });
      if (unit.setting != family || lowest == problem.costs.end() ||
          !std::isfinite(lowest->second) || !std::isfinite(problem.bound) ||
          problem.open_loop - problem.bound < 1e-9) {
        continue;  // no plan is feasible, or nothing can be measured
      }
      ++count;
      const double beam = problem.costs.at("beam");
      for (const auto& [method, cost] : problem.costs) {
        Score& score = scores[method];
        if (!std::isfinite(cost)) {
          ++score.missing;
          continue;
        }
        score.loss_percent.add(loss_percent(problem, cost));
        score.best += cost <= lowest->second + 1e-6 ? 1 : 0;
        if (std::isfinite(beam)) {
          minus_beam[method].add(loss_percent(problem, cost) - loss_percent(problem, beam));
        }
      }
      const double tree = problem.costs.at("sampling_tree");
      if (std::isfinite(tree) && std::isfinite(beam)) {
        points += fmt::format("{},{:g},{:g},{:.6f}\n", family, problem.horizon_s, problem.targets,
                              loss_percent(problem, tree) - loss_percent(problem, beam));
      }
    }
    for (const Method& method : kMethods) {
      const Score& score = scores[method.name];
      const double best_percent = count > 0 ? 100.0 * score.best / count : 0.0;
      const double loss = score.loss_percent.size() > 0 ? score.loss_percent.mean()
                                                        : std::numeric_limits<double>::quiet_NaN();
      csv += fmt::format("{},{},{},{:.4f},{:.4f},{:.2f},{},{:.4f},{:.4f}\n",
                         search_families()[family].name, method.name, count, loss,
                         score.loss_percent.half_interval(), best_percent, score.missing,
                         minus_beam[method.name].mean(), minus_beam[method.name].half_interval());
      summary.lines.push_back(fmt::format(
          "{:16} {:14} {:4} problems, loss {:6.2f} ± {:.2f} %, best in {:5.1f} %, minus beam "
          "{:+.2f} ± {:.2f}, {} without plan",
          search_families()[family].name, method.name, count, loss,
          score.loss_percent.half_interval(), best_percent, minus_beam[method.name].mean(),
          minus_beam[method.name].half_interval(), score.missing));
    }
  }
  summary.figure_script = search_or_sampling_figure();
  summary.figures = {"search-or-sampling"};
  summary.choices = {
      "This experiment is not in the dissertation, which leaves open which problems suit search "
      "and which suit sampling.",
      "The loss of a plan is (cost − bound) / (open-loop cost − bound), with the best certified "
      "bound of all methods.",
      fmt::format("Every plan gets {:.0f} million instructions, converted to nodes by the "
                  "method's instructions per node in the family.",
                  kInstructions / 1e6)};
  return summary;
}

}  // namespace

Sweep search_or_sampling(const Extent& extent) {
  const double instructions = extent.is_smoke ? kSmokeInstructions : kInstructions;
  Sweep sweep;
  sweep.plan.setting_columns = "family";
  for (std::size_t family = 0; family < search_families().size(); ++family) {
    Setting setting;
    setting.cells = search_families()[family].name;
    sweep.plan.settings.push_back(setting);
    for (const Method& method : kMethods) {
      sweep.plan
          .parameters[fmt::format("{}_nodes_{}", method.name, search_families()[family].name)] =
          std::to_string(nodes_of(method, family, instructions));
    }
  }
  sweep.plan.trials = extent.trials_or(kProblemsPerFamily);
  sweep.plan.tables = {
      {"plans", "method,nodes,cost,lower_bound,work_nodes,is_finished"},
      {"problems",
       "targets,horizon_steps,step_s,cost,sensor,range_max_m,range_min_m,fov_rad,range_sigma_m,"
       "bearing_sigma_rad,height_m,open_loop_cost"},
      {"targets", "kind,q,x_m,y_m,vx_mps,vy_mps,position_variance_m2,velocity_variance_m2ps2"},
      {"boxes", "x_min_m,y_min_m,x_max_m,y_max_m"},
      {"poses", "method,step,x_m,y_m,yaw_rad"}};
  sweep.run = [instructions](std::size_t setting, std::uint64_t seed) {
    return run_family(setting, seed, instructions);
  };
  sweep.summarise = summarise;
  return sweep;
}

}  // namespace vantage::experiments
