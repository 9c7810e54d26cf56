#include "models/mapping/occupancy_belief.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "models/mapping/beam.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

const GridGeometry kGrid{{0.0, 0.0}, 0.5, 6, 4};

TEST(OccupancyBelief, BeginsAtOneBitACell) {
  const OccupancyBelief belief(kGrid, 4.0);
  EXPECT_NEAR(belief.entropy_nats(), 24.0 * std::log(2.0), 1e-12);
  EXPECT_EQ(belief.occupancy(5), 0.5);
  EXPECT_FALSE(belief.is_settled(5));
}

TEST(OccupancyBelief, AddsLogOddsAsBayesRuleMultipliesOdds) {
  OccupancyBelief belief(kGrid, 10.0);
  belief.add_log_odds(3, std::log(0.9 / 0.2));  // P(hit | occupied) / P(hit | free)
  EXPECT_NEAR(belief.occupancy(3), 0.9 / (0.9 + 0.2), 1e-12);
  belief.add_log_odds(3, std::log(0.1 / 0.8));  // the same for a miss
  EXPECT_NEAR(belief.occupancy(3), 0.09 / (0.09 + 0.16), 1e-12);
}

TEST(OccupancyBelief, DoesNotDependOnTheOrderBelowTheClamp) {
  test::Random random(4401);
  OccupancyBelief forward(kGrid, 100.0);
  OccupancyBelief backward(kGrid, 100.0);
  std::vector<std::pair<int, double>> changes;
  for (int i = 0; i < 200; ++i) {
    changes.emplace_back(random.integer(0, 23), random.uniform(-1.0, 1.0));
  }
  for (std::size_t i = 0; i < changes.size(); ++i) {
    forward.add_log_odds(changes[i].first, changes[i].second);
    const auto& last = changes[changes.size() - 1 - i];
    backward.add_log_odds(last.first, last.second);
  }
  for (int cell = 0; cell < 24; ++cell) {
    ASSERT_NEAR(forward.log_odds(cell), backward.log_odds(cell), 1e-12);
  }
}

TEST(OccupancyBelief, SettlesAtTheClampAndCanBeUnsettled) {
  OccupancyBelief belief(kGrid, 2.0);
  belief.add_log_odds(0, 5.0);
  EXPECT_EQ(belief.log_odds(0), 2.0);
  EXPECT_EQ(belief.occupancy(0), 1.0);
  EXPECT_NEAR(belief.entropy_nats(0), binary_entropy_nats(probability_of(2.0)), 1e-12);
  belief.add_log_odds(0, -1.0);
  EXPECT_FALSE(belief.is_settled(0));
  belief.add_log_odds(0, -9.0);
  EXPECT_EQ(belief.occupancy(0), 0.0);
}

TEST(OccupancyBelief, EntropyFallsInExpectation) {
  // A look is right with probability 1/(1 + e^−l): the expected entropy after it is that before
  // less the mutual information of a binary channel.
  test::Random random(4402);
  for (int i = 0; i < 1'000; ++i) {
    const double l = random.uniform(0.05, 4.0);
    const double right = probability_of(l);
    OccupancyBelief before(kGrid, 50.0);
    before.add_log_odds(0, random.uniform(-6.0, 6.0));
    OccupancyBelief hit = before;
    OccupancyBelief miss = before;
    hit.add_log_odds(0, l);
    miss.add_log_odds(0, -l);
    const double o = before.occupancy(0);
    const double hits = o * right + (1.0 - o) * (1.0 - right);
    const double after_nats = hits * hit.entropy_nats(0) + (1.0 - hits) * miss.entropy_nats(0);
    const double told_nats = binary_entropy_nats(hits) - binary_entropy_nats(right);
    ASSERT_NEAR(before.entropy_nats(0) - after_nats, told_nats, 1e-12);
    ASSERT_LT(after_nats, before.entropy_nats(0));
  }
}

TEST(OccupancyBelief, RefusesAClampOfNothing) {
  EXPECT_THROW(OccupancyBelief(kGrid, 0.0), UsageError);
  EXPECT_THROW(OccupancyBelief(kGrid, std::nan("")), UsageError);
}

TEST(TraceBeam, LeavesOutTheOwnCellAndEndsBehindAWall) {
  OccupancyBelief belief(kGrid, 2.0);
  belief.add_log_odds(4, 9.0);
  const BeamSensor sensor{1, 1.0, 0.0, 10.0, 0.01};
  BeamProfile beam;
  trace_beam(belief, sensor, {0.75, 0.25}, 0.0, beam);
  EXPECT_EQ(beam.cell, (std::vector<int>{2, 3, 4}));
  EXPECT_NEAR(beam.enter_m[0], 0.25, 1e-12);
  EXPECT_NEAR(beam.exit_m[2], 1.75, 1e-12);
  EXPECT_EQ(beam.occupancy[2], 1.0);
}

TEST(BeamSensor, SpreadsItsBeamsOverItsFieldOfView) {
  const BeamSensor circle{4, 2.0 * kPi, 0.0, 1.0, 0.01};
  EXPECT_NEAR(circle.bearing_rad(1), kPi / 2.0, 1e-12);
  EXPECT_NEAR(circle.bearing_rad(3), -kPi / 2.0, 1e-12);
  const BeamSensor fan{3, 1.0, 0.0, 1.0, 0.01};
  EXPECT_NEAR(fan.bearing_rad(0), -0.5, 1e-12);
  EXPECT_NEAR(fan.bearing_rad(2), 0.5, 1e-12);
  EXPECT_EQ((BeamSensor{1, 1.0, 0.0, 1.0, 0.01}).bearing_rad(0), 0.0);
}

TEST(BeamSensor, RefusesNumbersThatMakeNoSense) {
  EXPECT_NO_THROW(require_valid(BeamSensor{}));
  EXPECT_THROW(require_valid(BeamSensor{0, 1.0, 0.0, 1.0, 0.01}), UsageError);
  EXPECT_THROW(require_valid(BeamSensor{1, 7.0, 0.0, 1.0, 0.01}), UsageError);
  EXPECT_THROW(require_valid(BeamSensor{1, 1.0, 2.0, 1.0, 0.01}), UsageError);
  EXPECT_THROW(require_valid(BeamSensor{1, 1.0, 0.0, 1.0, 0.0}), UsageError);
}

}  // namespace
}  // namespace vantage::models
