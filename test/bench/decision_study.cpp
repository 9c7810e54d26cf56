// Compares the team's decisions with the exhaustive optimum on small random teams, for both
// measures of information. Prints one CSV line per decision, and one line per method on the
// terminal.
#include <algorithm>
#include <cstdint>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "planner/decision/attack.hpp"
#include "planner/decision/coordinate_descent.hpp"
#include "planner/decision/distributed_local_search.hpp"
#include "planner/decision/exhaustive.hpp"
#include "planner/decision/local_search.hpp"
#include "planner/decision/resilient.hpp"
#include "planner/decision/team_set.hpp"
#include "test/planner/decision/team_instance.hpp"

namespace vantage {
namespace {

using planner::InformationMeasure;

// All ratios of one method under one measure.
struct Ratios {
  std::string measure;
  std::string method;
  std::vector<double> ratios;
};

class RatioTable {
 public:
  explicit RatioTable(const std::string& path) : csv_(path) {
    csv_ << "measure,method,seed,ratio\n";
  }

  void add(InformationMeasure measure, const std::string& method, std::uint64_t seed, double value,
           double best) {
    constexpr double kNothing_nats = 1e-9;  // nats; no ratio is computed for smaller best values
    if (best < kNothing_nats) {
      return;
    }
    const std::string name = measure == InformationMeasure::kMutual ? "mutual" : "logdet";
    csv_ << fmt::format("{},{},{},{:.9f}\n", name, method, seed, value / best);
    const auto same = std::find_if(table_.begin(), table_.end(), [&](const Ratios& row) {
      return row.measure == name && row.method == method;
    });
    Ratios& row = same != table_.end()
                      ? *same
                      : table_.emplace_back(Ratios{name, method, std::vector<double>{}});
    row.ratios.push_back(value / best);
  }

  void print() {
    constexpr double kRounding = 1e-9;
    fmt::print("measure  method        instances  least   p5      mean    at the optimum\n");
    for (Ratios& row : table_) {
      std::sort(row.ratios.begin(), row.ratios.end());
      const std::size_t n = row.ratios.size();
      const double sum = std::accumulate(row.ratios.begin(), row.ratios.end(), 0.0);
      const auto optimal = std::count_if(row.ratios.begin(), row.ratios.end(),
                                         [](double ratio) { return ratio > 1.0 - kRounding; });
      fmt::print("{:8} {:14} {:8}  {:.4f}  {:.4f}  {:.4f}  {:.3f}\n", row.measure, row.method, n,
                 row.ratios.front(), row.ratios[n / 20], sum / static_cast<double>(n),
                 static_cast<double>(optimal) / static_cast<double>(n));
    }
  }

 private:
  std::ofstream csv_;
  std::vector<Ratios> table_;
};

void compare_choices(const planner::TeamOracle& oracle, InformationMeasure measure,
                     std::uint64_t seed, RatioTable& table) {
  std::vector<int> everybody(static_cast<std::size_t>(oracle.robot_count()));
  std::iota(everybody.begin(), everybody.end(), 0);
  const double best = planner::exhaustive_optimum(oracle, everybody).value;
  const double alpha = 1.0;
  const auto note = [&](const char* method, const planner::TeamDecision& decision) {
    table.add(measure, method, seed, decision.value, best);
  };
  note("greedy", planner::greedy(oracle));
  note("CD", planner::coordinate_descent(oracle, {{}, 1, true}));
  note("CLS", planner::centralised_local_search(oracle, alpha, Deadline::never()));
  note("DLS", planner::distributed_local_search(oracle, {alpha, true, true}, Deadline::never()));
}

void compare_resilience(const planner::TeamOracle& oracle, InformationMeasure measure,
                        std::uint64_t seed, RatioTable& table) {
  using planner::SubSolver;
  for (const int attacks : {1, 2}) {
    if (attacks >= oracle.robot_count()) {
      continue;  // an attack could remove all plans
    }
    const double best = planner::exhaustive_max_min(oracle, attacks).value;
    const auto note = [&](const std::string& method, int planned_for) {
      const planner::Choice choice =
          planner::plan_resiliently(oracle, planned_for, SubSolver::kCoordinateDescent).choice;
      table.add(measure, fmt::format("{} {}", method, attacks), seed,
                planner::worst_attack(oracle, choice, attacks).value, best);
    };
    note("RTP", attacks);
    note("CD attacked", 0);
  }
}

}  // namespace
}  // namespace vantage

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): a program
  std::uint64_t instances = 600;
  std::string out = ".";
  CLI::App app("Observed approximation ratios of team decisions: decision_ratios.csv");
  app.add_option("--instances", instances, "seeds 0 …");
  app.add_option("--out", out, "folder");
  CLI11_PARSE(app, argc, argv);

  RatioTable table(out + "/decision_ratios.csv");
  for (const InformationMeasure measure :
       {InformationMeasure::kMutual, InformationMeasure::kLogDet}) {
    for (std::uint64_t seed = 0; seed < instances; ++seed) {
      const planner::TeamProblem problem = test::random_instance(seed, {4, 4, 0.0}, measure);
      const planner::TeamOracle oracle(problem);
      compare_choices(oracle, measure, seed, table);
      compare_resilience(oracle, measure, seed, table);
    }
  }
  table.print();
  return 0;
}
