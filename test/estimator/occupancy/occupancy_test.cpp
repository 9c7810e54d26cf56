#include "estimator/occupancy/occupancy.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "models/mapping/beam_scan.hpp"
#include "models/mapping/cell_counts.hpp"
#include "models/mapping/ray_walk.hpp"
#include "test/support/random.hpp"

namespace vantage::estimator {
namespace {

using models::BeamSensor;
using models::GridGeometry;
using models::OccupancyBelief;

const BeamSensor kScanner{96, 2.0 * kPi, 0.0, 1.5, 0.01};
const BeamSensor kBeam{1, 1.0, 0.0, 1.5, 0.01};
const GridGeometry kLine{{0.0, 0.0}, 0.2, 12, 1};

std::vector<double> log_odds_after(double range_m) {
  OccupancyBelief belief(kLine, 9.0);
  OccupancyFusion(kBeam, {2.0, -1.0}).fuse({0.1, 0.1, 0.0}, std::vector<double>{range_m}, belief);
  std::vector<double> result;
  for (int cell = 0; cell < kLine.size(); ++cell) {
    result.push_back(belief.log_odds(cell));
  }
  return result;
}

TEST(OccupancyFusion, MarksCellsFreeUpToTheHit) {
  EXPECT_EQ(log_odds_after(0.6), (std::vector<double>{-1, -1, -1, 2, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(OccupancyFusion, AssignsASurfaceToItsCellDespiteNoise) {
  // Cell 3 begins at 0.5 m along the beam.
  for (const double noise_m : {-0.015, -0.01, 0.0, 0.01, 0.03}) {
    const std::vector<double> l = log_odds_after(0.5 + noise_m);
    EXPECT_EQ(l[3], 2.0) << noise_m;
    EXPECT_EQ(l[2], -1.0) << noise_m;
  }
}

// A hit within the vehicle's own cell changes no cell.
TEST(OccupancyFusion, IgnoresHitsInTheRobotsCell) {
  for (const double range_m : {0.0, 0.02, 0.05, 0.079}) {
    EXPECT_EQ(log_odds_after(range_m), std::vector<double>(12, 0.0)) << range_m;
  }
  const std::vector<double> next = log_odds_after(0.12);
  EXPECT_EQ(next[0], -1.0);
  EXPECT_EQ(next[1], 2.0);
}

TEST(OccupancyFusion, MarksNoHitAtMaximumRange) {
  const std::vector<double> l = log_odds_after(1.49);
  for (const double log_odds : l) {
    EXPECT_LE(log_odds, 0.0);
  }
  EXPECT_EQ(l[7], -1.0);
  EXPECT_EQ(l[9], 0.0) << "beyond the range";
}

TEST(OccupancyFusion, PrefersAHitToMissesOfTheSameScan) {
  const models::World world{{{0.0, 0.0}, {4.0, 4.0}}, 3.0, {{{{0.0, 2.31}, {4.0, 4.0}}, 3.0}}, {}};
  OccupancyBelief belief(GridGeometry::covering(world.bounds, 0.2), 20.0);
  test::Random random(4801);
  const Pose2 at{2.03, 1.51, 0.3};
  const std::vector<double> ranges_m = models::beam_scan(world, kScanner, at, random.engine());
  OccupancyFusion(kScanner, {}).fuse(at, ranges_m, belief);
  // Beams that end farther along the wall also pass through the wall's row of cells.
  int hits = 0;
  for (int column = 6; column <= 14; ++column) {
    const double l = belief.log_odds(11 * 20 + column);
    hits += l == models::InverseBeamModel{}.hit_log_odds ? 1 : 0;
    EXPECT_GE(l, 0.0) << column;
  }
  EXPECT_GE(hits, 8);
}

TEST(OccupancyFusion, FindsTheTrueMap) {
  const models::World world{{{0.0, 0.0}, {6.0, 6.0}},
                            3.0,
                            {{{{1.07, 1.13}, {2.49, 2.31}}, 3.0}, {{{3.9, 2.2}, {4.7, 5.1}}, 3.0}},
                            {}};
  OccupancyBelief belief(GridGeometry::covering(world.bounds, 0.2), 4.595);
  OccupancyFusion fusion(kScanner, {});
  test::Random random(4802);
  double entropy_nats = belief.entropy_nats();
  for (int i = 0; i < 150; ++i) {
    const Pose2 at{random.uniform(0.1, 5.9), random.uniform(0.1, 5.9), random.uniform(-kPi, kPi)};
    if (models::clearance_m(world, at.position_m()) > 0.2) {
      fusion.fuse(at, models::beam_scan(world, kScanner, at, random.engine()), belief);
    }
  }
  EXPECT_LT(belief.entropy_nats(), 0.35 * entropy_nats);
  int known = 0;
  for (int cell = 0; cell < belief.geometry().size(); ++cell) {
    const double clearance_m = models::clearance_m(world, belief.geometry().centre_m(cell));
    if (std::abs(clearance_m) > 0.15 && std::abs(belief.log_odds(cell)) > 2.0) {
      ++known;
      ASSERT_EQ(belief.occupancy(cell) > 0.5, clearance_m < 0.0) << cell;
    }
  }
  EXPECT_GT(known, 600);
}

TEST(OccupancyFusion, IsIndependentOfScanOrderBelowSaturation) {
  const models::World world{{{0.0, 0.0}, {4.0, 4.0}}, 3.0, {{{{1.1, 1.1}, {2.1, 2.4}}, 3.0}}, {}};
  test::Random random(4803);
  std::vector<Pose2> poses;
  std::vector<std::vector<double>> scans;
  for (int i = 0; i < 12; ++i) {
    poses.push_back({random.uniform(2.3, 3.8), random.uniform(0.2, 3.8), random.uniform(-3, 3)});
    scans.push_back(models::beam_scan(world, kScanner, poses.back(), random.engine()));
  }
  OccupancyBelief forward(GridGeometry::covering(world.bounds, 0.2), 1e3);
  OccupancyBelief backward = forward;
  OccupancyFusion fusion(kScanner, {});
  for (std::size_t i = 0; i < 12; ++i) {
    fusion.fuse(poses[i], scans[i], forward);
    fusion.fuse(poses[11 - i], scans[11 - i], backward);
  }
  for (int cell = 0; cell < forward.geometry().size(); ++cell) {
    ASSERT_NEAR(forward.log_odds(cell), backward.log_odds(cell), 1e-9);
  }
}

TEST(OccupancyFusion, LowersEntropyOverMapsDrawnFromTheBelief) {
  test::Random random(4804);
  OccupancyFusion fusion(kBeam, {});
  double change_nats = 0.0;
  for (int i = 0; i < 4'000; ++i) {
    OccupancyBelief belief(kLine, 9.0);
    double distance_m = 99.0;
    models::RayWalk walk(kLine, {0.1, 0.1}, 0.0, kBeam.range_max_m);
    for (walk.next(); walk.next();) {
      belief.add_log_odds(walk.cell(), random.uniform(-3.0, 1.0));
      const bool is_occupied = random.uniform(0.0, 1.0) < belief.occupancy(walk.cell());
      distance_m = is_occupied ? std::min(distance_m, walk.enter_m()) : distance_m;
    }
    const double before_nats = belief.entropy_nats();
    const double range_m = kBeam.mean_range_m(distance_m) + kBeam.sigma_m * random.normal();
    fusion.fuse({0.1, 0.1, 0.0}, std::vector<double>{range_m}, belief);
    change_nats += belief.entropy_nats() - before_nats;
  }
  EXPECT_LT(change_nats / 4'000, -0.3);
}

TEST(OccupancyFusion, IgnoresAndCountsInvalidScans) {
  OccupancyBelief belief(kLine, 9.0);
  const double before_nats = belief.entropy_nats();
  const BeamSensor fan{3, 0.2, 0.5, 1.5, 0.01};
  OccupancyFusion fusion(fan, {});
  const double nan = std::nan("");
  const Pose2 at{0.1, 0.1, 0.0};
  EXPECT_EQ(fusion.fuse(at, std::vector<double>{nan, -0.5, 0.01}, belief).ignored, 3);
  EXPECT_EQ(fusion.fuse(at, std::vector<double>{1.0, 1.0}, belief).ignored, 2);
  EXPECT_EQ(fusion.fuse({-3.0, 0.1, 0.0}, std::vector<double>{1.0, 1.0, 1.0}, belief).ignored, 3);
  EXPECT_EQ(fusion.fuse({0.1, 0.1, nan}, std::vector<double>{1.0, 1.0, 1.0}, belief).ignored, 3);
  EXPECT_EQ(belief.entropy_nats(), before_nats);
  const ScanCounts counts = fusion.fuse(
      at, std::vector<double>{std::numeric_limits<double>::infinity(), 1.0, 1.5}, belief);
  EXPECT_EQ(counts.ignored, 1);
  EXPECT_EQ(counts.hits, 1);
  EXPECT_EQ(counts.misses, 1);
}

TEST(OccupancyFusion, RefusesAnInvertedSensorModel) {
  EXPECT_THROW(OccupancyFusion(kBeam, {-1.0, -1.0}), UsageError);
  EXPECT_THROW(OccupancyFusion(kBeam, {1.0, 1.0}), UsageError);
  EXPECT_THROW(OccupancyFusion({0, 1.0, 0.0, 1.0, 0.1}, {}), UsageError);
}

// A reading that is below the minimum range by more than the noise is ignored.
TEST(OccupancyFusion, IgnoresReadingsBelowTheMinimumRange) {
  for (const double least_m : {0.0, 0.5}) {
    const BeamSensor sensor{1, 1.0, least_m, 1.5, 0.02};
    for (const auto& [off_m, is_used] : {std::pair(-0.061, false), std::pair(-0.059, true)}) {
      OccupancyBelief belief(kLine, 9.0);
      const ScanCounts counts =
          OccupancyFusion(sensor, {})
              .fuse({0.1, 0.1, 0.0}, std::vector<double>{least_m + off_m}, belief);
      EXPECT_EQ(counts.ignored, is_used ? 0 : 1);
      EXPECT_EQ(counts.hits, is_used ? 1 : 0);
      EXPECT_EQ(counts.misses, 0);
    }
  }
}

TEST(OccupancyFusion, CountsNoHitNearMaximumRange) {
  for (const auto& [range_m, is_hit] : {std::pair(1.469, true), std::pair(1.471, false)}) {
    OccupancyBelief belief(kLine, 9.0);
    const ScanCounts counts =
        OccupancyFusion(kBeam, {}).fuse({0.1, 0.1, 0.0}, std::vector<double>{range_m}, belief);
    EXPECT_EQ(counts.hits, is_hit ? 1 : 0);
    EXPECT_EQ(counts.misses, is_hit ? 0 : 1);
  }
}

// With large noise, a cell before the hit is marked free only if its centre is closer than the
// reading.
TEST(OccupancyFusion, MarksCellsCloserThanTheHitFree) {
  const BeamSensor noisy{1, 1.0, 0.0, 1.5, 0.1};
  for (const auto& [range_m, of_middle] : {std::pair(0.39, 0.0), std::pair(0.41, -1.0)}) {
    OccupancyBelief belief(kLine, 9.0);  // centres at 0.2, 0.4, … m from the vehicle
    OccupancyFusion(noisy, {2.0, -1.0}).fuse({0.1, 0.1, 0.0}, std::vector<double>{range_m}, belief);
    EXPECT_EQ(belief.log_odds(0), -1.0);
    EXPECT_EQ(belief.log_odds(1), -1.0);
    EXPECT_EQ(belief.log_odds(2), of_middle);
    EXPECT_EQ(belief.log_odds(3), 2.0);
    EXPECT_EQ(belief.log_odds(4), 0.0);
  }
  OccupancyBelief belief(kLine, 9.0);  // reading < 0 by noise: own cell is free
  OccupancyFusion(noisy, {2.0, -1.0}).fuse({0.1, 0.1, 0.0}, std::vector<double>{-0.05}, belief);
  EXPECT_EQ(belief.log_odds(0), -1.0);
  EXPECT_EQ(belief.log_odds(1), 2.0);
}

// Counting and fusing a scan visit the same cells, each cell once, also for successive scans.
TEST(OccupancyFusion, CountsUpdatedCells) {
  const models::World world{{{0.0, 0.0}, {4.0, 4.0}}, 3.0, {{{{1.1, 1.1}, {2.1, 2.4}}, 3.0}}, {}};
  const GridGeometry grid = GridGeometry::covering(world.bounds, 0.2);
  test::Random random(4805);
  OccupancyBelief belief(grid, 1e6);
  models::CellCounts looks(static_cast<std::size_t>(grid.size()), 0);
  OccupancyFusion fusing(kScanner, {1.0, -1.0});
  OccupancyFusion counting(kScanner, {1.0, -1.0});
  for (int i = 0; i < 5; ++i) {
    const Pose2 at{random.uniform(2.3, 3.8), random.uniform(0.2, 3.8), random.uniform(-3.0, 3.0)};
    const std::vector<double> scan = models::beam_scan(world, kScanner, at, random.engine());
    const ScanCounts fused = fusing.fuse(at, scan, belief);
    const ScanCounts counted = counting.count(grid, at, scan, looks);
    EXPECT_EQ(fused.hits, counted.hits);
    EXPECT_EQ(fused.misses, counted.misses);
    EXPECT_EQ(fused.hits + fused.misses, kScanner.beams);
    EXPECT_EQ(counting.count(grid, {-1.0, 1.0, 0.0}, scan, looks).ignored, kScanner.beams);
    for (int cell = 0; cell < grid.size(); ++cell) {
      ASSERT_EQ(belief.log_odds(cell), looks[static_cast<std::size_t>(cell)]) << cell;
    }
  }
}

}  // namespace
}  // namespace vantage::estimator
