#include "experiments/sweep/compare.hpp"

#include <cmath>

#include <fmt/format.h>

namespace vantage::experiments {

std::string mean_text(const Sample& sample) {
  return sample.size() < 2 ? fmt::format("{:.3g}", sample.mean())
                           : fmt::format("{:.3g} ± {:.2g}", sample.mean(), sample.half_interval());
}

Compared compare_number(const std::string& what, const Sample& ours, double printed,
                        const std::string& unit) {
  const double difference = ours.mean() - printed;
  std::string deviation = fmt::format("{:+.3g} {}", difference, unit);
  if (printed > 0.0) {
    deviation += fmt::format(" (× {:.2g})", ours.mean() / printed);
  }
  if (ours.size() > 1 && std::abs(difference) <= ours.half_interval()) {
    deviation += ", within our interval";
  }
  return {what, mean_text(ours) + " " + unit, fmt::format("{:g} {}", printed, unit), deviation};
}

Compared compare_range(const std::string& what, double ours, double low, double high,
                       const std::string& unit) {
  std::string deviation = "none: within the published range";
  if (ours < low) {
    deviation = fmt::format("{:.3g} {} below the range", low - ours, unit);
  } else if (ours > high) {
    deviation = fmt::format("{:.3g} {} above the range", ours - high, unit);
  }
  return {what, fmt::format("{:.3g} {}", ours, unit), fmt::format("{:g}–{:g} {}", low, high, unit),
          deviation};
}

Compared compare_claim(const std::string& what, const std::string& ours, const std::string& printed,
                       bool holds) {
  return {what, ours, printed, holds ? "none: it holds" : "**does not hold here**"};
}

}  // namespace vantage::experiments
