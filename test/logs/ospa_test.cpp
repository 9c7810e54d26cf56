#include "logs/metrics/ospa.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "test/support/random.hpp"

namespace vantage::logs {
namespace {

std::vector<Labelled> points(test::Random& random, int count) {
  std::vector<Labelled> out;
  for (int i = 0; i < count; ++i) {
    out.push_back({i, random.vector<2>(-2.0, 2.0)});
  }
  return out;
}

// Computes OSPA by its definition: the minimum over all pairings of the smaller set with the
// larger.
double by_definition(std::vector<Labelled> a, std::vector<Labelled> b, double c_m) {
  if (a.size() > b.size()) {
    std::swap(a, b);
  }
  std::vector<std::size_t> order(b.size());
  std::iota(order.begin(), order.end(), 0U);
  double least = 1e300;
  do {
    double sum = c_m * c_m * static_cast<double>(b.size() - a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double d_m = (a[i].position_m - b[order[i]].position_m).norm();
      sum += std::pow(std::min(c_m, d_m), 2);
    }
    least = std::min(least, sum);
  } while (std::next_permutation(order.begin(), order.end()));
  return b.empty() ? 0.0 : std::sqrt(least / static_cast<double>(b.size()));
}

TEST(OspaJudge, EqualsTheMinimumOverAllPairings) {
  test::Random random(1);
  OspaJudge judge(1.3);
  for (int trial = 0; trial < 200; ++trial) {
    const auto truth = points(random, random.integer(0, 6));
    const auto estimates = points(random, random.integer(0, 6));
    EXPECT_NEAR(judge.judge(truth, estimates).ospa_m, by_definition(truth, estimates, 1.3), 1e-12);
  }
}

TEST(OspaJudge, MatchesManualValues) {
  OspaJudge judge(1.0);
  EXPECT_DOUBLE_EQ(judge.judge({}, {}).ospa_m, 0.0);
  const std::vector<Labelled> one = {{0, {0.0, 0.0}}};
  EXPECT_DOUBLE_EQ(judge.judge(one, {}).ospa_m, 1.0);
  const std::vector<Labelled> near = {{0, {0.3, 0.4}}};
  EXPECT_DOUBLE_EQ(judge.judge(one, near).ospa_m, 0.5);
  const std::vector<Labelled> far = {{0, {3.0, 4.0}}};
  EXPECT_DOUBLE_EQ(judge.judge(one, far).ospa_m, 1.0);
  EXPECT_DOUBLE_EQ(judge.judge(one, far).matched_rmse_m, 5.0);
  const std::vector<Labelled> both = {{0, {0.3, 0.4}}, {1, {9.0, 9.0}}};
  EXPECT_DOUBLE_EQ(judge.judge(one, both).ospa_m, std::sqrt((0.25 + 1.0) / 2.0));
}

// OSPA is a metric: the triangle inequality holds for random sets.
TEST(OspaJudge, IsAMetric) {
  test::Random random(2);
  OspaJudge judge(1.0);
  for (int trial = 0; trial < 200; ++trial) {
    const auto a = points(random, random.integer(0, 5));
    const auto b = points(random, random.integer(0, 5));
    const auto c = points(random, random.integer(0, 5));
    const double ab_m = judge.judge(a, b).ospa_m;
    EXPECT_NEAR(ab_m, judge.judge(b, a).ospa_m, 1e-12);
    EXPECT_LE(judge.judge(a, c).ospa_m, ab_m + judge.judge(b, c).ospa_m + 1e-12);
  }
}

TEST(OspaJudge, CountsATrackSwap) {
  OspaJudge judge(1.0);
  const std::vector<Labelled> truth = {{0, {0.0, 0.0}}, {1, {5.0, 0.0}}};
  judge.judge(truth, std::vector<Labelled>{{10, {0.1, 0.0}}, {11, {5.1, 0.0}}});
  EXPECT_EQ(judge.swaps(), 0);
  judge.judge(truth, std::vector<Labelled>{{11, {0.1, 0.0}}, {10, {5.1, 0.0}}});
  EXPECT_EQ(judge.swaps(), 2);
  judge.judge(truth, {});  // losing a track is not a swap
  judge.judge(truth, std::vector<Labelled>{{11, {0.1, 0.0}}});
  EXPECT_EQ(judge.swaps(), 2);
  judge.judge(truth, std::vector<Labelled>{{12, {0.1, 0.0}}});
  EXPECT_EQ(judge.swaps(), 3);
}

// matched_rmse_m has no cutoff: it uses the minimum sum of squares over all pairings of the smaller
// set with the larger.
TEST(OspaJudge, MatchesTheSmallerSetOptimally) {
  test::Random random(3);
  OspaJudge judge(0.7);
  for (int trial = 0; trial < 200; ++trial) {
    const auto truth = points(random, random.integer(0, 5));
    const auto estimates = points(random, random.integer(0, 5));
    const SetError error = judge.judge(truth, estimates);
    const auto pairs = std::min(truth.size(), estimates.size());
    EXPECT_EQ(error.pairs, static_cast<int>(pairs));
    // The reference uses a cutoff that is never reached, and then removes the unpaired points.
    const double cutoff_m = 1e3;
    const double most = static_cast<double>(std::max(truth.size(), estimates.size()));
    const double all_m2 = std::pow(by_definition(truth, estimates, cutoff_m), 2) * most;
    const double matched_m2 = all_m2 - cutoff_m * cutoff_m * (most - static_cast<double>(pairs));
    EXPECT_NEAR(error.matched_rmse_m,
                pairs == 0 ? 0.0 : std::sqrt(matched_m2 / static_cast<double>(pairs)), 1e-5);
  }
}

// A swap counts only if the new track is nearer to the target than the cutoff, whichever set is
// larger.
TEST(OspaJudge, CountsSwapsOfNearTracksOnly) {
  const auto at = [](std::int64_t label, double x_m) { return Labelled{label, {x_m, 0.0}}; };
  for (const bool has_more_tracks : {false, true}) {
    OspaJudge judge(1.0);
    std::vector<Labelled> truth{at(0, 0.0), at(1, 10.0), at(2, 20.0)};
    std::vector<Labelled> tracks{at(7, 0.5), at(8, 10.5)};
    if (has_more_tracks) {
      truth.resize(1);
    }
    judge.judge(truth, tracks);
    tracks[0].label = 9;
    tracks[0].position_m.x() = 1.001;
    judge.judge(truth, tracks);
    EXPECT_EQ(judge.swaps(), 0) << "too far away to be its track";
    tracks[0].position_m.x() = -0.999;
    judge.judge(truth, tracks);
    EXPECT_EQ(judge.swaps(), 1);
    judge.judge(truth, tracks);
    EXPECT_EQ(judge.swaps(), 1) << "the same track as before";
    tracks[0].label = 7;
    judge.judge(truth, tracks);
    EXPECT_EQ(judge.swaps(), 2) << "a swap back counts, too";
  }
}

}  // namespace
}  // namespace vantage::logs
