#include "models/world/near_pairs.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace vantage::models {
namespace {

TEST(NearPairs, IncludeAllNearPairsAndExcludeFarOnes) {
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> side(-100.0, 100.0);
  std::uniform_real_distribution<double> step(-1.0, 1.0);
  std::vector<Eigen::Vector3d> centres_m;
  for (int i = 0; i < 300; ++i) {
    centres_m.emplace_back(side(rng), side(rng), 1.0);
  }
  NearPairs near;
  for (int round = 0; round < 20; ++round) {
    const double within_m = 1.0 + round;
    const std::vector<NearPairs::Pair>& pairs = near.find(centres_m, within_m);
    EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
    EXPECT_LT(pairs.size(), 44'850U / 10);
    for (std::uint32_t i = 0; i < centres_m.size(); ++i) {
      for (std::uint32_t j = i + 1; j < centres_m.size(); ++j) {
        if ((centres_m[i] - centres_m[j]).norm() <= within_m) {
          ASSERT_TRUE(std::binary_search(pairs.begin(), pairs.end(), NearPairs::Pair{i, j}));
        }
      }
    }
    for (Eigen::Vector3d& centre_m : centres_m) {
      centre_m += Eigen::Vector3d(step(rng), step(rng), 0.0);
    }
  }
}

TEST(NearPairs, IncludeAllPairsWithoutADistanceLimit) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  NearPairs near;
  std::vector<Eigen::Vector3d> centres_m{
      {5.0, 0.0, 0.0}, {0.0, kNaN, 0.0}, {-5.0, 9.0, 0.0}, {1e6, 0.0, 2.0}};
  EXPECT_EQ(near.find(centres_m, kInfinity),
            (std::vector<NearPairs::Pair>{{0, 2}, {0, 3}, {2, 3}}));
  centres_m[1].y() = 0.0;
  EXPECT_EQ(near.find(centres_m, kInfinity).size(), 6U);
  centres_m.pop_back();
  EXPECT_EQ(near.find(centres_m, 6.0), (std::vector<NearPairs::Pair>{{0, 1}}));
}

}  // namespace
}  // namespace vantage::models
