#pragma once

#include <map>
#include <string>
#include <vector>

#include "planner/problem/problem.hpp"

namespace vantage::bench {

/// The lowest known cost of each problem, with the controls that reach it, so that anyone can
/// verify the cost. The costs in the file only decrease.
class BestCosts {
 public:
  struct Entry {
    double cost = 0.0;
    std::string method;
    std::vector<int> controls;
  };

  BestCosts() = default;
  /// Reads lines "problem,cost,method,controls" below a header line of these words; the controls
  /// are indices separated by blanks. A missing file gives an empty list. @throws StartupError
  /// "path:line: what is wrong".
  explicit BestCosts(std::string path);

  /// Returns null if the problem is not listed.
  [[nodiscard]] const Entry* find(const std::string& problem) const;
  [[nodiscard]] const std::map<std::string, Entry>& entries() const { return entries_; }

  /// Replaces the listed entry if `entry` costs less; returns true if it did.
  bool offer(const std::string& problem, const Entry& entry);

  /// Writes, for each problem, the lower of the cost in this object and the cost in the file, which
  /// another run may have changed. @throws StartupError if the file has become unreadable; the file
  /// is then not changed.
  void save();

 private:
  std::string path_;
  std::map<std::string, Entry> entries_;
};

/// Returns J_T of `controls`, computed by the direct recursion of the models; NaN unless there are
/// T controls.
double score_of(const planner::SearchProblem& problem, const std::vector<int>& controls);

}  // namespace vantage::bench
