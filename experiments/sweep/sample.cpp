#include "experiments/sweep/sample.hpp"

#include <array>
#include <cmath>

namespace vantage::experiments {
namespace {

// 97.5 % quantile of Student's t for 1 … 30 degrees of freedom. Above 30, the quantile of the
// normal distribution is smaller by at most 4 %.
constexpr std::array<double, 30> kStudent = {
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
    2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
    2.080,  2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};
constexpr double kNormal = 1.96;

}  // namespace

double Sample::mean() const {
  double sum = 0.0;
  for (const double value : values_) {
    sum += value;
  }
  return values_.empty() ? 0.0 : sum / static_cast<double>(values_.size());
}

double Sample::deviation() const {
  if (values_.size() < 2) {
    return 0.0;
  }
  double sum = 0.0;
  for (const double value : values_) {
    sum += (value - mean()) * (value - mean());
  }
  return std::sqrt(sum / static_cast<double>(values_.size() - 1));
}

double Sample::half_interval() const {
  if (values_.size() < 2) {
    return 0.0;
  }
  const std::size_t freedom = values_.size() - 1;
  const double t = freedom <= kStudent.size() ? kStudent[freedom - 1] : kNormal;
  return t * deviation() / std::sqrt(static_cast<double>(values_.size()));
}

}  // namespace vantage::experiments
