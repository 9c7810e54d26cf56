#pragma once

#include <map>
#include <string>
#include <vector>

#include "planner/problem/problem.hpp"

namespace vantage::bench {

/// The least cost that any method has reached on each problem, with the controls that reach it, so
/// that everybody can score them again. Costs in the file only ever fall.
class BestCosts {
 public:
  struct Entry {
    double cost = 0.0;
    std::string method;
    std::vector<int> controls;
  };

  BestCosts() = default;
  /// Lines "problem,cost,method,controls", the controls as indices with blanks between, below a
  /// line of these words. No such file: empty. @throws StartupError "path:line: what is wrong".
  explicit BestCosts(std::string path);

  /// Null when the problem is not listed.
  [[nodiscard]] const Entry* find(const std::string& problem) const;
  [[nodiscard]] const std::map<std::string, Entry>& entries() const { return entries_; }

  /// Takes `entry` if it costs less than what is listed; true when it did.
  bool offer(const std::string& problem, const Entry& entry);

  /// Writes the lesser of every cost here and in the file: another run may have been there.
  /// @throws StartupError when the file has become unreadable; it is then left as it is.
  void save();

 private:
  std::string path_;
  std::map<std::string, Entry> entries_;
};

/// J_T of `controls` by the plain recursion of the models; NaN when they are not T of them.
double score_of(const planner::SearchProblem& problem, const std::vector<int>& controls);

}  // namespace vantage::bench
