#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "experiments/decisions/energy_decision.hpp"
#include "experiments/sweep/sample.hpp"
#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

/// Returns a sweep over teams of 2 … 10 robots of draw_energy_trial() (2 … 4 in a smoke run); each
/// trial is decided by every method of `decide`.
Sweep energy_sweep(const Extent& extent,
                   std::function<std::vector<Decided>(const planner::TeamOracle&)> decide,
                   std::function<Summary(const Tables&)> summarise);

/// Returns the number of robots of a setting.
int robots_of(std::size_t setting);

/// Returns our choices for parameters that the dissertation does not state.
std::vector<std::string> energy_choices();

/// Samples of all trials of one decision method.
struct MethodSamples {
  Sample value;
  Sample calls;
  Sample adopted;
  Sample messages;
};

/// Samples of an energy sweep, by team size and method.
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
  /// Returns means, deviations and confidence intervals.
  [[nodiscard]] std::string csv() const;

 private:
  std::map<int, Sample> candidates_;
  std::map<int, std::map<std::string, MethodSamples>> methods_;
  std::map<int, std::map<std::string, Sample>> times_;
};

}  // namespace vantage::experiments
