#include "estimator/tracks/labelled/association.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "test/support/allocation_counter.hpp"
#include "test/support/random.hpp"

namespace vantage::estimator {
namespace {

using Odds = std::vector<std::vector<double>>;

// Reference that enumerates all associations.
struct Enumeration {
  explicit Enumeration(const Odds& of)
      : odds(of), chosen(of.size(), -1), marginal(of.size(), std::vector<double>(of[0].size())) {
    visit(0, 1.0);
    for (auto& row : marginal) {
      for (double& sum : row) {
        sum /= total;
      }
    }
  }
  void visit(std::size_t i, double weight) {
    if (i == odds.size()) {
      total += weight;
      if (weight > most) {
        most = weight;
        best = chosen;
      }
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        if (chosen[k] >= 0) {
          marginal[k][static_cast<std::size_t>(chosen[k])] += weight;
        }
      }
      return;
    }
    visit(i + 1, weight);
    for (std::size_t j = 0; j < odds[i].size(); ++j) {
      bool is_taken = false;
      for (std::size_t k = 0; k < i; ++k) {
        is_taken = is_taken || chosen[k] == static_cast<int>(j);
      }
      if (!is_taken && odds[i][j] > 0.0) {
        chosen[i] = static_cast<int>(j);
        visit(i + 1, weight * odds[i][j]);
        chosen[i] = -1;
      }
    }
  }
  const Odds& odds;
  std::vector<int> chosen;
  std::vector<int> best;
  Odds marginal;
  double total = 0.0;
  double most = 0.0;
};

void set_all(Association& association, const Odds& odds) {
  association.start(static_cast<int>(odds.size()), static_cast<int>(odds[0].size()));
  for (std::size_t i = 0; i < odds.size(); ++i) {
    for (std::size_t j = 0; j < odds[i].size(); ++j) {
      association.set(static_cast<int>(i), static_cast<int>(j), odds[i][j]);
    }
  }
}

void expect_marginals(const Association& association, const Odds& expected, double tolerance) {
  for (std::size_t i = 0; i < expected.size(); ++i) {
    double seen = 0.0;
    for (std::size_t j = 0; j < expected[i].size(); ++j) {
      const double beta = association.probability(static_cast<int>(i), static_cast<int>(j));
      EXPECT_NEAR(beta, expected[i][j], tolerance);
      seen += beta;
    }
    EXPECT_NEAR(association.miss_probability(static_cast<int>(i)) + seen, 1.0, 1e-12);
  }
}

TEST(Association, EqualsTheMarginalsOfAllJointAssociations) {
  test::Random random(2);
  Association association(6, 6);
  for (int trial = 0; trial < 200; ++trial) {
    const int tracks = random.integer(1, 6);
    const int detections = random.integer(1, 5);
    Odds odds(static_cast<std::size_t>(tracks),
              std::vector<double>(static_cast<std::size_t>(detections)));
    for (auto& row : odds) {
      for (double& of : row) {
        of = random.coin() ? std::exp(random.uniform(-6.0, 8.0)) : 0.0;
      }
    }
    const Enumeration all(odds);
    set_all(association, odds);
    association.solve();
    expect_marginals(association, all.marginal, 1e-12);
    for (int j = 0; j < detections; ++j) {
      double assigned = 0.0;
      for (const auto& row : all.marginal) {
        assigned += row[static_cast<std::size_t>(j)];
      }
      EXPECT_NEAR(association.unassigned_probability(j), 1.0 - assigned, 1e-12);
    }
    const std::span<const int> best = association.best();
    double weight = 1.0;
    for (std::size_t i = 0; i < best.size(); ++i) {
      EXPECT_GE(best[i], -1);
      weight *= best[i] < 0 ? 1.0 : odds[i][static_cast<std::size_t>(best[i])];
    }
    EXPECT_NEAR(weight, all.most, 1e-9 * all.most);
  }
}

TEST(Association, EqualsTheClosedFormForOneTrack) {
  Association association(1, 1);
  set_all(association, {{3.0}});
  association.solve();
  EXPECT_DOUBLE_EQ(association.probability(0, 0), 0.75);
  EXPECT_DOUBLE_EQ(association.miss_probability(0), 0.25);
}

// A group without loops: each track has two possible detections and each detection two possible
// tracks. Message passing is exact for such groups.
TEST(Association, MessagePassingIsExactWithoutLoops) {
  constexpr std::size_t kCount = 12;
  static_assert(kCount > Association::kExactMax);
  test::Random random(3);
  Odds odds(kCount, std::vector<double>(kCount));
  for (std::size_t i = 0; i < kCount; ++i) {
    odds[i][i] = random.uniform(0.1, 10.0);
    if (i + 1 < kCount) {
      odds[i][i + 1] = random.uniform(0.1, 10.0);
    }
  }
  Association association(kCount, kCount);
  set_all(association, odds);
  association.solve();
  expect_marginals(association, Enumeration(odds).marginal, 1e-6);
}

// If one side has at most ten elements, the solution is exact and does not use message passing.
TEST(Association, IsExactUpToTenTracksOrDetections) {
  test::Random random(5);
  for (const auto& [tracks, detections] : {std::pair(3U, 12U), std::pair(12U, 3U)}) {
    Odds odds(tracks, std::vector<double>(detections));
    for (auto& row : odds) {
      for (double& of : row) {
        of = random.uniform(0.1, 3.0);
      }
    }
    Association association(12, 12);
    set_all(association, odds);
    association.solve();
    expect_marginals(association, Enumeration(odds).marginal, 1e-12);
  }
  constexpr std::size_t kTen = Association::kExactMax;
  Odds ring(kTen, std::vector<double>(kTen));
  for (std::size_t i = 0; i < kTen; ++i) {
    ring[i][i] = random.uniform(0.5, 5.0);
    ring[i][(i + 1) % kTen] = random.uniform(0.5, 5.0);
  }
  Association association(kTen, kTen);
  set_all(association, ring);
  association.solve();
  expect_marginals(association, Enumeration(ring).marginal, 1e-12);
}

TEST(Association, MessagePassingIsExactWhicheverSideIsLonger) {
  test::Random random(6);
  for (const auto& [tracks, detections] : {std::pair(11U, 12U), std::pair(12U, 11U)}) {
    Odds odds(tracks, std::vector<double>(detections));
    for (std::size_t i = 0; i < tracks; ++i) {  // the possible pairs form a chain
      for (const std::size_t j : {i, tracks > detections ? i - 1 : i + 1}) {
        if (j < detections) {
          odds[i][j] = random.uniform(0.1, 10.0);
        }
      }
    }
    Association association(12, 12);
    set_all(association, odds);
    association.solve();
    expect_marginals(association, Enumeration(odds).marginal, 1e-6);
  }
}

// The odds change between two solutions. The second solution must not depend on the first.
TEST(Association, SolvesAgainAfterAChange) {
  Association association(2, 2);
  set_all(association, {{3.0, 1.0}, {0.0, 2.0}});
  association.solve();
  EXPECT_GT(association.probability(0, 0), 0.5);
  association.set(0, 0, 0.0);
  association.set(0, 1, 0.0);
  EXPECT_EQ(association.odds(1, 1), 2.0);
  association.solve();
  EXPECT_EQ(association.probability(0, 0), 0.0);
  EXPECT_EQ(association.probability(0, 1), 0.0);
  EXPECT_EQ(association.miss_probability(0), 1.0);
  EXPECT_EQ(association.unassigned_probability(0), 1.0);
  EXPECT_DOUBLE_EQ(association.probability(1, 1), 2.0 / 3.0);
  EXPECT_EQ(association.best()[0], -1);
  EXPECT_EQ(association.best()[1], 1);
}

TEST(Association, IsCertainForInfiniteOdds) {
  Association association(8, 8);
  Odds odds(8, std::vector<double>(8, 1e-3));
  for (std::size_t i = 0; i < 8; ++i) {
    odds[i][i] = 1e60;
  }
  set_all(association, odds);
  association.solve();
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(association.probability(i, i), 1.0, 1e-12);
  }
}

TEST(Association, AllocatesNothingWithinItsCapacity) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "a sanitizer replaces the allocator";
  }
  test::Random random(4);
  Association association(10, 16);
  const test::AllocationCounter allocations;
  for (const int detections : {3, 16, 9}) {
    association.start(10, detections);
    for (int i = 0; i < 10; ++i) {
      for (int j = 0; j < detections; ++j) {
        association.set(i, j, random.uniform(0.0, 2.0));
      }
    }
    static_cast<void>(association.best());
    association.solve();
  }
  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace vantage::estimator
