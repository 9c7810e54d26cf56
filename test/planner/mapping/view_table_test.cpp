#include "planner/mapping/view_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
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

TEST(ViewTable, EqualsTheInformationOfASingleBeam) {
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

TEST(ViewTable, IsZeroForKnownCellsAndOutsideTheMap) {
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

TEST(ViewTable, RemovesDependentBeamsOfAScan) {
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

TEST(ViewTable, RespectsTheFieldOfView) {
  OccupancyBelief belief(kGrid, 3.0);
  for (int cell = 0; cell < kGrid.size(); ++cell) {
    if (kGrid.centre_m(cell).x() < 4.0) {
      belief.add_log_odds(cell, -9.0);  // the western cells are known
    }
  }
  ViewTable table(belief, {9, 1.0, 0.0, 1.5, 0.01}, options_of(BeamDependence::kBestOfCell));
  EXPECT_GT(table.view({3.5, 4.0, 0.0}).nats, 1.0);
  EXPECT_EQ(table.view({3.5, 4.0, kPi}).nats, 0.0);
}

/// Calls look(random, table) for a random map, once per rule for dependent beams.
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

TEST(MapCoverage, SumsDisjointScans) {
  for_each_dependence(4503, [](test::Random&, ViewTable& table) {
    const Pose2 a{1.7, 1.7, 0.0};
    const Pose2 b{5.5, 6.0, 2.0};
    EXPECT_NEAR(value_of(table, {a, b}), table.view(a).nats + table.view(b).nats, 1e-12);
  });
}

TEST(MapCoverage, GainIsAtMostTheInformationOfTheView) {
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

/// One beam as documented: its information is distributed over its cells in proportion to P(the
/// beam reaches the cell) · o (1 − o), with the occupancy probability o of the cell.
struct Traced {
  double nats = 0.0;
  std::map<int, double> nats_of;  ///< by cell index
};

/// Returns the beams of a scan from the centre of a cell that have information.
std::vector<Traced> traced(const OccupancyBelief& belief, const BeamSensor& sensor,
                           const Eigen::Vector2d& from_m, double yaw_rad, BeamMeasure measure) {
  std::vector<Traced> beams;
  for (int beam = 0; beam < sensor.beams; ++beam) {
    models::BeamProfile profile;
    models::trace_beam(belief, sensor, from_m, yaw_rad + sensor.bearing_rad(beam), profile);
    std::vector<double> weights;
    double comes_there = 1.0;
    double sum = 0.0;
    for (const double o : profile.occupancy) {
      weights.push_back(comes_there * o * (1.0 - o));
      sum += weights.back();
      comes_there *= 1.0 - o;
    }
    if (sum > 0.0) {
      Traced& one = beams.emplace_back();
      one.nats = measure == BeamMeasure::kCsqmi ? models::csqmi(profile, sensor, 6.0).nats
                                                : models::fsmi(profile, sensor, {}, 6.0).nats;
      for (std::size_t k = 0; k < weights.size(); ++k) {
        if (weights[k] > 0.0) {
          one.nats_of[profile.cell[k]] = one.nats * weights[k] / sum;
        }
      }
    }
  }
  return beams;
}

/// Accumulates the information per cell and returns the amount that another beam adds.
class CellInformation {
 public:
  CellInformation(BeamDependence dependence, double dependent_share)
      : dependence_(dependence), dependent_share_(dependent_share) {}

  double add(const Traced& beam) {
    double rise_nats = 0.0;
    double known_nats = 0.0;
    for (const auto& [cell, nats] : beam.nats_of) {
      rise_nats += std::max(0.0, nats - nats_of_[cell]);
      known_nats += std::min(nats, nats_of_[cell]);
    }
    if (dependence_ == BeamDependence::kDropBeams) {
      if (known_nats >= dependent_share_ * beam.nats) {
        return 0.0;
      }
      rise_nats = beam.nats;
    }
    for (const auto& [cell, nats] : beam.nats_of) {
      nats_of_[cell] = std::max(nats_of_[cell], nats);
    }
    return rise_nats;
  }

 private:
  BeamDependence dependence_;
  double dependent_share_;
  std::map<int, double> nats_of_;
};

// The gains of single and successive scans follow the two documented rules, also at several
// headings with a limited field of view.
TEST(ViewTable, AppliesTheTwoDocumentedBeamRules) {
  test::Random random(4507);
  for (int i = 0; i < 36; ++i) {
    ViewOptions options;
    options.measure = i / 4 % 2 == 0 ? BeamMeasure::kCsqmi : BeamMeasure::kFsmi;
    options.dependence = i % 4 == 0 ? BeamDependence::kBestOfCell : BeamDependence::kDropBeams;
    options.dependent_share = i % 3 == 0 ? 0.2 : i % 3 == 1 ? 0.55 : 0.95;
    BeamSensor sensor = kCircle;
    if (i % 5 > 1) {
      sensor = {7, 1.5, 0.0, 1.5, 0.01};
    }
    const OccupancyBelief belief = test::random_map(random, kGrid, 0.05);
    ViewTable table(belief, sensor, options);
    MapCoverage coverage(kGrid.size());
    CellInformation team(options.dependence, options.dependent_share);
    std::int64_t cells = 0;
    std::set<std::pair<int, int>> views;
    for (int k = 0; k < 4; ++k) {
      const int cell = (18 + k / 2) * kGrid.columns + 20 + k % 2;
      const int sector = i % 5 > 1 ? random.integer(-14, 14) : 0;
      const Eigen::Vector2d at_m = kGrid.centre_m(cell);
      const double yaw_rad = (sector + 28) % 28 * (2.0 * kPi / 28.0);
      CellInformation alone(options.dependence, options.dependent_share);
      double nats = 0.0;
      double gain_nats = 0.0;
      for (const Traced& beam : traced(belief, sensor, at_m, yaw_rad, options.measure)) {
        const double rise_nats = alone.add(beam);
        nats += rise_nats;
        if (options.dependence == BeamDependence::kBestOfCell || rise_nats > 0.0) {
          gain_nats += team.add(beam);  // dropped beams of a scan do not count
        }
      }
      const BeamView& view = table.view({at_m.x(), at_m.y(), sector * (2.0 * kPi / 28.0)});
      ASSERT_NEAR(view.nats, nats, 1e-9) << i << ' ' << k;
      ASSERT_NEAR(coverage.add(view, options), gain_nats, 1e-9) << i << ' ' << k;
      if (views.emplace(cell, (sector + 28) % 28).second) {
        for (int beam = 0; beam < sensor.beams; ++beam) {
          models::BeamProfile profile;
          models::trace_beam(belief, sensor, at_m, yaw_rad + sensor.bearing_rad(beam), profile);
          cells += profile.size();
        }
      }
      EXPECT_EQ(table.beam_cells(), cells);
      EXPECT_EQ(table.views(), static_cast<std::int64_t>(views.size()));
    }
  }
}

// With five beams, headings are rounded to multiples of 1/20 turn. The last multiple equals the
// first.
TEST(ViewTable, RoundsHeadingsByBeamSpacing) {
  const OccupancyBelief belief(kGrid, 3.0);
  const Eigen::Vector2d at_m = kGrid.centre_m(820);
  const double sector_rad = 2.0 * kPi / 20.0;
  for (const double field_of_view_rad : {1.5, 2.0 * kPi - 1e-6, 2.0 * kPi}) {
    ViewTable table(belief, {5, field_of_view_rad, 0.0, 1.5, 0.01}, {});
    const auto view = [&](double yaw_rad, double x_m = 0.0, double y_m = 0.0) {
      return &table.view({at_m.x() + x_m, at_m.y() + y_m, yaw_rad});
    };
    const bool is_all_around = field_of_view_rad == 2.0 * kPi;
    std::set<const BeamView*> different;
    for (int k = -10; k <= 10; ++k) {
      const double yaw_rad = k * sector_rad;
      different.insert(view(yaw_rad));
      EXPECT_EQ(view(yaw_rad + 0.49 * sector_rad), view(yaw_rad)) << k;
      EXPECT_EQ(view(yaw_rad - 0.49 * sector_rad), view(yaw_rad)) << k;
      EXPECT_EQ(view(yaw_rad + 0.51 * sector_rad), view(yaw_rad + sector_rad)) << k;
      EXPECT_EQ(view(yaw_rad - 0.51 * sector_rad), view(yaw_rad - sector_rad)) << k;
      for (const double off_m : {0.09, -0.09}) {
        EXPECT_EQ(view(yaw_rad, off_m, -off_m), view(yaw_rad)) << "the same cell";
      }
    }
    EXPECT_EQ(different.size(), is_all_around ? 1U : 20U);
    EXPECT_EQ(table.views(), is_all_around ? 1 : 20);
    EXPECT_NE(view(0.0, 0.11), view(0.0)) << "the adjacent cell";
    EXPECT_GT(table.view({0.01, 0.01, 0.25 * kPi}).nats, 0.0) << "from the first cell";
    EXPECT_NE(view(0.0, 0.0, -0.11), view(0.0));
  }
}

TEST(ViewTable, HasTheStatedDefaults) {
  const ViewOptions options;
  EXPECT_EQ(options.measure, BeamMeasure::kCsqmi);
  EXPECT_EQ(options.dependence, BeamDependence::kBestOfCell);
  EXPECT_EQ(options.dependent_share, 0.5);
  EXPECT_EQ(options.cutoff_sigmas, 6.0);
}

TEST(MapCoverage, BestBeamPerCellIsSubmodularAndIndependentOfOrder) {
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

TEST(MapCoverage, RemovesScansExactly) {
  test::Random random(4506);
  const OccupancyBelief belief = test::random_map(random, kGrid, 0.05);
  ViewTable table(belief, kCircle, options_of(BeamDependence::kBestOfCell));
  MapCoverage coverage(kGrid.size());
  for (int i = 0; i < 100; ++i) {
    const std::size_t mark = coverage.mark();
    const BeamView& view = table.view(random_pose(random));
    const double first_nats = coverage.add(view, table.options());
    coverage.add(table.view(random_pose(random)), table.options());
    coverage.undo_to(mark);
    ASSERT_EQ(coverage.add(view, table.options()), first_nats);
  }
}

TEST(ViewTable, RefusesInvalidOptions) {
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
