#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "experiments/energy_decision.hpp"
#include "experiments/sweep/sample.hpp"
#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

/// Teams of 2 … 10 robots of draw_energy_trial (2 … 4 in a smoke run), each trial by every method
/// of `decide`.
Sweep energy_sweep(const Extent& extent,
                   std::function<std::vector<Decided>(const planner::TeamOracle&)> decide,
                   std::function<Summary(const Tables&)> summarise);

/// How many robots the setting of that index has.
int robots_of(std::size_t setting);

/// What the source leaves open about these trials.
std::vector<std::string> energy_choices();

/// All trials of one way to decide.
struct MethodSamples {
  Sample value;
  Sample calls;
  Sample adopted;
  Sample messages;
};

/// The rows of an energy sweep, by team size and method.
class EnergySamples {
 public:
  explicit EnergySamples(const Tables& tables);
  [[nodiscard]] std::vector<int> team_sizes() const;
  [[nodiscard]] double candidates(int robots) const { return candidates_.at(robots).mean(); }
  [[nodiscard]] const MethodSamples& of(int robots, const std::string& method) const {
    return methods_.at(robots).at(method);
  }
  [[nodiscard]] const Sample& cpu_s(int robots, const std::string& part) const {
    return times_.at(robots).at(part);
  }
  /// Means, deviations and intervals.
  [[nodiscard]] std::string csv() const;

 private:
  std::map<int, Sample> candidates_;
  std::map<int, std::map<std::string, MethodSamples>> methods_;
  std::map<int, std::map<std::string, Sample>> times_;
};

}  // namespace vantage::experiments
