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

/// Returns the support function of the positions, m: their greatest extent in one of the lattice's
/// directions.
double support_m(const std::vector<Eigen::Vector2d>& places_m, int direction) {
  const double angle_rad = 2.0 * kPi * direction / kDirections;
  double most_m = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& place_m : places_m) {
    most_m =
        std::max(most_m, std::cos(angle_rad) * place_m.x() + std::sin(angle_rad) * place_m.y());
  }
  return most_m;
}

/// Returns the positions after `steps` steps, by heading. The key kAny contains the positions of
/// all headings.
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

/// Expects the rows of the bit plane to contain the cell of every position, and no cell beyond the
/// extent of the positions in any direction.
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

TEST(ReachLattice, HasExactlyTheReachableCells) {
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

SearchProblem with_turns(const std::vector<double>& turns_rad, int horizon_steps) {
  SearchProblem problem;
  problem.horizon_steps = horizon_steps;
  problem.step_s = 0.5;
  for (const double turn_rad : turns_rad) {
    problem.controls.push_back({1.0, turn_rad / problem.step_s});
  }
  return problem;
}

// The unit is the largest angle that divides all turns. The smallest turn must be one to four
// units. Turns in both directions are tested.
TEST(ReachLattice, FindsTheCommonTurnAngle) {
  ReachLattice lattice(8);
  const auto expect = [&](const std::vector<double>& turns_rad, double unit_rad,
                          const std::vector<int>& turns) {
    ASSERT_TRUE(lattice.reset(with_turns(turns_rad, 2)));
    EXPECT_NEAR(lattice.unit_rad(), unit_rad, 1e-12);
    for (std::size_t c = 0; c < turns.size(); ++c) {
      EXPECT_EQ(lattice.turn(c), turns[c]) << c;
    }
    EXPECT_NEAR(lattice.step_m(), 0.5, 2.0 * ReachLattice::kEdge_m) << "the longest chord";
  };
  expect({0.0}, 1.0, {0});
  expect({0.0, 0.3, -0.3}, 0.3, {0, 1, -1});
  expect({0.6, -0.3, 0.0}, 0.3, {2, -1, 0});
  expect({0.0, 0.3, -0.45}, 0.15, {0, 2, -3});
  expect({0.0, -0.3, 0.4}, 0.1, {0, -3, 4});
  expect({0.0, 0.4, 0.5}, 0.1, {0, 4, 5});
  for (const double side : {1.0, -1.0}) {  // turns to one side only
    expect({0.0, side * 0.3}, 0.3, {0, static_cast<int>(side)});
    expect({0.0, side * 0.4, side * 0.6}, 0.2,
           {0, static_cast<int>(2 * side), static_cast<int>(3 * side)});
    expect({0.0, -side * 1.5, side * 0.3}, 0.3,
           {0, static_cast<int>(-5 * side), static_cast<int>(side)});
    EXPECT_FALSE(lattice.reset(with_turns({0.0, side * 0.5, side * 0.8}, 2))) << side;
    EXPECT_FALSE(lattice.reset(with_turns({0.0, -side * 0.5, side * 0.9}, 2))) << side;
  }
  EXPECT_FALSE(lattice.reset(with_turns({0.0, 0.5, 0.6}, 2))) << "five parts are too many";
  EXPECT_FALSE(lattice.reset(with_turns({0.0, 0.3, -0.3 * std::sqrt(2.0)}, 2)));
  EXPECT_FALSE(lattice.reset(with_turns({0.0, 0.3, -0.3 * std::sqrt(2.0)}, 2))) << "a second query";
  expect({0.0, 0.3, -0.3}, 0.3, {0, 1, -1});
  // The lattice supports about a thousand headings and two thousand planes.
  SearchProblem many = with_turns({0.0, 0.01, 0.2}, 8);  // at most twenty units per step
  EXPECT_TRUE(lattice.reset(many));
  many.horizon_steps = 9;
  EXPECT_TRUE(lattice.reset(many)) << "1810 planes";
  many.horizon_steps = 10;
  EXPECT_FALSE(lattice.reset(many)) << "2211 planes";
  EXPECT_TRUE(lattice.reset(with_turns({0.0, 1e-3, 0.511}, 1))) << "1023 headings";
  EXPECT_FALSE(lattice.reset(with_turns({0.0, 1e-3, 0.512}, 1))) << "1025 headings";
}

// The tables depend on the controls, the step length and the horizon.
TEST(ReachLattice, RebuildsTablesWhenProblemChanges) {
  const SearchProblem first = with_turns({0.0, 0.4, -0.4}, 3);
  ReachLattice lattice(8);
  const auto expect_as_new = [&](const SearchProblem& problem) {
    ReachLattice fresh(8);
    ASSERT_EQ(lattice.reset(problem), fresh.reset(problem));
    EXPECT_EQ(lattice.unit_rad(), fresh.unit_rad());
    EXPECT_EQ(lattice.step_m(), fresh.step_m());
    const auto* const is = lattice.layout(problem.horizon_steps, 50'000, 50'000);
    const auto* const expected = fresh.layout(problem.horizon_steps, 50'000, 50'000);
    ASSERT_NE(is, nullptr);
    EXPECT_EQ(is->cell_m, expected->cell_m);
    EXPECT_EQ(is->planes.size(), expected->planes.size());
    EXPECT_EQ(is->levels.size(), expected->levels.size());
    EXPECT_EQ(is->shifts.size(), expected->shifts.size());
    EXPECT_EQ(is->levels.back().begin + is->levels.back().size,
              expected->levels.back().begin + expected->levels.back().size);
  };
  expect_as_new(first);
  SearchProblem other = first;
  other.step_s = 0.7;
  expect_as_new(other);
  other.horizon_steps = 4;
  expect_as_new(other);
  other.controls[1].speed_mps = 3.0;
  expect_as_new(other);
  other.controls.pop_back();
  expect_as_new(other);
  expect_as_new(first);
}

// The lattice is the finest that fits, in total and at each depth.
TEST(ReachLattice, IsAsFineAsItsCapacityAllows) {
  const SearchProblem problem = with_turns({0.0, 0.4, -0.4}, 4);
  ReachLattice lattice(8);
  ASSERT_TRUE(lattice.reset(problem));
  constexpr std::size_t kEnough = 1U << 30U;
  for (const int steps : {3, 4}) {
    double last_m = 0.0;
    std::size_t room = kEnough;
    std::size_t level_room = kEnough;
    for (const double ratio : ReachLattice::kCellsPerStep) {
      const ReachLattice::Layout* const layout = lattice.layout(steps, room, kEnough);
      ASSERT_NE(layout, nullptr);
      EXPECT_EQ(lattice.layout(steps, kEnough, level_room), layout);
      EXPECT_NEAR(layout->cell_m, lattice.step_m() / ratio, 1e-12);
      EXPECT_GT(layout->cell_m, last_m);
      last_m = layout->cell_m;
      std::size_t cells = 0;
      std::size_t level_cells = 0;
      for (int t = 1; t <= steps; ++t) {
        const ReachLattice::Level& level = layout->levels[static_cast<std::size_t>(t)];
        EXPECT_EQ(level.begin, cells);
        std::size_t in_level = 0;
        for (int n = -level.turns; n <= level.turns; ++n) {
          EXPECT_EQ(layout->plane(t, n).begin, in_level);
          in_level += layout->plane(t, n).size();
        }
        EXPECT_EQ(level.size, in_level);
        cells += in_level;
        level_cells = in_level;
      }
      EXPECT_EQ(lattice.layout(steps, cells, level_cells), layout) << "the exact capacity";
      room = cells - 1;
      level_room = level_cells - 1;
    }
    EXPECT_EQ(lattice.layout(steps, room, kEnough), nullptr);
    EXPECT_EQ(lattice.layout(steps, kEnough, level_room), nullptr);
  }
}

// From any position in a cell, a control ends in one of its four successor cells on the plane of
// the next depth.
TEST(ReachLattice, SuccessorsAreTheFourOverlappedCells) {
  const SearchProblem problem = with_turns({0.0, 0.7, -1.4}, 4);
  ReachLattice lattice(8);
  ASSERT_TRUE(lattice.reset(problem));
  const ReachLattice::Layout* const layout = lattice.layout(4, 30'000, 30'000);
  ASSERT_NE(layout, nullptr);
  const double cell_m = layout->cell_m;
  int moved = 0;
  for (int t = 1; t < 4; ++t) {
    const ReachLattice::Level& level = layout->levels[static_cast<std::size_t>(t)];
    for (int n = -level.turns; n <= level.turns; ++n) {
      const ReachLattice::Plane& plane = layout->plane(t, n);
      for (std::size_t u = 0; u < lattice.ends().size() && plane.size() > 0; ++u) {
        const ReachLattice::Shift& shift = lattice.shift(*layout, n, u);
        const ReachLattice::Plane& next = layout->plane(t + 1, n + lattice.turn(u));
        for (int j = plane.low; j <= plane.high; ++j) {
          const ReachLattice::Row row = ReachLattice::row(plane, j);
          for (int i = row.left; i <= row.right; ++i) {
            for (int corner = 0; corner < 4; ++corner) {
              const double half = 0.4999;  // share of a cell
              const Pose2 from{cell_m * (i + (corner % 2 == 0 ? half : -half)),
                               cell_m * (j + (corner < 2 ? half : -half)), n * lattice.unit_rad()};
              const Pose2 to = models::step_unicycle(from, problem.controls[u], problem.step_s);
              const int x = static_cast<int>(std::lround(to.x_m / cell_m)) - i - shift.x;
              const int y = static_cast<int>(std::lround(to.y_m / cell_m)) - j - shift.y;
              ASSERT_TRUE(x >= 0 && x <= 1 && y >= 0 && y <= 1) << x << ' ' << y;
            }
            ASSERT_TRUE(next.has(i + shift.x, j + shift.y));
            ASSERT_TRUE(next.has(i + shift.x + 1, j + shift.y + 1));
            ++moved;
          }
        }
      }
    }
  }
  EXPECT_GT(moved, 1'000);
}

TEST(ReachLattice, IsRowMajor) {
  ReachLattice::Plane plane;
  plane.left = -3;
  plane.bottom = 2;
  plane.width = 4;
  plane.height = 2;
  EXPECT_EQ(plane.size(), 8U);
  std::ptrdiff_t next = 0;
  for (int j = 2; j < 4; ++j) {
    for (int i = -3; i < 1; ++i) {
      EXPECT_TRUE(plane.has(i, j));
      EXPECT_EQ(plane.at(i, j), next++);
    }
  }
  EXPECT_FALSE(plane.has(-4, 2));
  EXPECT_FALSE(plane.has(1, 2));
  EXPECT_FALSE(plane.has(0, 1));
  EXPECT_FALSE(plane.has(0, 4));
}

}  // namespace
}  // namespace vantage::planner
