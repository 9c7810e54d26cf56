#pragma once

#include <string>

#include "experiments/sweep/sample.hpp"
#include "experiments/sweep/sweep.hpp"

// Comparison of our results with the printed values of the dissertation.

namespace vantage::experiments {

/// Compares `ours` and its 95 % interval ("8.34 ± 1.6 m") with one printed number.
Compared compare_number(const std::string& what, const Sample& ours, double printed,
                        const std::string& unit);
/// Compares `ours` with a printed range, both ends included.
Compared compare_range(const std::string& what, double ours, double low, double high,
                       const std::string& unit);
/// Compares our results with a printed statement; `holds` is true if they confirm it.
Compared compare_claim(const std::string& what, const std::string& ours, const std::string& printed,
                       bool holds);

/// Returns the mean and its 95 % interval as "8.34 ± 1.6". Leaves out the interval for fewer than
/// two values.
std::string mean_text(const Sample& sample);

}  // namespace vantage::experiments
