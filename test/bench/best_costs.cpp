#include "test/bench/best_costs.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::bench {
namespace {

constexpr const char* kHeader = "problem,cost,method,controls";

std::map<std::string, BestCosts::Entry> read(const std::string& path) {
  std::map<std::string, BestCosts::Entry> entries;
  std::ifstream file(path);
  if (!file && !std::filesystem::exists(path)) {
    return entries;
  }
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const auto refuse = [&](const std::string& rule) {
      throw StartupError(fmt::format("{}:{}: {}, got \"{}\"", path, number, rule, line));
    };
    if (number == 1) {
      if (line != kHeader) {
        refuse(fmt::format("must be \"{}\"", kHeader));
      }
      continue;
    }
    std::istringstream words(line);
    std::string problem;
    std::string cost;
    BestCosts::Entry entry;
    std::getline(words, problem, ',');
    std::getline(words, cost, ',');
    std::getline(words, entry.method, ',');
    std::size_t used = 0;
    try {
      entry.cost = std::stod(cost, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || used != cost.size() || !std::isfinite(entry.cost)) {
      refuse("the cost must be a finite number");
    }
    for (int control = 0; words >> control;) {
      entry.controls.push_back(control);
    }
    if (!words.eof() || entry.controls.empty()) {
      refuse("the controls must be indices");
    }
    if (!entries.emplace(problem, entry).second) {
      refuse("each problem may be listed once");
    }
  }
  if (file.bad()) {
    throw StartupError(path + ": cannot be read");
  }
  return entries;
}

}  // namespace

BestCosts::BestCosts(std::string path) : path_(std::move(path)), entries_(read(path_)) {}

const BestCosts::Entry* BestCosts::find(const std::string& problem) const {
  const auto found = entries_.find(problem);
  return found == entries_.end() ? nullptr : &found->second;
}

bool BestCosts::offer(const std::string& problem, const Entry& entry) {
  const auto [known, is_new] = entries_.emplace(problem, entry);
  constexpr double kRounding = 2e-9;  // the file has nine decimals
  if (!is_new && entry.cost < known->second.cost - kRounding) {
    known->second = entry;
    return true;
  }
  return is_new;
}

void BestCosts::save() {
  for (const auto& [problem, entry] : read(path_)) {
    offer(problem, entry);
  }
  const std::string next_path = path_ + ".next";
  std::ofstream file(next_path);
  file << kHeader << '\n';
  for (const auto& [problem, entry] : entries_) {
    file << fmt::format("{},{:.9f},{},{}\n", problem, entry.cost, entry.method,
                        fmt::join(entry.controls, " "));
  }
  file.close();
  if (!file) {
    throw StartupError(next_path + ": cannot be written");
  }
  std::filesystem::rename(next_path, path_);
}

double score_of(const planner::SearchProblem& problem, const std::vector<int>& controls) {
  if (controls.size() != static_cast<std::size_t>(problem.horizon_steps)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::vector<Pose2> poses;
  Pose2 pose = problem.start;
  for (const int control : controls) {
    pose = models::step_unicycle(pose, problem.controls.at(static_cast<std::size_t>(control)),
                                 problem.step_s);
    poses.push_back(pose);
  }
  return planner::score(problem, poses);
}

}  // namespace vantage::bench
