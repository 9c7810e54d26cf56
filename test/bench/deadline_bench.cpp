#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <exception>
#include <optional>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "core/cpu_time.hpp"
#include "core/real_time.hpp"
#include "planner/search/catalogue.hpp"
#include "test/bench/field_problem.hpp"
#include "test/bench/tracking_family.hpp"

// Measures, for many plans at each budget, how long the search continues after its deadline and how
// late it returns in wall time. If wall time and CPU time of a plan agree, the thread was not
// preempted, and its lateness is its work after the deadline. Preempted plans are counted
// separately, since their work after the deadline is unknown. With --timer, a signal reads the
// thread's CPU clock at the deadline, so that every plan is measured. The signal takes about 50 µs
// and hides lateness of this size. At the end, a thread that only reads the clock measures the
// lateness that the machine causes.

namespace vantage::bench {
namespace {

struct Arguments {
  std::vector<double> budgets_ms = {1.0, 5.0, 20.0, 100.0, 500.0};
  std::string algorithm = "beam";
  std::size_t short_runs = 10'000;  // number of runs for budgets up to 20 ms
  std::size_t long_runs = 1'000;
  std::size_t memory_mb = 600;
  bool uses_timer = false;
  bool has_tour = false;
  RealTime real_time;
};

// Least excess of wall time over CPU time of a preempted plan.
constexpr std::int64_t kPreempted_ns = 5'000;

std::atomic<std::int64_t> cpu_at_deadline_ns{0};

void on_deadline(int) { cpu_at_deadline_ns.store(thread_cpu_ns(), std::memory_order_relaxed); }

class DeadlineTimer {
 public:
  DeadlineTimer() {
    struct sigaction action {};
    action.sa_handler = on_deadline;
    sigaction(SIGRTMIN, &action, nullptr);
    sigevent event{};
    event.sigev_notify = SIGEV_THREAD_ID;
    event.sigev_signo = SIGRTMIN;
    event._sigev_un._tid = static_cast<pid_t>(syscall(SYS_gettid));
    timer_create(CLOCK_MONOTONIC, &event, &timer_);
  }
  ~DeadlineTimer() { timer_delete(timer_); }
  DeadlineTimer(const DeadlineTimer&) = delete;
  DeadlineTimer& operator=(const DeadlineTimer&) = delete;
  void set(std::int64_t instant_ns) {
    cpu_at_deadline_ns.store(0, std::memory_order_relaxed);
    itimerspec when{};
    when.it_value.tv_sec = instant_ns / 1'000'000'000;
    when.it_value.tv_nsec = instant_ns % 1'000'000'000;
    timer_settime(timer_, TIMER_ABSTIME, &when, nullptr);
  }
  void stop() {
    const itimerspec never{};
    timer_settime(timer_, 0, &never, nullptr);
  }

