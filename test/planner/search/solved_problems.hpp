#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "planner/search/capacity.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/exhaustive_oracle.hpp"

// Small random problems with the solutions of exhaustive search, the reference of all search tests.

namespace vantage::test {

/// Returns a capacity that is enough for any random problem.
inline planner::SearchCapacity small_capacity() { return {20'000, 800'000, 8, 8, 4}; }

/// Returns the tolerance between costs that were summed in different orders.
inline double slack(double cost) { return 1e-9 * std::max(1.0, std::abs(cost)); }

struct SolvedProblem {
  std::uint64_t seed = 0;
  OwnedProblem owned;
  OracleAnswer best;
};

/// Returns the problems among `count` random ones from `first_seed` on that exhaustive search can
/// solve. They are computed once per `first_seed`.
inline const std::vector<SolvedProblem>& solved_problems(std::uint64_t first_seed,
                                                         std::uint64_t count) {
  static std::map<std::uint64_t, std::vector<SolvedProblem>> known;
  const auto [place, is_new] = known.try_emplace(first_seed);
  for (std::uint64_t seed = first_seed; is_new && seed < first_seed + count; ++seed) {
    SolvedProblem each{seed, random_problem(seed), {}};
    each.best = best_completion(each.owned.problem, start_of(each.owned.problem));
    if (!each.best.undecided) {
      place->second.push_back(std::move(each));
    }
  }
  return place->second;
}

}  // namespace vantage::test
