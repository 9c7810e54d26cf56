#include "models/exchange/compact_belief.hpp"

#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/index.hpp"
#include "core/uniform.hpp"

namespace vantage::models {
namespace {

constexpr std::int64_t kNowUtime = 1'700'000'000'000'000;
const Time kNow = from_utime(kNowUtime);

/// Returns a random Gaussian. Its largest σ is up to 10⁴ times its smallest σ; its mean is at most
/// `reach_m` from the origin.
Gaussian random_belief(std::mt19937_64& random, int dim, double reach_m) {
  StateMatrix G(dim, dim);
  StateVector mean(dim);
  for (int i = 0; i < dim; ++i) {
    mean(i) = uniform(random, -reach_m, reach_m);
    const double scale = std::exp(uniform(random, std::log(1e-3), std::log(1e1)));
    for (int j = 0; j < dim; ++j) {
      G(i, j) = scale * uniform(random, -1.0, 1.0);
    }
  }
  const StateMatrix covariance = G * G.transpose() + 1e-6 * StateMatrix::Identity(dim, dim);
  return {mean, 0.5 * (covariance + covariance.transpose())};
}

double least_eigenvalue(const StateMatrix& M) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(M)).eigenvalues()(0);
}

TEST(CompactTarget, IsNeverMoreConfidentThanTheBelief) {
  std::mt19937_64 random(1);
  int rounded = 0;
  for (int i = 0; i < 20'000; ++i) {
    const int dim = 2 + i % 3;
    const Gaussian exact = random_belief(random, dim, i % 2 == 0 ? 50.0 : 1e5);
    const auto target = compact({7, *to_information(exact), kNow}, kNow);
    if (!target) {
      continue;
    }
    ++rounded;
    const auto back = expand(*target);
    ASSERT_TRUE(back);
    const StateVector shift = exact.mean - back->mean;
    const StateMatrix excess = back->covariance - exact.covariance - shift * shift.transpose();
    // Compare in units of the decoded σ, so that small axes count as much as large ones.
    const StateVector inverse_sigma = back->covariance.diagonal().cwiseSqrt().cwiseInverse();
    const StateMatrix scaled = inverse_sigma.asDiagonal() * excess * inverse_sigma.asDiagonal();
    ASSERT_GE(least_eigenvalue(scaled), -1e-9) << "sample " << i;
  }
  EXPECT_GT(rounded, 19'900);
}

TEST(CompactTarget, InflatesVariancesByLessThanTwoPerThousand) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 2000; ++i) {
    const Gaussian exact = random_belief(random, 4, 50.0);
    const auto target = compact({7, *to_information(exact), kNow}, kNow);
    ASSERT_TRUE(target);
    const auto back = expand(*target);
    for (int k = 0; k < 4; ++k) {
      EXPECT_LT(back->covariance(k, k), 1.002 * exact.covariance(k, k));
      EXPECT_NEAR(back->mean(k), exact.mean(k), 4e-6);
    }
  }
}

TEST(CompactTarget, RoundsTheAgeOfTheMeasurementUp) {
  const Information information{StateVector::Zero(2), StateMatrix::Identity(2, 2)};
  EXPECT_EQ(compact({0, information, kNow}, kNow)->unseen_ms, 0);
  EXPECT_EQ(compact({0, information, kNow - Duration{1}}, kNow)->unseen_ms, 1);
  EXPECT_EQ(compact({0, information, kNow - Duration{2'000'001}}, kNow)->unseen_ms, 2001);
}

TEST(CompactTarget, RefusesABeliefWithoutCovariance) {
  EXPECT_FALSE(compact({0, {StateVector::Zero(2), StateMatrix::Zero(2, 2)}, kNow}, kNow));
}

struct InvalidRow {
  const char* what;
  void (*spoil)(CompactTarget&);
};