 private:
  timer_t timer_{};
};

struct Spread {
  std::vector<double> us;
  [[nodiscard]] double at(double share) const {
    return us.empty()
               ? 0.0
               : us[static_cast<std::size_t>(share * (static_cast<double>(us.size()) - 1.0))];
  }
};

// Returns tracking problems of every size, and some with boxes.
std::vector<planner::SearchProblem> problems_of(
    const std::vector<tools::PlanningProblem>& tracking,
    const std::vector<planner::OwnedProblem>& obstructed) {
  std::vector<planner::SearchProblem> problems;
  for (const tools::PlanningProblem& drawn : tracking) {
    problems.push_back(drawn.problem);
  }
  for (const planner::OwnedProblem& drawn : obstructed) {
    problems.push_back(drawn.problem);
  }
  return problems;
}

struct Outcome {
  bool is_missing = false;
  bool ended_at_deadline = true;
};

struct Lateness {
  std::size_t missing = 0;
  std::size_t early = 0;
  std::size_t preempted = 0;
  Spread cpu;  ///< CPU time of plans that were not preempted
  Spread wall;
};

/// Calls `work(i, end_ns)` once per run; `work` must return at end_ns. Sleeps a tenth of the budget
/// before each run, as a planner does between rounds: the kernel stops a FIFO thread that never
/// sleeps for 50 ms of every second (sched_rt_runtime_us).
template <class Work>
Lateness lateness_of(std::size_t runs, double budget_ms, DeadlineTimer* timer, const Work& work) {
  Lateness out;
  for (std::size_t i = 0; i < runs; ++i) {
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(0.1 * budget_ms));
    const std::int64_t begin_cpu_ns = thread_cpu_ns();
    const std::int64_t begin_ns = monotonic_ns();
    const std::int64_t end_ns = begin_ns + std::llround(1e6 * budget_ms);
    if (timer != nullptr) {
      timer->set(end_ns);
    }
    const Outcome outcome = work(i, end_ns);
    const std::int64_t now_ns = monotonic_ns();
    const std::int64_t cpu_ns = thread_cpu_ns();
    out.missing += outcome.is_missing ? 1 : 0;
    if (now_ns < end_ns || !outcome.ended_at_deadline) {
      ++out.early;
      continue;
    }
    out.wall.us.push_back(1e-3 * static_cast<double>(now_ns - end_ns));
    const bool was_preempted = now_ns - begin_ns - (cpu_ns - begin_cpu_ns) > kPreempted_ns;
    out.preempted += was_preempted ? 1 : 0;
    if (timer != nullptr) {
      timer->stop();
      // If the signal came after the return, no CPU time was used after the deadline.
      const std::int64_t then_ns = cpu_at_deadline_ns.load(std::memory_order_relaxed);
      const bool came_late = then_ns == 0 || then_ns > cpu_ns;
      out.cpu.us.push_back(came_late ? 0.0 : 1e-3 * static_cast<double>(cpu_ns - then_ns));
    } else if (!was_preempted) {
      out.cpu.us.push_back(out.wall.us.back());
    }
  }
  std::sort(out.cpu.us.begin(), out.cpu.us.end());
  std::sort(out.wall.us.begin(), out.wall.us.end());
  return out;
}

void print(double budget_ms, const std::string& what, const Lateness& late) {
  const auto over =
      std::count_if(late.cpu.us.begin(), late.cpu.us.end(), [](double us) { return us > 50.0; });
  fmt::print(
      "{:>9} {:>6} {:>7} {:>7} {:>6} {:>9} | {:>7.1f} {:>7.1f} {:>7.1f} {:>8.1f} {:>6} | {:>9.1f} "
      "{:>9.1f} {:>9.1f} {:>9.1f}\n",
      budget_ms, what, late.wall.us.size() + late.early, late.missing, late.early, late.preempted,
      late.cpu.at(0.5), late.cpu.at(0.99), late.cpu.at(0.999), late.cpu.at(1.0), over,
      late.wall.at(0.5), late.wall.at(0.99), late.wall.at(0.999), late.wall.at(1.0));
  std::fflush(stdout);
}

// Reads the clock until the deadline and does nothing else, which measures the machine alone. The
// causes of its lateness are the timer's signal, interrupts charged to the thread, and time taken
// by a hypervisor.
Outcome idle_until(std::int64_t end_ns) {
  while (monotonic_ns() < end_ns) {
  }
  return {};
}

void run(const Arguments& arguments) {
  const std::vector<tools::PlanningProblem> tracking = hundred_problems();
  std::vector<planner::OwnedProblem> obstructed;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    obstructed.push_back(obstructed_problem(25, 12, seed % 2 == 0 ? 20 : 60, seed));
  }
  std::vector<planner::SearchProblem> problems = problems_of(tracking, obstructed);
  if (arguments.has_tour) {
    std::for_each(problems.begin(), problems.end(), add_tour);
  }
  const planner::Algorithm& algorithm = planner::algorithm_called(arguments.algorithm);
  const std::unique_ptr<planner::Search> search = algorithm.make(
      planner::capacity_for(algorithm, tracking.back().problem, arguments.memory_mb << 20,
                            planner::nodes_within(1e-3 * arguments.budgets_ms.back())),
      {});
  apply(arguments.real_time);
  fmt::print(
      "{:>9} {:>6} {:>7} {:>7} {:>6} {:>9} | {:>7} {:>7} {:>7} {:>8} {:>6} | {:>9} {:>9} {:>9} "
      "{:>9}\n",
      "budget_ms", "what", "plans", "missing", "early", "preempted", "cpu p50", "p99", "p99.9",
      "max_us", "> 50", "wall p50", "p99", "p99.9", "max_us");
  std::optional<DeadlineTimer> timer_if_used;
  DeadlineTimer* timer = arguments.uses_timer ? &timer_if_used.emplace() : nullptr;
  for (const double budget_ms : arguments.budgets_ms) {
    const std::size_t runs = budget_ms <= 20.0 ? arguments.short_runs : arguments.long_runs;
    print(budget_ms, arguments.algorithm,
          lateness_of(runs, budget_ms, timer, [&](std::size_t i, std::int64_t end_ns) {
            const planner::SearchProblem& problem = problems[i % problems.size()];
            const planner::SearchResult& result = search->plan(problem, Deadline::at(end_ns));
            return Outcome{!result.found, result.stop_reason == planner::StopReason::kDeadline};
          }));
  }
  const double shortest_ms = arguments.budgets_ms.front();
  print(shortest_ms, "none",
        lateness_of(3 * arguments.short_runs, shortest_ms, timer,
                    [](std::size_t, std::int64_t end_ns) { return idle_until(end_ns); }));
}

}  // namespace
}  // namespace vantage::bench

int main(int argc, char** argv) {
  vantage::bench::Arguments arguments;
  CLI::App app{"Work and lateness after the deadline; run it idle and beside stress-ng."};
  try {
    arguments.real_time = vantage::take_real_time(argc, argv);
    app.footer("Also --fifo PRIORITY, --cpu N and --lock-memory, as vantage-planner has them.");
    app.add_option("--budgets-ms", arguments.budgets_ms, "ascending")->delimiter(',');
    app.add_option("--algorithm", arguments.algorithm, "of `vantage plan`")->capture_default_str();
    app.add_option("--short-runs", arguments.short_runs, "plans a budget up to 20 ms")
        ->capture_default_str();
    app.add_flag("--timer", arguments.uses_timer, "read the CPU clock at the deadline by a signal");
    app.add_flag("--tour", arguments.has_tour, "add the terminal value of a tour to each problem");
    app.add_option("--long-runs", arguments.long_runs, "plans a longer budget")
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    vantage::bench::run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "deadline_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
