#include "models/mapping/cell_counts.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

const GridGeometry kGrid{{0.0, 0.0}, 0.5, 4, 3};

TEST(CellCounts, SumDoesNotDependOnTheOrderUnlikeClampedLogOdds) {
  test::Random random(5101);
  struct Look {
    int cell = 0;
    bool met = false;
  };
  std::vector<Look> looks;
  for (int i = 0; i < 400; ++i) {
    looks.push_back({random.integer(0, kGrid.size() - 1), random.coin()});
  }
  CellCounts in_order(12, 0);
  for (const Look& look : looks) {
    count_scan(in_order, look.cell, look.met);
  }
  std::vector<CellCounts> parts(4, CellCounts(12, 0));
  std::reverse(looks.begin(), looks.end());
  for (std::size_t i = 0; i < looks.size(); ++i) {
    count_scan(parts[i % 4], looks[i].cell, looks[i].met);
  }
  EXPECT_EQ(sum_of({{parts[2], parts[0], parts[3], parts[1]}}), in_order);
  EXPECT_THROW(sum_of({{parts[0], CellCounts(11, 0)}}), UsageError);
}

TEST(CellCounts, SaturateAtTheLimits) {
  using Limits = std::numeric_limits<std::int16_t>;
  CellCounts looks{Limits::max(), Limits::min()};
  count_scan(looks, 0, true);
  count_scan(looks, 1, false);
  EXPECT_EQ(looks, (CellCounts{Limits::max(), Limits::min()}));
  const CellCounts same{1, -1};
  const CellCounts other{-5, 5};
  EXPECT_EQ(sum_of({{looks, same}}), looks);
  EXPECT_EQ(sum_of({{looks, same, other}}), (CellCounts{Limits::max() - 4, Limits::min() + 4}));
}

TEST(CellCounts, EqualRepeatedUpdates) {
  const MappingSpec spec;
  const CellCounts looks{0, 1, -1, 2, -2, 30, -30, 0, 0, 0, 0, 0};
  const OccupancyBelief belief = belief_of(kGrid, looks, spec);
  const double clamp = log_odds_of(0.99);
  for (int cell = 0; cell < kGrid.size(); ++cell) {
    const double wanted = looks[static_cast<std::size_t>(cell)] * log_odds_of(0.95);
    EXPECT_DOUBLE_EQ(belief.log_odds(cell), std::clamp(wanted, -clamp, clamp)) << cell;
  }
  EXPECT_EQ(belief.occupancy(3), 1.0);
  EXPECT_GT(belief.occupancy(2), 0.0);
  EXPECT_THROW(static_cast<void>(belief_of(kGrid, CellCounts(11, 0), spec)), UsageError);
}

TEST(MappingSpec, HasTheStatedDefaults) {
  const MappingSpec spec;
  EXPECT_EQ(spec.scanner.beams, 96);
  EXPECT_EQ(spec.scanner.range_max_m, 1.5);
  EXPECT_EQ(spec.scanner.sigma_m, 0.01);
  EXPECT_EQ(spec.planned_beams, 48);
  EXPECT_EQ(spec.resolution_m, 0.2);
  EXPECT_EQ(spec.look_probability, 0.95);
  EXPECT_EQ(spec.settled_probability, 0.99);
  World world;
  world.bounds = {{-1.0, 0.0}, {1.0, 3.0}};
  EXPECT_EQ(map_geometry(world, spec), (GridGeometry{{-1.0, 0.0}, 0.2, 10, 15}));
  EXPECT_THROW(static_cast<void>(sum_of({})), UsageError);
}

}  // namespace
}  // namespace vantage::models
