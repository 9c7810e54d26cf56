#pragma once

#include <cstddef>
#include <vector>

namespace vantage::experiments {

/// Numbers of independent trials, and what they say of their mean.
class Sample {
 public:
  void add(double value) { values_.push_back(value); }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] double mean() const;
  /// Of one trial, unbiased; 0 of fewer than two.
  [[nodiscard]] double deviation() const;
  /// Half the 95 % confidence interval of the mean, by Student's t.
  [[nodiscard]] double half_interval() const;

 private:
  std::vector<double> values_;
};

}  // namespace vantage::experiments
