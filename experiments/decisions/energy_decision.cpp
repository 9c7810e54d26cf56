#include "experiments/decisions/energy_decision.hpp"

#include <algorithm>
#include <memory>
#include <numeric>

#include "core/cpu_time.hpp"
#include "planner/decision/coordinate_descent.hpp"
#include "planner/decision/distributed_local_search.hpp"

namespace vantage::experiments {
namespace {

using planner::TeamDecision;
using planner::TeamOracle;

const planner::SearchCapacity kCapacity{2'000'000, 60'000'000, 16, 20, 1};

Decided decided(const std::string& method, const TeamOracle& oracle, const TeamDecision& decision,
                double start_s) {
  Decided out;
  out.cpu_s = thread_cpu_s() - start_s;
  out.method = method;
  out.choice = decision.choice;
  out.value = decision.value;
  const double candidates = std::max(1, oracle.candidate_count());
  out.calls_per_candidate =
      static_cast<double>(oracle.calls() + decision.oracle_calls) / candidates;
  out.adopted = static_cast<double>(decision.adopted);
  out.messages = static_cast<double>(decision.messages);
  return out;
}

}  // namespace

Decided local_search(const std::string& method, const TeamOracle& oracle, bool lazy,
                     bool warm_start) {
  const double start_s = thread_cpu_s();
  return decided(method, oracle,
                 distributed_local_search(oracle, {1.0, lazy, warm_start}, Deadline::never()),
                 start_s);
}

Decided descent(const std::string& method, const TeamOracle& oracle, bool is_last_first) {
  const double start_s = thread_cpu_s();
  planner::DescentOptions options;
  options.order.resize(static_cast<std::size_t>(oracle.robot_count()));
  std::iota(options.order.begin(), options.order.end(), 0);
  if (is_last_first) {
    std::reverse(options.order.begin(), options.order.end());
  }
  return decided(method, oracle, coordinate_descent(oracle, options), start_s);
}

planner::ReducedValueIteration& thread_search() {
  // Earlier searches do not affect later ones. The object is on the heap, because thread-local
  // objects use stack space of every thread.
  thread_local const auto own = std::make_unique<planner::ReducedValueIteration>(kCapacity);
  return *own;
}

}  // namespace vantage::experiments
