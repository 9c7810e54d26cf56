#pragma once

#include <cmath>

#include <gtest/gtest.h>

namespace vantage::test {

/// Where `accepts` changes its answer between `accepted` and `refused` (in either order), to within
/// `step`: the last value found that is still accepted. Both ends are tried first.
template <class Accepts>
double last_accepted(double accepted, double refused, double step, Accepts&& accepts) {
  EXPECT_TRUE(accepts(accepted)) << "at " << accepted;
  EXPECT_FALSE(accepts(refused)) << "at " << refused;
  while (std::abs(refused - accepted) > step) {
    const double middle = 0.5 * (accepted + refused);
    (accepts(middle) ? accepted : refused) = middle;
  }
  return accepted;
}

}  // namespace vantage::test
