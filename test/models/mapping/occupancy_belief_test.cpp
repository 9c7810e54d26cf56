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

TEST(OccupancyBelief, StartsAtOneBitPerCell) {
  const OccupancyBelief belief(kGrid, 4.0);
  EXPECT_NEAR(belief.entropy_nats(), 24.0 * std::log(2.0), 1e-12);
  EXPECT_EQ(belief.occupancy(5), 0.5);
}

TEST(OccupancyBelief, AddsLogOddsByBayesRule) {
  OccupancyBelief belief(kGrid, 10.0);
  belief.add_log_odds(3, std::log(0.9 / 0.2));  // P(hit | occupied) / P(hit | free)
  EXPECT_NEAR(belief.occupancy(3), 0.9 / (0.9 + 0.2), 1e-12);
  belief.add_log_odds(3, std::log(0.1 / 0.8));  // P(miss | occupied) / P(miss | free)
  EXPECT_NEAR(belief.occupancy(3), 0.09 / (0.09 + 0.16), 1e-12);
}

TEST(OccupancyBelief, IsIndependentOfTheOrderBelowTheClamp) {
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

TEST(OccupancyBelief, StopsAtTheClampAndLeavesItAfterOppositeEvidence) {
  OccupancyBelief belief(kGrid, 2.0);
  belief.add_log_odds(0, 5.0);
  EXPECT_EQ(belief.log_odds(0), 2.0);
  EXPECT_EQ(belief.occupancy(0), 1.0);
  EXPECT_NEAR(belief.entropy_nats(0), binary_entropy_nats(probability_of(2.0)), 1e-12);
  belief.add_log_odds(0, -1.0);
  EXPECT_EQ(belief.occupancy(0), probability_of(1.0));
  belief.add_log_odds(0, -9.0);
  EXPECT_EQ(belief.occupancy(0), 0.0);
}

TEST(OccupancyBelief, EntropyFallsInExpectation) {
  // An observation is correct with probability 1/(1 + e^−l). The expected entropy falls by the
  // mutual information of a binary channel.
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

TEST(OccupancyBelief, RefusesAZeroClamp) {
  EXPECT_THROW(OccupancyBelief(kGrid, 0.0), UsageError);
  EXPECT_THROW(OccupancyBelief(kGrid, std::nan("")), UsageError);
}

TEST(TraceBeam, ExcludesTheRobotsCellAndEndsAtAWall) {
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

TEST(BeamSensor, RefusesInvalidValues) {
  EXPECT_NO_THROW(require_valid(BeamSensor{}));
  EXPECT_THROW(require_valid(BeamSensor{0, 1.0, 0.0, 1.0, 0.01}), UsageError);
  EXPECT_THROW(require_valid(BeamSensor{1, 7.0, 0.0, 1.0, 0.01}), UsageError);
  EXPECT_THROW(require_valid(BeamSensor{1, 1.0, 2.0, 1.0, 0.01}), UsageError);
  EXPECT_THROW(require_valid(BeamSensor{1, 1.0, 0.0, 1.0, 0.0}), UsageError);
}

// Checks each rule just within and just beyond its limit.
TEST(BeamSensor, AcceptsValuesUpToTheirLimits) {
  const auto is_valid = [](const BeamSensor& sensor) {
    try {
      require_valid(sensor);
      return true;
    } catch (const UsageError&) {
      return false;
    }
  };
  EXPECT_TRUE(is_valid({1, 1e-9, 0.0, 1e-9, 1e-9}));
  EXPECT_TRUE(is_valid({1'000, 2.0 * kPi, 0.5, 0.5 + 1e-9, 1e9}));
  EXPECT_FALSE(is_valid({0, 1.0, 0.0, 1.0, 0.01}));
  EXPECT_FALSE(is_valid({1, 0.0, 0.0, 1.0, 0.01}));
  EXPECT_FALSE(is_valid({1, -1.0, 0.0, 1.0, 0.01}));
  EXPECT_FALSE(is_valid({1, std::nextafter(2.0 * kPi, 7.0), 0.0, 1.0, 0.01}));
  EXPECT_FALSE(is_valid({1, std::nan(""), 0.0, 1.0, 0.01}));
  EXPECT_FALSE(is_valid({1, 1.0, -1e-9, 1.0, 0.01}));
  EXPECT_FALSE(is_valid({1, 1.0, 0.5, 0.5, 0.01}));
  EXPECT_FALSE(is_valid({1, 1.0, 0.5, INFINITY, 0.01}));
  EXPECT_FALSE(is_valid({1, 1.0, 0.0, 1.0, INFINITY}));
  EXPECT_FALSE(is_valid({1, 1.0, 0.0, 1.0, -0.01}));
}

// The beams of a full circle are spread evenly. The beams of a fan are spread from edge to edge. A
// single beam points straight ahead. A distance outside the range gives the reading of the nearer
// limit.
TEST(BeamSensor, HasTheStatedDefaults) {
  for (const int beams : {1, 2, 5, 8}) {
    const BeamSensor circle{beams, 2.0 * kPi, 0.0, 1.0, 0.01};
    const BeamSensor fan{beams, 3.0, 0.0, 1.0, 0.01};
    for (int k = 0; k < beams; ++k) {
      EXPECT_NEAR(wrap_to_pi(circle.bearing_rad(k) - 2.0 * kPi * k / beams), 0.0, 1e-12);
      EXPECT_LE(std::abs(circle.bearing_rad(k)), kPi);
      const double expected = beams == 1 ? 0.0 : -1.5 + 3.0 * k / (beams - 1.0);
      EXPECT_NEAR(fan.bearing_rad(k), expected, 1e-12);
    }
  }
  const BeamSensor sensor{1, 1.0, 0.5, 2.0, 0.1};
  EXPECT_EQ(sensor.mean_range_m(0.5), 0.5);
  EXPECT_EQ(sensor.mean_range_m(std::nextafter(0.5, 0.0)), 0.0);
  EXPECT_EQ(sensor.mean_range_m(2.0), 2.0);
  EXPECT_EQ(sensor.mean_range_m(9.0), 2.0);
  EXPECT_EQ(sensor.mean_range_m(1.3), 1.3);
  EXPECT_NEAR(sensor.no_hit_range_m(), 1.7, 1e-12);
  // Default values in a scenario.
  EXPECT_EQ(BeamSensor{}.beams, 48);
  EXPECT_EQ(BeamSensor{}.field_of_view_rad, 2.0 * kPi);
  EXPECT_EQ(BeamSensor{}.range_min_m, 0.0);
  EXPECT_EQ(BeamSensor{}.range_max_m, 1.5);
  EXPECT_EQ(BeamSensor{}.sigma_m, 0.01);
}

// A ray from outside the grid, or from the last cell outwards, empties the profile, for any
// previous content.
TEST(TraceBeam, IsEmptyForAnEmptyRay) {
  const OccupancyBelief belief(kGrid, 2.0);
  const BeamSensor sensor{1, 1.0, 0.0, 10.0, 0.01};
  BeamProfile beam;
  for (const Eigen::Vector2d& from_m : {Eigen::Vector2d(-0.1, 0.2), Eigen::Vector2d(2.9, 0.2)}) {
    beam.push_back(3, 0.5, 0.1, 0.2);
    trace_beam(belief, sensor, from_m, 0.0, beam);
    EXPECT_EQ(beam.size(), 0);
    EXPECT_TRUE(beam.cell.empty());
    EXPECT_TRUE(beam.enter_m.empty());
    EXPECT_TRUE(beam.exit_m.empty());
  }
  trace_beam(belief, BeamSensor{1, 1.0, 0.0, 0.7, 0.01}, {0.25, 0.25}, 0.0, beam);
  EXPECT_EQ(beam.cell, (std::vector<int>{1}));
  EXPECT_EQ(beam.occupancy, (std::vector<double>{0.5}));
  EXPECT_NEAR(beam.exit_m[0], 0.7, 1e-12) << "up to the maximum range";
}

TEST(Probabilities, ConvertToLogOddsAndBack) {
  for (const double p : {0.01, 0.3, 0.5, 0.95}) {
    EXPECT_NEAR(probability_of(log_odds_of(p)), p, 1e-12);
    EXPECT_NEAR(log_odds_of(1.0 - p), -log_odds_of(p), 1e-12);
    EXPECT_NEAR(binary_entropy_nats(p), -p * std::log(p) - (1.0 - p) * std::log(1.0 - p), 1e-12);
  }
  EXPECT_EQ(binary_entropy_nats(0.0), 0.0);
  EXPECT_EQ(binary_entropy_nats(1.0), 0.0);
}

}  // namespace
}  // namespace vantage::models
