#include "core/deadline.hpp"

#include <gtest/gtest.h>

namespace vantage {
namespace {

constexpr std::int64_t kLongAgo_ns = 1;
constexpr std::int64_t kInAThousandYears_ns = 30'000'000'000'000'000;

// Runs a loop with `stride` nodes of work between two checks; returns the node at which it stopped.
std::int64_t nodes_until_expiry(const Deadline& deadline, std::int64_t stride) {
  std::int64_t nodes = 0;
  while (!deadline.expired(nodes)) {
    nodes += stride;
  }
  return nodes;
}

TEST(Deadline, ExpiresExactlyAtTheNodeBudget) {
  const Deadline deadline = Deadline::nodes(100);
  EXPECT_FALSE(deadline.expired(0));
  EXPECT_FALSE(deadline.expired(99));
  EXPECT_TRUE(deadline.expired(100));
  EXPECT_TRUE(deadline.expired(101));
}

TEST(Deadline, IsExpiredWithZeroNodes) { EXPECT_TRUE(Deadline::nodes(0).expired(0)); }

TEST(Deadline, IgnoresNodesIfOnlyTheTimeIsLimited) {
  EXPECT_TRUE(Deadline::at(kLongAgo_ns).expired(0));
  EXPECT_FALSE(Deadline::at(kInAThousandYears_ns).expired(1'000'000'000));
}

TEST(Deadline, ExpiresAtTheEarlierOfTwoLimits) {
  EXPECT_TRUE(Deadline::either(10, kLongAgo_ns).expired(0));
  EXPECT_TRUE(Deadline::either(10, kInAThousandYears_ns).expired(10));
  EXPECT_FALSE(Deadline::either(10, kInAThousandYears_ns).expired(9));
}

TEST(Deadline, DoesNotExpireWithoutALimit) {
  EXPECT_FALSE(Deadline::never().expired(0));
  EXPECT_FALSE(Deadline::never().expired(std::numeric_limits<std::int64_t>::max() - 1));
}

TEST(Deadline, ThirdKeepsTheNodesAndHasAThirdOfTheTime) {
  constexpr std::int64_t kLeft_ns = 3'000'000'000'000;
  const std::int64_t before_ns = monotonic_ns();
  const Deadline third = Deadline::either(10, before_ns + kLeft_ns).third();
  EXPECT_GE(third.instant_ns(), before_ns + kLeft_ns / 3);
  EXPECT_LE(third.instant_ns(), monotonic_ns() + kLeft_ns / 3);
  EXPECT_EQ(third.budget_nodes(), 10);
  EXPECT_EQ(Deadline::at(kLongAgo_ns).third().instant_ns(), kLongAgo_ns)
      << "the deadline has passed already";
  for (const Deadline& deadline : {Deadline::nodes(7), Deadline::never()}) {
    EXPECT_EQ(deadline.third().instant_ns(), deadline.instant_ns());
    EXPECT_EQ(deadline.third().budget_nodes(), deadline.budget_nodes());
  }
}

TEST(Deadline, StopsAtTheSameNodeWithTheNodeCountOfAStoppedLoop) {
  for (const std::int64_t stride : {1, 3, 7, 1000}) {
    const std::int64_t stopped_at =
        nodes_until_expiry(Deadline::at(monotonic_ns() + 200'000), stride);
    EXPECT_EQ(nodes_until_expiry(Deadline::nodes(stopped_at), stride), stopped_at);
  }
}

TEST(MonotonicNs, NeverDecreases) {
  std::int64_t last_ns = monotonic_ns();
  for (int i = 0; i < 10'000; ++i) {
    const std::int64_t now_ns = monotonic_ns();
    ASSERT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
}

TEST(Deadline, ExpiresWhenCancelled) {
  static bool is_cancelled = false;
  const auto is_stopped = [] { return is_cancelled; };
  for (const Deadline& budget :
       {Deadline::nodes(100), Deadline::at(kInAThousandYears_ns), Deadline::never()}) {
    const Deadline deadline = budget.with_cancellation(is_stopped);
    is_cancelled = false;
    EXPECT_FALSE(deadline.expired(99));
    is_cancelled = true;
    EXPECT_TRUE(deadline.expired(0));
  }
  is_cancelled = false;
  EXPECT_TRUE(Deadline::nodes(100).with_cancellation(is_stopped).expired(100));
}

}  // namespace
}  // namespace vantage
