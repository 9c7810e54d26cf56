#include "planner/search/reach_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"

namespace vantage::planner {
namespace {

constexpr int kDirections = 16;

/// The support of some places in one of the directions that the lattice looks at them from.
double support_m(const std::vector<Eigen::Vector2d>& places_m, int direction) {
  const double angle_rad = 2.0 * kPi * direction / kDirections;
  double most_m = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& place_m : places_m) {
    most_m =
        std::max(most_m, std::cos(angle_rad) * place_m.x() + std::sin(angle_rad) * place_m.y());
  }
  return most_m;
}

/// All places after so many steps, by how far it has turned, and whatever that is (under kAny).
constexpr int kAny = 1'000;
std::map<int, std::vector<Eigen::Vector2d>> places_after(const ReachLattice& lattice, int steps) {
  std::vector<std::pair<Pose2, int>> nodes{{Pose2{}, 0}};
  for (int t = 0; t < steps; ++t) {
    std::vector<std::pair<Pose2, int>> next;
    for (const auto& [pose, turned] : nodes) {
      for (std::size_t c = 0; c < lattice.ends().size(); ++c) {
        next.emplace_back(pose * lattice.ends()[c], turned + lattice.turn(c));
      }
    }
    nodes = std::move(next);
  }
  std::map<int, std::vector<Eigen::Vector2d>> out;
  for (const auto& [pose, turned] : nodes) {
    out[turned].push_back(pose.position_m());
    out[kAny].push_back(pose.position_m());
  }
  return out;
}

/// Its rows have the cells of all these places, and none that lies beyond them in a direction.
void expect_cells_of(const std::vector<Eigen::Vector2d>& places_m, double cell_m,
                     const ReachLattice::Plane& plane) {
  for (const Eigen::Vector2d& place_m : places_m) {
    const int i = static_cast<int>(std::lround(place_m.x() / cell_m));
    const int j = static_cast<int>(std::lround(place_m.y() / cell_m));
    const ReachLattice::Row row = ReachLattice::row(plane, j);
    ASSERT_TRUE(row.left <= i && i <= row.right) << i << ' ' << j;
    ASSERT_TRUE(plane.has(i, j));
  }
  for (int direction = 0; direction < kDirections; ++direction) {
    const double angle_rad = 2.0 * kPi * direction / kDirections;
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    const double most_m = support_m(places_m, direction) +
                          0.5 * cell_m * (std::abs(c) + std::abs(s)) + 2.0 * ReachLattice::kEdge_m;
    for (int j = plane.bottom; j < plane.bottom + plane.height; ++j) {
      const ReachLattice::Row row = ReachLattice::row(plane, j);
      for (const int i : {row.left, row.right}) {
        if (row.left <= row.right) {
          ASSERT_LE(cell_m * (c * i + s * j), most_m) << i << ' ' << j << " in " << direction;
        }
      }
    }
  }
}

TEST(ReachLattice, HasTheCellsThatCanBeReachedAndNoneBeyondThem) {
  SearchProblem problem;
  problem.horizon_steps = 4;
  problem.controls = {{2.0, 0.0}, {2.0, 1.5}, {1.0, -1.5}, {0.5, 3.0}};
  ReachLattice lattice(8);
  ASSERT_TRUE(lattice.reset(problem));
  for (const std::size_t cells : {std::size_t{2'000}, std::size_t{40'000}}) {
    const ReachLattice::Layout* const layout = lattice.layout(problem.horizon_steps, cells, cells);
    ASSERT_NE(layout, nullptr) << cells;
    for (int t = 1; t <= problem.horizon_steps; ++t) {
      const ReachLattice::Level& level = layout->levels[static_cast<std::size_t>(t)];
      const auto places_m = places_after(lattice, t);
      for (int n = -level.turns; n <= level.turns; ++n) {
        SCOPED_TRACE(testing::Message() << "step " << t << ", turned " << n);
        const ReachLattice::Plane& plane = layout->plane(t, n);
        if (places_m.count(n) == 0) {
          EXPECT_EQ(plane.size(), 0U);
        } else {
          expect_cells_of(places_m.at(n), layout->cell_m, plane);
        }
      }
      expect_cells_of(places_m.at(kAny), layout->cell_m, level.any);
    }
  }
}

}  // namespace
}  // namespace vantage::planner
