#pragma once

#include <cmath>

namespace vantage::planner {

/// A product of factors beyond this limit is replaced by its logarithm.
inline constexpr double kProductMax = 1e150;

/// A sum of logarithms, computed as the logarithm of a product. The product is replaced by its
/// logarithm whenever it might leave the range of a double. A single factor may be between 1e−150
/// and 1e150.
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
