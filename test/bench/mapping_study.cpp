#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/check.hpp"
#include "planner/search/astar.hpp"
#include "test/bench/search_tree_data.hpp"
#include "test/bench/study_run.hpp"
#include "test/planner/mapping_problem.hpp"

// Active mapping (dissertation ch. 2 H): A*, ARVI and AEGIS from a hundred free starts, and the
// data of the heat map of the heuristic and of the pictures of the search trees.

namespace vantage::bench {
namespace {

using planner::BestFirstSearch;
using planner::ReducedValueIteration;
using planner::SearchProblem;
using planner::SearchResult;
using planner::Tree;

constexpr double kAegisEpsilon = 1.0;  // as in Fig. 2.5
constexpr double kAegisDelta_m = 0.1;

struct Arguments {
  std::size_t starts = 100;
  std::vector<double> budgets_s = {0.01, 0.1};
  std::string out = "build/mapping_study";
};

struct Searches {
  BestFirstSearch best_first{{1'500'000, 20'000'000, 16, 16, 1}};
  ReducedValueIteration reduced{{4'000'000, 60'000'000, 16, 16, 1}};
};

planner::BestFirstOptions aegis() {
  planner::BestFirstOptions options;
  options.search = planner::BestFirst::kAegis;
  options.epsilon = kAegisEpsilon;
  options.delta_m = kAegisDelta_m;
  return options;
}

std::vector<StudyMethod> methods_of(Searches& searches) {
  return {
      {"astar",
       [&](const SearchProblem& problem, const Deadline& deadline) -> const SearchResult& {
         return searches.best_first.plan(problem, {}, deadline);
       }},
      {"arvi",
       [&](const SearchProblem& problem, const Deadline& deadline) -> const SearchResult& {
         return searches.reduced.plan(problem, {}, deadline);
       }},
      {"aegis", [&](const SearchProblem& problem, const Deadline& deadline) -> const SearchResult& {
         return searches.best_first.plan(problem, aegis(), deadline);
       }}};
}

int seen_by(const SearchProblem& problem, const std::vector<Pose2>& poses) {
  int seen = 0;
  for (const planner::SearchTarget& target : problem.targets) {
    const Eigen::Vector2d at_m = target.prior.mean.head<2>();
    seen +=
        std::any_of(poses.begin(), poses.end(),
                    [&](const Pose2& pose) {
                      return (pose.position_m() - at_m).norm() < problem.sensors[0].range_max_m &&
                             models::line_of_sight(*problem.world, pose.position_m(), at_m);
                    })
            ? 1
            : 0;
  }
  return seen;
}

// J_T by a scorer that adds `extra_m` to the range in the Jacobian, as the public problems' does.
double score_with(const SearchProblem& problem, const std::vector<Pose2>& poses, double extra_m) {
  double cost = 0.0;
  for (const planner::SearchTarget& target : problem.targets) {
    Eigen::Matrix2d information = target.prior.covariance.inverse();
    const Eigen::Vector2d at_m = target.prior.mean.head<2>();
    for (const Pose2& pose : poses) {
      const Eigen::Vector2d d_m = at_m - pose.position_m();
      if (d_m.norm() < problem.sensors[0].range_max_m &&
          models::line_of_sight(*problem.world, pose.position_m(), at_m)) {
        const Eigen::Vector2d h = d_m / (d_m.norm() + extra_m);
        information += h * h.transpose() / std::pow(problem.sensors[0].range_sigma_m, 2);
      }
      cost += information.inverse().trace();
    }
  }
  return cost;
}

struct Sum {
  int count = 0;
  int proven = 0;
  int complete = 0;
  double cost = 0.0;
  double gap = 0.0;
  double per_path = 0.0;
  double seen = 0.0;
  double cpu_s = 0.0;
  double cpu_max_s = 0.0;
};

void study_starts(const Arguments& arguments, Searches& searches) {
  std::ofstream file(arguments.out + "/starts.csv");
  file << "start,x_m,y_m,yaw_rad,method,budget_s,cost,lower_bound,cost_per_path,seen,cpu_s\n";
  std::vector<std::pair<std::string, Sum>> sums;
  for (const StudyMethod& method : methods_of(searches)) {
    for (const double budget_s : arguments.budgets_s) {
      Sum sum;
      double nodes_per_s = 1e6;
      for (std::size_t seed = 0; seed < arguments.starts; ++seed) {
        test::OwnedProblem owned = test::random_mapping_problem(seed);
        tools::PlanningProblem drawn{std::to_string(seed), std::move(owned.world),
                                     std::move(owned.field), owned.problem};
        const StudyRun run = run_within(drawn, method, budget_s, nodes_per_s);
        const Tree& tree =
            method.name == "arvi" ? searches.reduced.tree() : searches.best_first.tree();
        std::vector<Pose2> poses;
        Pose2 pose = drawn.problem.start;
        for (const int control : run.controls) {
          pose =
              models::step_unicycle(pose, drawn.problem.controls[static_cast<std::size_t>(control)],
                                    drawn.problem.step_s);
          poses.push_back(pose);
        }
        const int seen = seen_by(drawn.problem, poses);
        const double per_path = cost_per_path(tree, drawn.problem.horizon_steps);
        const Pose2& start = drawn.problem.start;
        file << fmt::format("{},{:.4f},{:.4f},{:.4f},{},{},{:.6f},{:.6f},{:.6f},{},{:.6f}\n", seed,
                            start.x_m, start.y_m, start.yaw_rad, method.name, budget_s, run.cost,
                            run.lower_bound, per_path, seen, run.cpu_s);
        ++sum.count;
        if (!std::isfinite(run.cost)) {
          continue;
        }
        ++sum.complete;
        sum.proven += run.lower_bound >= run.cost ? 1 : 0;
        sum.cost += run.cost;
        sum.gap += run.cost - run.lower_bound;
        sum.per_path += per_path;
        sum.seen += seen;
        sum.cpu_s += run.cpu_s;
        sum.cpu_max_s = std::max(sum.cpu_max_s, run.cpu_s);
      }
      sums.emplace_back(fmt::format("{:8} {:>8}", method.name, budget_s), sum);
    }
  }
  fmt::print("{:8} {:>8} {:>9} {:>7} {:>10} {:>10} {:>14} {:>6} {:>9} {:>9}\n", "", "budget_s",
             "complete", "proven", "mean cost", "mean gap", "cost per path", "seen", "cpu_s",
             "max cpu_s");
  for (const auto& [name, sum] : sums) {
    const double n = std::max(1, sum.complete);
    fmt::print("{} {:>9} {:>7} {:>10.4f} {:>10.4f} {:>14.4f} {:>6.2f} {:>9.4f} {:>9.4f}\n", name,
               sum.complete, sum.proven, sum.cost / n, sum.gap / n, sum.per_path / n, sum.seen / n,
               sum.cpu_s / n, sum.cpu_max_s);
  }
}

// Fig. 2.2 and 2.3: the problem whose optimum is known.
void draw_known(const Arguments& arguments, Searches& searches) {
  constexpr std::size_t kNodesDrawn = 60'000;
  constexpr std::int64_t kArviNodes = 4'000'000;
  const test::OwnedProblem known = test::known_mapping_problem();
  const SearchProblem& problem = known.problem;
  write_heat_map(arguments.out + "/heat_map.txt", problem, 0.05);
  for (const bool is_aegis : {false, true}) {
    const SearchResult result = searches.best_first.plan(
        problem, is_aegis ? aegis() : planner::BestFirstOptions{}, Deadline::never());
    const std::string name = is_aegis ? "aegis" : "astar";
    write_tree(arguments.out + "/tree_" + name + ".txt", problem, searches.best_first.tree(),
               result, kNodesDrawn);
    fmt::print(
        "known start, {}: cost {:.6f}, bound {:.6f}, {} seen, {} expanded, {} nodes; with 1 "
        "mm added to the range in the Jacobian {:.6f}\n",
        name, result.cost, result.lower_bound, seen_by(problem, result.poses),
        result.nodes_expanded, searches.best_first.tree().node_count(),
        score_with(problem, result.poses, 0.001));
  }
  const SearchResult result = searches.reduced.plan(problem, {}, Deadline::nodes(kArviNodes));
  write_tree(arguments.out + "/tree_arvi.txt", problem, searches.reduced.tree(), result,
             kNodesDrawn);
  fmt::print("known start, arvi after {} nodes of work: cost {:.6f}, {} seen, {} nodes\n",
             kArviNodes, result.cost, seen_by(problem, result.poses),
             searches.reduced.tree().node_count());
}

// Fig. 2.5: one target that moves, a range sensor, no obstacles.
void draw_tracking(const Arguments& arguments, Searches& searches) {
  constexpr std::size_t kNodesDrawn = 60'000;
  test::OwnedProblem owned = test::mapping_problem({2.0, 2.0, 0.8});
  owned.world->obstacles.clear();
  *owned.field = models::DistanceField(*owned.world, 0.05);
  SearchProblem& problem = owned.problem;
  problem.horizon_steps = 6;
  problem.sensors[0].range_max_m = 2.0;
  problem.targets.resize(1);
  problem.targets[0].model = {models::TargetKind::kDoubleIntegrator, 2, 0.001};
  problem.targets[0].prior.mean = Eigen::Vector4d(6.5, 6.0, 0.2, -0.2);
  problem.targets[0].prior.covariance = Eigen::Vector4d(0.25, 0.25, 0.05, 0.05).asDiagonal();
  const auto say = [](const char* name, const SearchResult& result, const Tree& tree) {
    fmt::print("tracking, {}: cost {:.6f}, bound {:.6f}, {} expanded, {} nodes\n", name,
               result.cost, result.lower_bound, result.nodes_expanded, tree.node_count());
  };
  planner::ReducedOptions rvi;
  rvi.search = planner::ReducedSearch::kSinglePass;
  rvi.epsilon = kAegisEpsilon;
  rvi.delta_m = kAegisDelta_m;
  const SearchResult reduced = searches.reduced.plan(problem, rvi, Deadline::never());
  write_tree(arguments.out + "/tracking_rvi.txt", problem, searches.reduced.tree(), reduced,
             kNodesDrawn);
  say("rvi", reduced, searches.reduced.tree());
  for (const bool is_aegis : {false, true}) {
    const SearchResult result = searches.best_first.plan(
        problem, is_aegis ? aegis() : planner::BestFirstOptions{}, Deadline::nodes(20'000'000));
    const std::string name = is_aegis ? "aegis" : "astar";
    write_tree(arguments.out + "/tracking_" + name + ".txt", problem, searches.best_first.tree(),
               result, kNodesDrawn);
    say(name.c_str(), result, searches.best_first.tree());
  }
}

}  // namespace
}  // namespace vantage::bench

int main(int argc, char** argv) {
  vantage::bench::Arguments arguments;
  CLI::App app{"Active mapping from many starts, and the data of its pictures."};
  app.add_option("--starts", arguments.starts, "how many free starts")->capture_default_str();
  app.add_option("--budgets-s", arguments.budgets_s, "CPU seconds")->delimiter(',');
  app.add_option("--out", arguments.out, "folder for the data")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    std::filesystem::create_directories(arguments.out);
    vantage::bench::Searches searches;
    vantage::bench::draw_known(arguments, searches);
    vantage::bench::draw_tracking(arguments, searches);
    vantage::bench::study_starts(arguments, searches);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mapping_study: {}\n", error.what());
    return 2;
  }
  return 0;
}
