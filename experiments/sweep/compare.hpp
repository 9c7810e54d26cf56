#pragma once

#include <string>

#include "experiments/sweep/sample.hpp"
#include "experiments/sweep/sweep.hpp"

// Ours beside what the dissertation prints, with the deviation named.

namespace vantage::experiments {

/// "8.34 ± 1.6 m" of `ours` with its 95 % interval, against one printed number.
Compared compare_number(const std::string& what, const Sample& ours, double printed,
                        const std::string& unit);
/// Against a printed range, both ends included.
Compared compare_range(const std::string& what, double ours, double low, double high,
                       const std::string& unit);
/// Against a statement, which holds or does not.
Compared compare_claim(const std::string& what, const std::string& ours, const std::string& printed,
                       bool holds);

/// "8.34 ± 1.6" of the mean and its 95 % interval; without the interval of fewer than two.
std::string mean_text(const Sample& sample);

}  // namespace vantage::experiments
