#include "test/bench/study_table.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::bench {
namespace {

StudyRow row_of(int targets, const std::string& method, double budget_s,
                const std::vector<StudyRun>& runs, const BestCosts& best) {
  StudyRow row{targets, method, budget_s};
  std::vector<double> excess;
  std::vector<double> gaps;
  for (const StudyRun& run : runs) {
    if (run.method != method || run.budget_s != budget_s ||
        (targets != 0 && run.targets != targets)) {
      continue;
    }
    ++row.problems;
    if (!std::isfinite(run.cost)) {
      ++row.without_plan;
      continue;
    }
    excess.push_back(run.cost - best.find(run.problem)->cost);
    row.mean_excess += excess.back();
    row.mean_cost += run.cost;
    row.mean_gap += run.cost - run.lower_bound;
    gaps.push_back((run.cost - run.lower_bound) / std::abs(run.cost));
    row.mean_cpu_s += run.cpu_s;
    row.within_a_hundredth += excess.back() <= 0.01 ? 1U : 0U;
  }
  if (!excess.empty()) {
    const auto count = static_cast<double>(excess.size());
    row.mean_excess /= count;
    row.mean_cost /= count;
    row.mean_gap /= count;
    row.mean_cpu_s /= count;
    std::sort(excess.begin(), excess.end());
    std::sort(gaps.begin(), gaps.end());
    row.median_gap = 0.5 * (gaps[(gaps.size() - 1) / 2] + gaps[gaps.size() / 2]);
    row.p90_excess = excess[static_cast<std::size_t>(0.9 * (count - 1.0))];
    row.max_excess = excess.back();
  }
  return row;
}

}  // namespace

std::vector<StudyRow> summarise(const std::vector<StudyRun>& runs, const BestCosts& best) {
  std::vector<std::pair<std::string, double>> kinds;
  std::set<int> targets = {0};
  for (const StudyRun& run : runs) {
    const std::pair<std::string, double> kind{run.method, run.budget_s};
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
      kinds.push_back(kind);
    }
    targets.insert(run.targets);
  }
  std::vector<StudyRow> rows;
  for (const int count : targets) {
    for (const auto& [method, budget_s] : kinds) {
      rows.push_back(row_of(count, method, budget_s, runs, best));
    }
  }
  return rows;
}

std::string to_text(const std::vector<StudyRow>& rows) {
  std::string text =
      fmt::format("{:>4} {:8} {:>8} {:>9} {:>10} {:>9} {:>9} {:>7} {:>8} {:>10} {:>8} {:>9}\n", "M",
                  "method", "budget_s", "problems", "mean", "p90", "max", "≤ 0.01", "no plan",
                  "mean gap", "median %", "cpu_s");
  for (const StudyRow& row : rows) {
    text += fmt::format(
        "{:>4} {:8} {:>8} {:>9} {:>10.4f} {:>9.4f} {:>9.4f} {:>6} {:>8} {:>10.2f} {:>8.1f} "
        "{:>9.5f}\n",
        row.targets == 0 ? "all" : std::to_string(row.targets), row.method, row.budget_s,
        row.problems, row.mean_excess, row.p90_excess, row.max_excess, row.within_a_hundredth,
        row.without_plan, row.mean_gap, 100.0 * row.median_gap, row.mean_cpu_s);
  }
  return text;
}

void write_csv(const std::string& path, const std::vector<StudyRow>& rows) {
  std::ofstream file(path);
  file << "targets,method,budget_s,problems,without_plan,within_a_hundredth,mean_excess,p90_excess,"
          "max_excess,mean_cost,mean_gap,median_gap,mean_cpu_s\n";
  for (const StudyRow& row : rows) {
    file << fmt::format("{},{},{},{},{},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n",
                        row.targets, row.method, row.budget_s, row.problems, row.without_plan,
                        row.within_a_hundredth, row.mean_excess, row.p90_excess, row.max_excess,
                        row.mean_cost, row.mean_gap, row.median_gap, row.mean_cpu_s);
  }
  if (!file.flush()) {
    throw StartupError(path + ": cannot be written");
  }
}

}  // namespace vantage::bench
