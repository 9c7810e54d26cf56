#pragma once

#include <cmath>

#include <gtest/gtest.h>

namespace vantage::test {

/// Returns the last accepted value found by bisection between `accepted` and `refused` (in either
/// order), to within `step`. Both ends are checked first.
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