TEST(CompactTarget, RefusesImpossibleValues) {
  const Information information{StateVector::Zero(3), StateMatrix::Identity(3, 3)};
  const CompactTarget good = *compact({0, information, kNow}, kNow);
  ASSERT_TRUE(expand(good));
  const InvalidRow rows[] = {
      {"dimension", [](CompactTarget& t) { t.dim = 5; }},
      {"mean", [](CompactTarget& t) { t.mean[1] = NAN; }},
      {"age", [](CompactTarget& t) { t.unseen_ms = -1; }},
      {"correlation below -1", [](CompactTarget& t) { t.correlation_code[0] = -32'768; }},
      {"correlation of 1", [](CompactTarget& t) { t.correlation_code[2] = 32'767; }},
      {"not definite", [](CompactTarget& t) {
         t.correlation_code = {30'000, -30'000, 30'000};
       }}};
  for (const InvalidRow& row : rows) {
    CompactTarget bad = good;
    row.spoil(bad);
    EXPECT_FALSE(expand(bad)) << row.what;
  }
}

TEST(CellAge, IsRoundedUpByAtMostHalfASecondOrFivePercent) {
  for (std::int64_t us = 0; us <= cell_age_max().count(); us = us * 21 / 20 + 100'000) {
    const auto code = cell_age_code(Duration{us});
    ASSERT_TRUE(code) << us;
    EXPECT_GE(cell_age(*code).count(), us);
    EXPECT_LE(cell_age(*code).count(), us + std::max<std::int64_t>(500'000, us / 20)) << us;
  }
  EXPECT_FALSE(cell_age_code(Duration{-1}));
  EXPECT_FALSE(cell_age_code(cell_age_max() + Duration{1}));
}

TEST(CellAge, KeepsMultiplesOfTheStepExactly) {
  for (std::int64_t us = 0; us <= 64'000'000; us += 500'000) {
    EXPECT_EQ(cell_age(*cell_age_code(Duration{us})).count(), us);
  }
}

TEST(Runs, AreEncodedInTheDocumentedBytes) {
  std::vector<std::uint8_t> runs;
  append_run(runs, 3, 200, 7);
  append_run(runs, 300, 1, 255);
  EXPECT_EQ(runs, (std::vector<std::uint8_t>{3, 0xC8, 0x01, 7, 0xAC, 0x02, 1, 255}));
}

CompactBelief with_runs(std::vector<std::uint8_t> runs) {
  CompactBelief belief;
  belief.stamp.time = kNow;
  belief.grid = {{0.0, 0.0}, 1.0, 4, 3};
  belief.runs = std::move(runs);
  return belief;
}

TEST(CompactBelief, ExpandsRunsToCells) {
  const auto belief = expand(with_runs({1, 2, 0, 5, 4, 4}));
  ASSERT_TRUE(belief);
  std::vector<std::int64_t> expected(12, 0);
  expected[1] = expected[2] = kNowUtime;
  expected[8] = expected[9] = expected[10] = expected[11] = kNowUtime - 2'000'000;
  EXPECT_EQ(belief->last_seen_utime, expected);
}

TEST(CompactBelief, HasNoCellsWithoutRuns) {
  const auto belief = expand(with_runs({}));
  ASSERT_TRUE(belief);
  EXPECT_TRUE(belief->last_seen_utime.empty());
}

TEST(CompactBelief, RefusesMalformedRuns) {
  const std::vector<std::uint8_t> rows[] = {
      {0},                                    // no length
      {0, 1},                                 // no age
      {0, 0, 0},                              // empty run
      {0, 13, 0},                             // beyond the grid
      {12, 1, 0},                             // begins beyond the grid
      {0, 6, 0, 0, 7, 0},                     // second run beyond the grid
      {0x80, 0x80, 0x80, 0x80, 0x00, 1, 0}};  // more than 28 bits
  for (const auto& runs : rows) {
    EXPECT_FALSE(is_valid(with_runs(runs)));
    EXPECT_FALSE(expand(with_runs(runs)));
  }
}

TEST(CompactBelief, RefusesIdsThatDoNotAscend) {
  const Information information{StateVector::Zero(2), StateMatrix::Identity(2, 2)};
  CompactBelief belief = with_runs({});
  belief.targets = {*compact({3, information, kNow}, kNow), *compact({3, information, kNow}, kNow)};
  EXPECT_FALSE(is_valid(belief));
  belief.targets[1].target_id = 4;
  EXPECT_TRUE(is_valid(belief));
}

}  // namespace
}  // namespace vantage::models
