#include "experiments/surveillance/restricted_mean.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace vantage::experiments {
namespace {

TEST(RestrictedMean, EqualsTruncatedMeanForCompleteWaits) {
  const std::vector<Wait> waits = {{4}, {1}, {7}, {1}, {30}};
  EXPECT_DOUBLE_EQ(restricted_mean(waits, 100), 43.0 / 5.0);
  EXPECT_DOUBLE_EQ(restricted_mean(waits, 30), 43.0 / 5.0);
  EXPECT_DOUBLE_EQ(restricted_mean(waits, 10), 23.0 / 5.0);
  EXPECT_DOUBLE_EQ(restricted_mean(waits, 1), 1.0);
}

TEST(RestrictedMean, EqualsItsLimitIfAllWaitsAreCensored) {
  EXPECT_DOUBLE_EQ(restricted_mean({{3, false}, {9, false}}, 20), 20.0);
  EXPECT_DOUBLE_EQ(restricted_mean({{20, false}}, 20), 20.0);
  EXPECT_DOUBLE_EQ(restricted_mean({}, 20), 20.0);
}

// The survival function S is 1, then 3/4 from t = 1 and 1/2 from t = 2. One wait is censored at t =
// 3, and the remaining wait ends at t = 4.
TEST(RestrictedMean, IncludesCensoredWaitsUntilTheirEnd) {
  const std::vector<Wait> waits = {{2}, {1}, {4}, {3, false}};
  EXPECT_DOUBLE_EQ(restricted_mean(waits, 10), 1.0 + 0.75 + 2 * 0.5);
  EXPECT_DOUBLE_EQ(restricted_mean(waits, 3), 1.0 + 0.75 + 0.5);
  // If a wait is censored when another ends, it still belongs to the waits at risk at that time.
  EXPECT_DOUBLE_EQ(restricted_mean({{2}, {2, false}}, 10), 2.0 + 8 * 0.5);
}

// Waits end with probability p per step and are censored independently with probability c. The
// restricted mean is Σ_{t < τ} (1 − p)^t = (1 − (1 − p)^τ) / p, as for a geometric distribution
// truncated at τ.
TEST(RestrictedMean, IsUnbiasedForExponentialWaits) {
  constexpr int kWaits = 200'000;
  std::mt19937_64 rng(3);
  for (const double p : {0.3, 0.05}) {
    for (const double c : {0.001, 0.02, 0.2}) {
      std::geometric_distribution<int> ends(p);
      std::geometric_distribution<int> is_cut(c);
      std::vector<Wait> waits;
      double plain = 0.0;
      for (int i = 0; i < kWaits; ++i) {
        const int end = 1 + ends(rng);
        const int cut = 1 + is_cut(rng);
        waits.push_back({std::min(end, cut), end <= cut});
        plain += static_cast<double>(std::min(end, cut)) / kWaits;
      }
      constexpr int kUntil = 20;
      const double expected = (1.0 - std::pow(1.0 - p, kUntil)) / p;
      EXPECT_NEAR(restricted_mean(waits, kUntil), expected, 0.02 * expected) << p << " " << c;
      if (c >= 0.2) {
        EXPECT_LT(plain, 0.8 * expected) << "the plain mean of the waits is too small";
      }
    }
  }
}

// One landmark is seen at steps 2, 3 and 7 of 10, the other never.
TEST(TimeUnobserved, CensorsTheLastWaits) {
  std::vector<std::vector<char>> seen(10, {0, 0});
  seen[1][0] = seen[2][0] = seen[6][0] = 1;
  const TimeUnobserved result = time_unobserved(seen);
  // Landmark 0: waits of 2, 1, 4 and one censored at 3, mean 2.75. Landmark 1: one censored at 10.
  EXPECT_DOUBLE_EQ(result.by_landmark, 0.5 * (2.75 + 10.0));
  // S is 1, then 4/5 from t = 1, 3/5 from t = 2, and 3/10 from t = 4 to 10.
  EXPECT_DOUBLE_EQ(result.pooled, 1.0 + 0.8 + 2 * 0.6 + 6 * 0.3);
}

TEST(TimeUnobserved, IsOneStepIfAlwaysInViewAndTheTaskLengthIfNever) {
  const std::vector<std::vector<char>> always(50, {1, 1, 1});
  const std::vector<std::vector<char>> never(50, {0, 0, 0});
  EXPECT_DOUBLE_EQ(time_unobserved(always).by_landmark, 1.0);
  EXPECT_DOUBLE_EQ(time_unobserved(always).pooled, 1.0);
  EXPECT_NEAR(time_unobserved(never).by_landmark, 50.0, 1e-12);
  EXPECT_DOUBLE_EQ(time_unobserved(never).pooled, 50.0);
}

}  // namespace
}  // namespace vantage::experiments
