#pragma once

#include <cstddef>
#include <vector>

namespace vantage::experiments {

/// Values of independent trials, with their mean and its confidence interval.
class Sample {
 public:
  void add(double value) { values_.push_back(value); }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] double mean() const;
  /// Returns the standard deviation of one trial (unbiased variance); 0 for fewer than two trials.
  [[nodiscard]] double deviation() const;
  /// Returns half the 95 % confidence interval of the mean, by Student's t.
  [[nodiscard]] double half_interval() const;

 private:
  std::vector<double> values_;
};

}  // namespace vantage::experiments
