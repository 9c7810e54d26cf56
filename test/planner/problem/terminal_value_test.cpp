#include "planner/problem/terminal_value.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

using test::uniform;

// Returns the travel times to two stops at (0, 0) and (6, 0), at 2 m/s, on a grid of 1 m.
TerminalValue::Fields two_fields() {
  TerminalValue::Fields fields;
  fields.min_m = {-2.0, -2.0};
  fields.cell_m = 1.0;
  fields.side = 11;
  for (const double stop_x_m : {0.0, 6.0}) {
    for (int row = 0; row < fields.side; ++row) {
      for (int column = 0; column < fields.side; ++column) {
        fields.times_s.push_back(std::hypot(column - 2 - stop_x_m, row - 2) / 2.0);
      }
    }
  }
  return fields;
}

TerminalValue two_stops() { return {{{4, 3.0, 0.0}, {1, 5.0, 4.0}}, two_fields()}; }

std::vector<std::uint16_t> random_subset(std::mt19937_64& rng, std::size_t targets) {
  std::vector<std::uint16_t> out;
  for (std::size_t m = 0; m < targets; ++m) {
    if (test::pick(rng, 0, 2) == 0) {
      out.push_back(static_cast<std::uint16_t>(m));
    }
  }
  return out;
}

TEST(TerminalValue, ChargesEachUnmeasuredStopForItsArrivalTime) {
  const TerminalValue value = two_stops();
  const Eigen::Vector2d p_m(3.0, 4.0);  // 2.5 s from both stops
  const std::uint16_t neither[] = {0, 2};
  const std::uint16_t first[] = {0, 4};
  const std::uint16_t second[] = {1};
  const std::uint16_t both[] = {1, 4};
  EXPECT_DOUBLE_EQ(value.at(value.rest({}), p_m), 3.0 * 2.5 + 5.0 * (2.5 + 4.0));
  EXPECT_DOUBLE_EQ(value.at(value.rest(neither), p_m), 3.0 * 2.5 + 5.0 * (2.5 + 4.0));
  EXPECT_DOUBLE_EQ(value.at(value.rest(first), p_m), 5.0 * 2.5);
  EXPECT_DOUBLE_EQ(value.at(value.rest(second), p_m), 3.0 * 2.5);
  EXPECT_EQ(value.at(value.rest(both), p_m), 0.0);
  EXPECT_TRUE(value.has_stop(1));
  EXPECT_FALSE(value.has_stop(2));
  EXPECT_FALSE(value.has_stop(7));
  EXPECT_EQ(value.target_count(), 5);
}

// A stop with open > done counts with the share (cost − done) / (open − done) of its rate, limited
// to 0 … 1, with the cost of the target's covariance.
TEST(TerminalValue, ScalesTheRateOfAStopByItsUnmeasuredShare) {
  const TerminalValue value({{4, 3.0, 0.0, 2.0, -2.0}, {1, 5.0, 4.0}}, two_fields());
  const Eigen::Vector2d p_m(3.0, 4.0);  // 2.5 s from both stops
  const std::uint16_t first[] = {0, 4};
  struct Row {
    double cost;
    double expected;
  };
  for (const Row& row :
       {Row{9.0, 3.0 * 2.5 + 5.0 * 6.5}, Row{2.0, 3.0 * 2.5 + 5.0 * 6.5},
        Row{1.0, 0.75 * 3.0 * 2.5 + 5.0 * 6.5}, Row{-1.5, 0.125 * 3.0 * 2.5 + 5.0 * 6.5},
        Row{-2.0, 5.0 * 2.5}, Row{-7.0, 5.0 * 2.5}}) {
    const auto cost_of = [&](std::size_t k) {
      EXPECT_EQ(k, 1u) << "target 0 has no stop";
      return row.cost;
    };
    EXPECT_DOUBLE_EQ(value.at(value.rest(first, cost_of), p_m), row.expected) << row.cost;
  }
}

