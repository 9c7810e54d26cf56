#include <algorithm>
#include <cstdint>
#include <ctime>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "planner/search/catalogue.hpp"
#include "test/bench/field_problem.hpp"
#include "test/bench/tracking_family.hpp"

// Measures the time between two clock checks of a search. This time is the search's largest
// possible lateness while its thread is not preempted. With a budget of nodes a search does the
// same work every time, so each stretch between two checks is timed in several runs and its
// shortest time counts. This excludes time lost by preemption or a hypervisor, unlike
// deadline_bench, which measures lateness itself.

namespace vantage {
namespace bench {
namespace {

/// Records the time between clock checks of the timed run.
class ClockChecks {
 public:
  void begin() {
    stretches_ns_.clear();
    last_ns_ = now_ns();
  }
  std::int64_t check() {
    const std::int64_t now = now_ns();
    stretches_ns_.push_back(now - last_ns_);
    last_ns_ = now_ns();
    return now;
  }
  [[nodiscard]] const std::vector<std::int64_t>& stretches_ns() const { return stretches_ns_; }

 private:
  static std::int64_t now_ns() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1'000'000'000 * static_cast<std::int64_t>(now.tv_sec) + now.tv_nsec;
  }
  std::vector<std::int64_t> stretches_ns_;
  std::int64_t last_ns_ = 0;
};

ClockChecks& clock_checks() {
  static ClockChecks of_this_program;
  return of_this_program;
}

struct Arguments {
  std::vector<std::string> algorithms = {"beam", "arvi", "astar", "aegis"};
  std::int64_t nodes = 100'000;
  int runs = 5;
  double list_us = 1e9;
};

/// Returns the duration of each stretch of a search of `problem`, ns: the shortest of `runs` runs.
/// The last stretch ends at the search's return. Empty if the number of checks differs between
/// runs.
std::vector<std::int64_t> stretches_of(planner::Search& search,
                                       const planner::SearchProblem& problem,
                                       const Arguments& arguments) {
  const auto deadline =
      Deadline::either(arguments.nodes, std::numeric_limits<std::int64_t>::max() - 1);
  std::vector<std::int64_t> shortest;
  for (int run = 0; run < arguments.runs; ++run) {
    clock_checks().begin();
    search.plan(problem, deadline);
    clock_checks().check();
    const std::vector<std::int64_t>& these = clock_checks().stretches_ns();
    if (run == 0) {
      shortest = these;
    } else if (these.size() != shortest.size()) {
      return {};
    }
    for (std::size_t i = 0; i < these.size(); ++i) {
      shortest[i] = std::min(shortest[i], these[i]);
    }
  }
  return shortest;
}

struct Stretches {
  std::vector<std::int64_t> set_up_ns;   ///< ns; until the first check
  std::vector<std::int64_t> between_ns;  ///< ns; between two checks
  std::vector<std::int64_t> closing_ns;  ///< ns; from the last check to the return
};

double us_at(std::vector<std::int64_t>& ns, double share) {
  std::sort(ns.begin(), ns.end());
  return ns.empty()
             ? 0.0
             : 1e-3 * static_cast<double>(
                          ns[static_cast<std::size_t>(share * static_cast<double>(ns.size() - 1))]);
}

void print(const std::string& name, Stretches& all) {
  const double set_up_us = us_at(all.set_up_ns, 1.0);
  const double closing_us = us_at(all.closing_ns, 1.0);
  const double longest_us = us_at(all.between_ns, 1.0);
  fmt::print(
      "{:>8} {:>10} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8} | {:>10.1f} {:>10.1f}\n", name,
      all.between_ns.size(), us_at(all.between_ns, 0.5), us_at(all.between_ns, 0.99),
      us_at(all.between_ns, 0.999), longest_us,
      all.between_ns.end() - std::upper_bound(all.between_ns.begin(), all.between_ns.end(), 20'000),
      closing_us, set_up_us);
  std::fflush(stdout);
}

void run(const Arguments& arguments) {
  const std::vector<tools::PlanningProblem> tracking = hundred_problems();
  std::vector<planner::OwnedProblem> obstructed;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    obstructed.push_back(obstructed_problem(25, 12, seed % 2 == 0 ? 20 : 60, seed));
  }
  std::vector<const planner::SearchProblem*> problems;
  for (const tools::PlanningProblem& drawn : tracking) {
    problems.push_back(&drawn.problem);
  }
  for (const planner::OwnedProblem& drawn : obstructed) {
    problems.push_back(&drawn.problem);
  }
  fmt::print("{:>8} {:>10} {:>8} {:>8} {:>8} {:>8} {:>8} | {:>10} {:>10}\n", "search", "stretches",
             "p50_us", "p99", "p99.9", "max", "> 20 us", "closing", "set-up");
  for (const std::string& name : arguments.algorithms) {
    const planner::Algorithm& algorithm = planner::algorithm_called(name);
    const auto search = algorithm.make(
        planner::capacity_for(algorithm, tracking.back().problem, std::size_t{600} << 20U,
                              static_cast<std::size_t>(2 * arguments.nodes)),
        {});
    Stretches all;
    for (const planner::SearchProblem* problem : problems) {
      const std::vector<std::int64_t> these = stretches_of(*search, *problem, arguments);
      if (these.size() < 2) {
        fmt::print("{}: not the same work twice\n", name);
        continue;
      }
      for (std::size_t i = 1; i + 1 < these.size(); ++i) {
        if (static_cast<double>(these[i]) > 1e3 * arguments.list_us) {
          fmt::print("{}: problem {}, {} targets: look {} of {} after {:.1f} us\n", name,
                     all.set_up_ns.size(), problem->targets.size(), i, these.size(),
                     1e-3 * static_cast<double>(these[i]));
        }
      }
      all.set_up_ns.push_back(these.front());
      all.between_ns.insert(all.between_ns.end(), these.begin() + 1, these.end() - 1);
      all.closing_ns.push_back(these.back());
    }
    print(name, all);
  }
}

}  // namespace
}  // namespace bench

// Clock that searches check. Replaces the function in core/deadline.cpp, which is not linked here.
std::int64_t monotonic_ns() { return bench::clock_checks().check(); }

}  // namespace vantage

int main(int argc, char** argv) {
  vantage::bench::Arguments arguments;
  CLI::App app{"The longest stretches of work between two looks at the clock."};
  try {
    app.add_option("--algorithms", arguments.algorithms, "of `vantage plan`")->delimiter(',');
    app.add_option("--nodes", arguments.nodes, "budget of a search")->capture_default_str();
    app.add_option("--list-us", arguments.list_us, "list the stretches that are longer");
    app.add_option("--runs", arguments.runs, "of which each stretch's shortest time counts")
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    vantage::bench::run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "stretch_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
