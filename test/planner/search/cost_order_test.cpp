#include "planner/search/cost_order.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

struct Costed {
  double cost = 0.0;
  NodeId id = 0;
};

// Returns costs of all magnitudes and both signs; many are equal.
std::vector<Costed> random_costs(std::mt19937_64& rng, int count) {
  std::vector<Costed> costs;
  const int kinds = test::pick(rng, 1, 4);
  for (int i = 0; i < count; ++i) {
    double cost = std::round(test::uniform(rng, -20.0, 20.0));
    switch (test::pick(rng, 1, kinds)) {
      case 2:
        cost = test::uniform(rng, -2000.0, 10.0);
        break;
      case 3:
        cost = std::pow(10.0, test::uniform(rng, -300.0, 300.0));
        break;
      case 4:
        cost = -std::pow(10.0, test::uniform(rng, -300.0, 300.0));
        break;
      default:
        break;
    }
    costs.push_back({cost, static_cast<NodeId>(10 + 3 * i)});
  }
  return costs;
}

TEST(CostOrder, EqualsAStableSort) {
  std::mt19937_64 rng(5);
  CostOrder order(20'000);
  for (const int count : {0, 1, 2, 159, 160, 161, 511, 512, 513, 5'000, 20'000}) {
    for (int repetition = 0; repetition < 5; ++repetition) {
      std::vector<Costed> costs = random_costs(rng, count);
      order.clear();
      for (const Costed& node : costs) {
        order.add(node.cost, node.id);
      }
      ASSERT_TRUE(order.sort([] { return true; }));
      std::stable_sort(costs.begin(), costs.end(),
                       [](const Costed& a, const Costed& b) { return a.cost < b.cost; });
      for (const Costed& node : costs) {
        ASSERT_FALSE(order.is_empty());
        ASSERT_FALSE(order.is_next_before(node.cost)) << count;
        ASSERT_TRUE(order.is_next_before(std::nextafter(node.cost, 1e308))) << count;
        ASSERT_EQ(order.pop(), node.id) << count;
      }
      ASSERT_TRUE(order.is_empty());
    }
  }
}

TEST(CostOrder, TreatsBothZerosAsEqual) {
  CostOrder order(2);
  order.add(0.0, 1);
  order.add(-0.0, 2);
  ASSERT_TRUE(order.sort([] { return true; }));
  EXPECT_FALSE(order.is_next_before(-0.0));
  EXPECT_EQ(order.pop(), 1u);
}

TEST(CostOrder, ChecksDeadlineInBoundedSteps) {
  constexpr int kCount = 20'000;
  std::mt19937_64 rng(6);
  CostOrder order(kCount);
  const std::vector<Costed> costs = random_costs(rng, kCount);
  const auto fill = [&] {
    order.clear();
    for (const Costed& node : costs) {
      order.add(node.cost, node.id);
    }
  };
  fill();
  int checks = 0;
  ASSERT_TRUE(order.sort([&] { return ++checks > 0; }));
  EXPECT_GE(checks, 2 * kCount / 512);  // at least one counting and one scattering pass
  for (const int last : {1, 2, checks / 2, checks}) {
    fill();
    int now = 0;
    EXPECT_FALSE(order.sort([&] { return ++now < last; }));
    EXPECT_EQ(now, last);
  }
}

}  // namespace
}  // namespace vantage::planner