TEST(TerminalValue, InterpolatesBetweenGridPoints) {
  const TerminalValue value = two_stops();
  const std::uint16_t second[] = {1};
  const auto time_s = [&](double x_m, double y_m) {
    return value.at(value.rest(second), {x_m, y_m}) / 3.0;
  };
  EXPECT_DOUBLE_EQ(time_s(0.0, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(time_s(0.25, 0.0), 0.125);
  EXPECT_DOUBLE_EQ(time_s(0.5, 0.5), 0.25 * (0.0 + 0.5 + 0.5 + std::sqrt(0.5)));
  EXPECT_DOUBLE_EQ(time_s(99.0, 0.0), 4.0) << "beyond the grid, the value at its border applies";
  EXPECT_DOUBLE_EQ(time_s(0.0, -99.0), 1.0);
}

TEST(TerminalValue, DoesNotIncreaseWithMoreMeasurements) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::mt19937_64 rng(seed);
    test::OwnedProblem owned = test::random_problem(seed);
    test::add_random_tour(rng, owned.problem);
    const TerminalValue& value = owned.problem.terminal;
    const std::vector<std::uint16_t> some = random_subset(rng, owned.problem.targets.size());
    std::vector<std::uint16_t> fewer = some;
    if (!fewer.empty()) {
      fewer.erase(fewer.begin() + test::pick(rng, 0, static_cast<int>(fewer.size()) - 1));
    }
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d p_m(uniform(rng, -8.0, 8.0), uniform(rng, -8.0, 8.0));
      const double v = value.at(value.rest(some), p_m);
      EXPECT_GE(v, 0.0);
      EXPECT_LE(v, value.at(value.rest(fewer), p_m) + 1e-9) << seed;
    }
  }
}

TEST(TerminalValue, IsAtLeastItsBoundWithinReach) {
  double closest = 1e9;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::mt19937_64 rng(seed);
    test::OwnedProblem owned = test::random_problem(seed);
    test::add_random_tour(rng, owned.problem);
    const TerminalValue& value = owned.problem.terminal;
    const TerminalValue::Rest rest = value.rest(random_subset(rng, owned.problem.targets.size()));
    const Eigen::Vector2d from_m(uniform(rng, -6.0, 6.0), uniform(rng, -6.0, 6.0));
    const double reach_m = uniform(rng, 0.0, 4.0);
    const double bound = value.least_within(rest, from_m, reach_m);
    for (int i = 0; i < 50; ++i) {
      const double angle_rad = uniform(rng, 0.0, 7.0);
      const Eigen::Vector2d p_m =
          from_m +
          uniform(rng, 0.0, reach_m) * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
      EXPECT_GE(value.at(rest, p_m), bound - 1e-9) << seed;
      closest = rest.field < 0 ? closest : std::min(closest, value.at(rest, p_m) - bound);
    }
  }
  EXPECT_LT(closest, 0.01) << "the bound is never tight";
}

TEST(TerminalValue, RefusesArgumentsThatBreakARule) {
  struct Row {
    const char* rule;
    void (*change)(std::vector<TerminalValue::Stop>&, TerminalValue::Fields&);
  };
  const Row rows[] = {
      {"rate_per_s", [](auto& stops, auto&) { stops[0].rate_per_s = -1.0; }},
      {"rate_per_s", [](auto& stops, auto&) { stops[0].rate_per_s = std::nan(""); }},
      {"ascending", [](auto& stops, auto&) { stops[0].after_s = 5.0; }},
      {"done", [](auto& stops, auto&) { stops[0].done = 1.0; }},
      {"at most one stop", [](auto& stops, auto&) { stops[0].target = stops[1].target; }},
      {"target", [](auto& stops, auto&) { stops[0].target = -1; }},
      {"64 stops",
       [](auto& stops, auto&) {
         for (int i = 10; i < 74; ++i) {
           stops.push_back({i, 1.0, 10.0});
         }
       }},
      {"times_s", [](auto&, auto& fields) { fields.times_s.pop_back(); }},
      {"travel times", [](auto&, auto& fields) { fields.times_s[3] = -1.0; }},
      {"grid", [](auto&, auto& fields) { fields.cell_m = 0.0; }},
      {"grid", [](auto&, auto& fields) { fields.side = 1; }},
  };
  for (const Row& row : rows) {
    std::vector<TerminalValue::Stop> stops = two_stops().stops();
    TerminalValue::Fields fields = two_fields();
    row.change(stops, fields);
    try {
      const TerminalValue value(stops, fields);
      ADD_FAILURE() << "accepted: " << row.rule;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(row.rule), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace vantage::planner
