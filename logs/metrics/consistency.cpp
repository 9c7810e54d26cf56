#include "logs/metrics/consistency.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"

namespace vantage::logs {
namespace {

// Returns the 95 % quantile of χ² with `dim` (2 or 3) degrees of freedom.
double chi_squared_95(int dim) { return dim == 3 ? 7.814728 : 5.991465; }

}  // namespace

void NeesSums::add(double nees) {
  ++samples_;
  sum_ += nees;
  inside_ += nees <= chi_squared_95(position_dim_) ? 1 : 0;
  const double place = (std::log10(std::max(nees, 1e-300)) - kLeastExponent) * kBinsPerDecade;
  ++bins_[static_cast<std::size_t>(std::clamp(place, 0.0, kBins - 1.0))];
}

Consistency NeesSums::result() const {
  Consistency out;
  out.samples = samples_;
  if (samples_ == 0) {
    return out;
  }
  const auto samples = static_cast<double>(samples_);
  out.mean_nees = sum_ / samples;
  out.coverage_95 = static_cast<double>(inside_) / samples;
  double below = 0.0;
  for (int i = 0; i < kBins; ++i) {
    const auto here = static_cast<double>(bins_[index(i)]);
    if (below + here >= 0.5 * samples) {
      const double place = i + (0.5 * samples - below) / here;
      out.median_nees = std::pow(10.0, kLeastExponent + place / kBinsPerDecade);
      break;
    }
    below += here;
  }
  return out;
}

std::size_t age_class(double age_s) {
  std::size_t i = 0;
  while (i + 1 < kAgeClasses && age_s >= kAgeEdges_s[i + 1]) {
    ++i;
  }
  return i;
}

std::string age_name(std::size_t age_class) {
  const auto edge = [](std::size_t i) { return std::to_string(std::lround(kAgeEdges_s[i])); };
  return age_class + 1 < kAgeClasses ? edge(age_class) + "-" + edge(age_class + 1)
                                     : edge(age_class) + "+";
}

}  // namespace vantage::logs
