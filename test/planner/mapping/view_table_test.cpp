#include "planner/mapping/view_table.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/planner/mapping/random_map.hpp"

namespace vantage::planner {
namespace {

using models::BeamSensor;
using models::GridGeometry;
using models::OccupancyBelief;

const GridGeometry kGrid{{0.0, 0.0}, 0.2, 40, 40};
const BeamSensor kCircle{24, 2.0 * kPi, 0.0, 1.5, 0.01};

ViewOptions options_of(BeamDependence dependence, BeamMeasure measure = BeamMeasure::kCsqmi) {
  ViewOptions options;
  options.dependence = dependence;
  options.measure = measure;
  return options;
}

Pose2 random_pose(test::Random& random) {
  return {random.uniform(0.5, 7.5), random.uniform(0.5, 7.5), random.uniform(-kPi, kPi)};
}

double value_of(ViewTable& table, const std::vector<Pose2>& poses) {
  MapCoverage coverage(kGrid.size());
  double sum_nats = 0.0;
  for (const Pose2& pose : poses) {
    sum_nats += coverage.add(table.view(pose), table.options());
  }
  return sum_nats;
}

TEST(ViewTable, TellsOfOneBeamWhatTheBeamTells) {
  test::Random random(4501);
  const BeamSensor one{1, 1.0, 0.0, 1.5, 0.01};
  for (const BeamMeasure measure : {BeamMeasure::kCsqmi, BeamMeasure::kFsmi}) {
    for (const BeamDependence dependence :
         {BeamDependence::kDropBeams, BeamDependence::kBestOfCell}) {
      const OccupancyBelief belief = test::random_map(random, kGrid, 0.1);
      ViewTable table(belief, one, options_of(dependence, measure));
      for (int i = 0; i < 50; ++i) {
        const int cell = random.integer(0, kGrid.size() - 1);
        const Eigen::Vector2d at_m = kGrid.centre_m(cell);
        models::BeamProfile beam;
        models::trace_beam(belief, one, at_m, 0.0, beam);
        const double nats = measure == BeamMeasure::kCsqmi ? models::csqmi(beam, one, 6.0).nats
                                                           : models::fsmi(beam, one, {}, 6.0).nats;
        const BeamView& view = table.view({at_m.x(), at_m.y(), 0.0});
        double shares_nats = 0.0;
        for (const BeamView::Share& share : view.shares) {
          shares_nats += share.nats;
        }
        ASSERT_NEAR(view.nats, nats, 1e-9);
        ASSERT_NEAR(shares_nats, nats, 1e-9);
      }
    }
  }
}

TEST(ViewTable, IsWorthNothingWhereEverythingIsKnownAndOutside) {
  OccupancyBelief belief(kGrid, 2.0);
  for (int cell = 0; cell < kGrid.size(); ++cell) {
    belief.add_log_odds(cell, cell % 7 == 0 ? 5.0 : -5.0);
  }
  for (const BeamDependence dependence :
       {BeamDependence::kDropBeams, BeamDependence::kBestOfCell}) {
    ViewTable table(belief, kCircle, options_of(dependence));
    EXPECT_EQ(table.view({3.0, 3.0, 1.0}).nats, 0.0);
    EXPECT_EQ(table.view({-1.0, 3.0, 1.0}).nats, 0.0);
  }
}

TEST(ViewTable, RemovesTheBeamsOfAScanThatDependOnEachOther) {
  const OccupancyBelief unknown(kGrid, 3.0);
  double beams_alone_nats = 0.0;
  for (int beam = 0; beam < 96; ++beam) {
    models::BeamProfile profile;
    const BeamSensor sensor{96, 2.0 * kPi, 0.0, 1.5, 0.01};
    models::trace_beam(unknown, sensor, kGrid.centre_m(820), sensor.bearing_rad(beam), profile);
    beams_alone_nats += models::csqmi(profile, sensor, 6.0).nats;
  }
  const Eigen::Vector2d at_m = kGrid.centre_m(820);
  for (const BeamDependence dependence :
       {BeamDependence::kDropBeams, BeamDependence::kBestOfCell}) {
    ViewTable sparse(unknown, {24, 2.0 * kPi, 0.0, 1.5, 0.01}, options_of(dependence));
    ViewTable dense(unknown, {96, 2.0 * kPi, 0.0, 1.5, 0.01}, options_of(dependence));
    const double sparse_nats = sparse.view({at_m.x(), at_m.y(), 0.0}).nats;
    const double dense_nats = dense.view({at_m.x(), at_m.y(), 0.0}).nats;
    EXPECT_LT(dense_nats, 0.5 * beams_alone_nats);
    EXPECT_LT(dense_nats, 2.0 * sparse_nats) << "four times the beams see nearly the same cells";
    EXPECT_GT(dense_nats, 0.9 * sparse_nats);
  }
}

TEST(ViewTable, LooksOnlyWhereTheFieldOfViewIs) {
  OccupancyBelief belief(kGrid, 3.0);
  for (int cell = 0; cell < kGrid.size(); ++cell) {
    if (kGrid.centre_m(cell).x() < 4.0) {
      belief.add_log_odds(cell, -9.0);  // known in the west
    }
  }
  ViewTable table(belief, {9, 1.0, 0.0, 1.5, 0.01}, options_of(BeamDependence::kBestOfCell));
  EXPECT_GT(table.view({3.5, 4.0, 0.0}).nats, 1.0);
  EXPECT_EQ(table.view({3.5, 4.0, kPi}).nats, 0.0);
}

/// Calls look(random, table) of a random map, once for each way to count beams that depend.
template <class Look>
void for_each_dependence(unsigned seed, const Look& look) {
  test::Random random(seed);
  const OccupancyBelief belief = test::random_map(random, kGrid, 0.05);
  for (const BeamDependence dependence :
       {BeamDependence::kDropBeams, BeamDependence::kBestOfCell}) {
    ViewTable table(belief, kCircle, options_of(dependence));
    look(random, table);
  }
}

TEST(MapCoverage, CountsTheSameScanOnce) {
  for_each_dependence(4502, [](test::Random& random, ViewTable& table) {
    for (int i = 0; i < 30; ++i) {
      const Pose2 pose = random_pose(random);
      ASSERT_NEAR(value_of(table, {pose, pose}), value_of(table, {pose}), 1e-12);
    }
  });
}

TEST(MapCoverage, AddsUpScansThatShareNoCell) {
  for_each_dependence(4503, [](test::Random&, ViewTable& table) {
    const Pose2 a{1.7, 1.7, 0.0};
    const Pose2 b{5.5, 6.0, 2.0};
    EXPECT_NEAR(value_of(table, {a, b}), table.view(a).nats + table.view(b).nats, 1e-12);
  });
}

TEST(MapCoverage, GainsBetweenNothingAndTheWholeView) {
  for_each_dependence(4504, [](test::Random& random, ViewTable& table) {
    MapCoverage coverage(kGrid.size());
    for (int i = 0; i < 200; ++i) {
      const BeamView& view = table.view(random_pose(random));
      const double gain_nats = coverage.add(view, table.options());
      ASSERT_GE(gain_nats, 0.0);
      ASSERT_LE(gain_nats, view.nats + 1e-12);
    }
  });
}

TEST(MapCoverage, BestOfCellIsSubmodularAndKnowsNoOrder) {
  test::Random random(4505);
  const OccupancyBelief belief = test::random_map(random, kGrid, 0.05);
  ViewTable table(belief, kCircle, options_of(BeamDependence::kBestOfCell));
  for (int i = 0; i < 200; ++i) {
    std::vector<Pose2> large;
    for (int k = 0; k < 5; ++k) {
      large.push_back(
          {random.uniform(2.0, 4.0), random.uniform(2.0, 4.0), random.uniform(-kPi, kPi)});
    }
    const std::vector<Pose2> small(large.begin(), large.begin() + 2);
    const Pose2 extra{random.uniform(2.0, 4.0), random.uniform(2.0, 4.0), 0.0};
    std::vector<Pose2> larger = large;
    larger.push_back(extra);
    std::vector<Pose2> small_and_extra = small;
    small_and_extra.push_back(extra);
    const double gain_late_nats = value_of(table, larger) - value_of(table, large);
    ASSERT_GE(gain_late_nats, -1e-12);
    ASSERT_LE(gain_late_nats, value_of(table, small_and_extra) - value_of(table, small) + 1e-9);
    std::vector<Pose2> shuffled = larger;
    std::reverse(shuffled.begin(), shuffled.end());
    ASSERT_NEAR(value_of(table, shuffled), value_of(table, larger), 1e-9);
  }
}

TEST(MapCoverage, TakesBackToTheBit) {
  test::Random random(4506);
  const OccupancyBelief belief = test::random_map(random, kGrid, 0.05);
  ViewTable table(belief, kCircle, options_of(BeamDependence::kBestOfCell));
  MapCoverage coverage(kGrid.size());
  for (int i = 0; i < 100; ++i) {
    const std::size_t mark = coverage.mark();
    const BeamView& view = table.view(random_pose(random));
    const double first_nats = coverage.add(view, table.options());
    coverage.add(table.view(random_pose(random)), table.options());
    coverage.take_back(mark);
    ASSERT_EQ(coverage.add(view, table.options()), first_nats);
  }
}

TEST(ViewTable, RefusesOptionsThatMakeNoSense) {
  const OccupancyBelief belief(kGrid, 2.0);
  ViewOptions options;
  options.dependent_share = 0.0;
  EXPECT_THROW(ViewTable(belief, kCircle, options), UsageError);
  options.dependent_share = 1.0;
  EXPECT_NO_THROW(ViewTable(belief, kCircle, options));
  options.dependent_share = 1.0 + 1e-9;
  EXPECT_THROW(ViewTable(belief, kCircle, options), UsageError);
  options = {};
  options.cutoff_sigmas = 0.0;
  EXPECT_THROW(ViewTable(belief, kCircle, options), UsageError);
  EXPECT_THROW(ViewTable(belief, {0, 1.0, 0.0, 1.0, 0.1}, {}), UsageError);
}

}  // namespace
}  // namespace vantage::planner
