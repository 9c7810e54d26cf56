#pragma once

#include <cstdint>
#include <vector>

#include "core/index.hpp"
#include "planner/search/heuristic.hpp"

namespace vantage::planner {

/// Common part of bounds that cover only some of a problem's targets: the tabulated inputs and the
/// set of covered targets. The bound of Thm 6 is used for the other targets.
class PartialBound {
 public:
  /// Returns 1 for each covered target, otherwise 0.
  [[nodiscard]] const std::vector<std::uint8_t>& takes_part() const { return takes_part_; }
  [[nodiscard]] bool is_empty() const { return targets_.empty(); }

 protected:
  /// Sets the inputs; initially no target is covered.
  void begin(const SearchProblem& problem, const BeliefTable& beliefs,
             const InformationHeuristic& heuristic) {
    problem_ = &problem;
    beliefs_ = &beliefs;
    heuristic_ = &heuristic;
    horizon_ = problem.horizon_steps;
    targets_.clear();
    takes_part_.assign(index(beliefs.target_count()), 0);
  }

  const SearchProblem* problem_ = nullptr;
  const BeliefTable* beliefs_ = nullptr;
  const InformationHeuristic* heuristic_ = nullptr;
  int horizon_ = 0;
  std::vector<int> targets_;
  std::vector<std::uint8_t> takes_part_;
};

}  // namespace vantage::planner
