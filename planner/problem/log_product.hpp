#pragma once

#include <cmath>

namespace vantage::planner {

/// Beyond it a product of factors is turned into its logarithm.
inline constexpr double kProductMax = 1e150;

/// A sum of logarithms as the logarithm of a product, taken whenever the product might leave the
/// range of a double: a single factor may be as small or large as 1e±150.
class LogProduct {
 public:
  void multiply(double factor) {
    product_ *= factor;
    if (!(product_ > 1e-150 && product_ < kProductMax)) {
      sum_ += std::log(product_);
      product_ = 1.0;
    }
  }
  [[nodiscard]] double log() const { return sum_ + std::log(product_); }

 private:
  double sum_ = 0.0;
  double product_ = 1.0;
};

}  // namespace vantage::planner
