#include "experiments/surveillance/restricted_mean.hpp"

#include <algorithm>
#include <cstddef>

namespace vantage::experiments {
namespace {

std::vector<Wait> waits_of(const std::vector<std::vector<char>>& seen, std::size_t landmark) {
  std::vector<Wait> waits;
  int steps = 0;
  for (const std::vector<char>& step : seen) {
    ++steps;
    if (step[landmark] != 0) {
      waits.push_back({steps, true});
      steps = 0;
    }
  }
  if (steps > 0) {
    waits.push_back({steps, false});
  }
  return waits;
}

}  // namespace

double restricted_mean(std::vector<Wait> waits, int until) {
  std::ranges::sort(waits, std::ranges::less{}, &Wait::steps);
  double mean = 0.0;
  double share = 1.0;
  int reached = 0;
  for (std::size_t first = 0; first < waits.size() && waits[first].steps < until;) {
    const int steps = waits[first].steps;
    mean += share * (steps - reached);
    reached = steps;
    const auto lasting = static_cast<double>(waits.size() - first);
    double ended = 0.0;
    for (; first < waits.size() && waits[first].steps == steps; ++first) {
      ended += waits[first].is_ended ? 1.0 : 0.0;
    }
    share *= 1.0 - ended / lasting;
  }
  return mean + share * (until - reached);
}

TimeUnobserved time_unobserved(const std::vector<std::vector<char>>& seen) {
  const int until = static_cast<int>(seen.size());
  const std::size_t landmarks = seen.front().size();
  TimeUnobserved result;
  std::vector<Wait> all;
  for (std::size_t m = 0; m < landmarks; ++m) {
    const std::vector<Wait> waits = waits_of(seen, m);
    all.insert(all.end(), waits.begin(), waits.end());
    result.by_landmark += restricted_mean(waits, until) / static_cast<double>(landmarks);
  }
  result.pooled = restricted_mean(all, until);
  return result;
}

}  // namespace vantage::experiments
