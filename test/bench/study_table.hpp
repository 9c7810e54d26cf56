#pragma once

#include <string>
#include <vector>

#include "test/bench/best_costs.hpp"
#include "test/bench/study_run.hpp"

namespace vantage::bench {

/// The runs of one method at one budget on the problems with `targets` targets, or on all problems
/// if `targets` is 0.
struct StudyRow {
  int targets = 0;
  std::string method;
  double budget_s = 0.0;
  std::size_t problems = 0;
  std::size_t without_plan = 0;
  std::size_t within_a_hundredth = 0;  ///< number of problems with an excess ≤ 0.01
  double mean_excess = 0.0;            ///< cost minus best known cost; mean over runs with a plan
  double p90_excess = 0.0;
  double max_excess = 0.0;
  double mean_cost = 0.0;
  double mean_gap = 0.0;    ///< cost minus lower bound
  double median_gap = 0.0;  ///< gap relative to the cost
  double mean_cpu_s = 0.0;
};

/// Returns one row per method, budget and number of targets, and one row per method and budget for
/// all problems.
std::vector<StudyRow> summarise(const std::vector<StudyRun>& runs, const BestCosts& best);

std::string to_text(const std::vector<StudyRow>& rows);
/// Writes the rows as CSV, for the plots.
void write_csv(const std::string& path, const std::vector<StudyRow>& rows);

}  // namespace vantage::bench
