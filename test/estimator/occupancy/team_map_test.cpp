#include "estimator/occupancy/team_map.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "models/mapping/beam_scan.hpp"
#include "test/estimator/occupancy/mapping_scenario.hpp"
#include "test/support/random.hpp"

namespace vantage::estimator {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

scenario::Scenario mapping_scenario() {
  scenario::Scenario scenario = test::mapping_scenario({"Q1", "Q2", "Q3"});
  scenario.world.obstacles = {{{{2.0, 2.0}, {3.0, 4.0}}, 3.0}, {{{5.0, 1.0}, {7.0, 2.0}}, 3.0}};
  return scenario;
}

models::RangeScan scan_of(const scenario::Scenario& scenario, test::Random& random) {
  Pose2 pose;
  do {
    pose = {random.uniform(0.1, 7.9), random.uniform(0.1, 5.9), random.uniform(-kPi, kPi)};
  } while (models::clearance_m(scenario.world, pose.position_m()) < 0.1);
  models::RangeScan scan;
  scan.stamp.time = kStart;
  scan.viewpoint = {pose, 1.0};
  scan.field_of_view_rad = scenario.mapping.scanner.field_of_view_rad;
  scan.range_max_m = scenario.mapping.scanner.range_max_m;
  scan.ranges_m =
      models::beam_scan(scenario.world, scenario.mapping.scanner, pose, random.engine());
  return scan;
}

models::RobotBelief belief_at(int step, const Pose2& pose = {}) {
  models::RobotBelief belief;
  belief.stamp.time = kStart + step * Duration{500'000};
  belief.step = step;
  belief.viewpoint = {pose, 1.0};
  return belief;
}

// Makes one step per element of `parts`, which contains the scans of that step. Returns the robot's
// map after the last step.
models::RobotMap map_of(TeamMap& team_map, const std::vector<std::vector<models::RangeScan>>& parts,
                        const std::vector<const models::RobotMap*>& teammates = {}) {
  models::RobotMap map;
  for (int step = 0; step < static_cast<int>(parts.size()); ++step) {
    std::vector<const models::RangeScan*> scans;
    for (const models::RangeScan& scan : parts[static_cast<std::size_t>(step)]) {
      scans.push_back(&scan);
    }
    const models::RobotBelief belief = belief_at(step);
    map = team_map.step({&belief, step == 0 ? nullptr : &map, scans, teammates});
  }
  return map;
}

TEST(TeamMap, SumsAllScansInAnyOrder) {
  const scenario::Scenario scenario = mapping_scenario();
  test::Random random(5301);
  std::vector<models::RangeScan> scans;
  for (int i = 0; i < 60; ++i) {
    scans.push_back(scan_of(scenario, random));
  }
  TeamMap alone(scenario, "Q1");
  const models::RobotMap all = map_of(alone, {scans});
  for (int shuffle = 0; shuffle < 5; ++shuffle) {
    std::shuffle(scans.begin(), scans.end(), random.engine());
    std::vector<std::vector<models::RangeScan>> parts(3);
    for (std::size_t i = 0; i < scans.size(); ++i) {
      parts[i % 3].push_back(scans[i]);
    }
    TeamMap q1(scenario, "Q1");
    TeamMap q2(scenario, "Q2");
    TeamMap q3(scenario, "Q3");
    const models::RobotMap of_2 = map_of(q2, {parts[1], {}});
    const models::RobotMap of_3 = map_of(q3, {{}, parts[2]});
    const models::RobotMap of_1 = map_of(q1, {parts[0], {}, {}}, {&of_3, &of_2});
    EXPECT_EQ(of_1.team_looks, all.own_looks);
    EXPECT_EQ(of_1.entropy_nats, all.entropy_nats);
  }
  EXPECT_LT(all.entropy_nats, 0.7 * 1200 * std::log(2.0)) << "the scans have information";
}

TEST(TeamMap, CountsATeammateOnce) {
  const scenario::Scenario scenario = mapping_scenario();
  test::Random random(5302);
  TeamMap q1(scenario, "Q1");
  TeamMap q2(scenario, "Q2");
  const models::RobotMap of_2 = map_of(q2, {{scan_of(scenario, random)}});
  const models::RobotMap once = map_of(q1, {{}}, {&of_2});
  const models::RobotMap thrice = map_of(q1, {{}, {}, {}}, {&of_2});
  EXPECT_EQ(thrice.team_looks, once.team_looks);
  EXPECT_EQ(once.team_looks, of_2.own_looks);
  EXPECT_EQ(once.own_looks, models::CellCounts(once.own_looks.size(), 0))
      << "observations of teammates are not passed on";
}

// A robot that hovers for hours saturates the observation counts of its cells.
TEST(TeamMap, IsIndependentOfOrderAtSaturation) {
  const scenario::Scenario scenario = mapping_scenario();
  TeamMap q1(scenario, "Q1");
  const models::RobotMap blank = map_of(q1, {{}});
  models::RobotMap far_up = blank;
  models::RobotMap up = blank;
  models::RobotMap down = blank;
  far_up.own_looks[7] = 32'767;
  up.own_looks[7] = 20'000;
  down.own_looks[7] = -32'768;
  const std::int16_t sum = 32'767 + 20'000 - 32'768;
  EXPECT_EQ(map_of(q1, {{}}, {&far_up, &up, &down}).team_looks[7], sum);
  EXPECT_EQ(map_of(q1, {{}}, {&down, &up, &far_up}).team_looks[7], sum);
  EXPECT_EQ(map_of(q1, {{}}, {&far_up, &up}).team_looks[7], 32'767);
}

TEST(TeamMap, IgnoresJammedAndUnknownScans) {
  const scenario::Scenario scenario = mapping_scenario();
  test::Random random(5303);
  TeamMap team_map(scenario, "Q1");
  const models::RobotMap nothing = map_of(team_map, {{}});
  models::RangeScan jammed = scan_of(scenario, random);
  jammed.jammed = true;  // its ranges are present but must be ignored
  models::RangeScan other = scan_of(scenario, random);
  other.ranges_m.pop_back();
  models::RangeScan outside = scan_of(scenario, random);
  outside.viewpoint.world_from_body.x_m = -1.0;
  const models::RobotMap map = map_of(team_map, {{jammed, other, outside}});
  EXPECT_EQ(map.own_looks, nothing.own_looks);
  EXPECT_EQ(team_map.counters().jammed_scans, 1);
  EXPECT_EQ(team_map.counters().malformed_scans, 2);
  EXPECT_NEAR(nothing.entropy_nats, 40 * 30 * std::log(2.0), 1e-6);
}

TEST(TeamMap, AcceptsOnlyRecentMapsOfNearbyRobotsOnTheSameGrid) {
  const scenario::Scenario scenario = mapping_scenario();
  TeamMap q1(scenario, "Q1");
  TeamMap q2(scenario, "Q2");
  models::RobotMap theirs = map_of(q2, {{}});
  theirs.viewpoint = {{3.0, 0.0, 0.0}, 1.0};
  EXPECT_TRUE(q1.accepts(belief_at(0), theirs)) << "3 m";
  EXPECT_FALSE(q1.accepts(belief_at(0, {-0.1, 0.0, 0.0}), theirs)) << "3.1 m";
  EXPECT_TRUE(q1.accepts(belief_at(3), theirs));
  EXPECT_FALSE(q1.accepts(belief_at(4), theirs)) << "four steps old";
  theirs.stamp.time += Duration{1};
  EXPECT_FALSE(q1.accepts(belief_at(0), theirs)) << "a future time";
  EXPECT_TRUE(q1.accepts(belief_at(1), theirs));
  theirs.grid.resolution_m *= 2.0;
  EXPECT_FALSE(q1.accepts(belief_at(1), theirs)) << "another grid";
  EXPECT_THROW(TeamMap(scenario, "Q9"), UsageError);
}

TEST(TeamMap, CopiesTimeStepAndViewpointFromTheBelief) {
  const scenario::Scenario scenario = mapping_scenario();
  TeamMap team_map(scenario, "Q2");
  const models::RobotBelief belief = belief_at(5, {1.0, 2.0, 0.3});
  models::RobotMap before;
  before.grid = models::map_geometry(scenario.world, scenario.mapping);
  before.own_looks.assign(static_cast<std::size_t>(before.grid.size()), 3);
  const models::RobotMap map = team_map.step({&belief, &before, {}, {}});
  EXPECT_EQ(map.stamp.time, belief.stamp.time);
  EXPECT_EQ(map.robot, "Q2");
  EXPECT_EQ(map.step, 5);
  EXPECT_EQ(map.viewpoint.world_from_body, belief.viewpoint.world_from_body);
  EXPECT_EQ(map.grid, before.grid);
  EXPECT_EQ(map.own_looks, before.own_looks);
  before.grid.resolution_m *= 2.0;  // a different grid: the map is reset
  EXPECT_EQ(team_map.step({&belief, &before, {}, {}}).own_looks,
            models::CellCounts(before.own_looks.size(), 0));
  EXPECT_THROW(team_map.step({nullptr, &before, {}, {}}), UsageError);
}

// Scans must match the scenario's scanner up to rounding of the field of view, which is published
// in a different unit.
TEST(TeamMap, AcceptsOnlyTheScenariosScanner) {
  const scenario::Scenario scenario = mapping_scenario();
  test::Random random(5304);
  const auto malformed = [&](double off_rad, double off_m, int surplus) {
    TeamMap team_map(scenario, "Q1");
    models::RangeScan scan = scan_of(scenario, random);
    scan.field_of_view_rad += off_rad;
    scan.range_max_m += off_m;
    scan.ranges_m.resize(scan.ranges_m.size() + static_cast<std::size_t>(surplus), 1.0);
    const models::RobotMap map = map_of(team_map, {{scan}});
    const bool is_counted = map.own_looks != models::CellCounts(map.own_looks.size(), 0);
    EXPECT_EQ(team_map.counters().malformed_scans, is_counted ? 0 : 1);
    return !is_counted;
  };
  EXPECT_FALSE(malformed(0.0, 0.0, 0));
  for (const double side : {-1.0, 1.0}) {
    EXPECT_FALSE(malformed(side * 0.6e-9, 0.0, 0));
    EXPECT_TRUE(malformed(side * 1.5e-9, 0.0, 0));
    EXPECT_TRUE(malformed(0.0, side * 1e-3, 0));
  }
  EXPECT_TRUE(malformed(0.0, 0.0, 1));
}

TEST(TeamMap, RefusesMapsOfAnotherGrid) {
  const scenario::Scenario scenario = mapping_scenario();
  TeamMap team_map(scenario, "Q1");
  models::RobotMap theirs;
  theirs.grid = models::map_geometry(scenario.world, scenario.mapping);
  theirs.own_looks.assign(static_cast<std::size_t>(theirs.grid.size()), 2);
  models::RobotMap others = theirs;
  others.grid.origin_m.x() += 0.1;
  EXPECT_EQ(map_of(team_map, {{}}, {&others, &theirs}).team_looks[0], 2);
  EXPECT_EQ(team_map.counters().malformed_maps, 1);
}

TEST(TeamMap, IncludesTheFirstCellOfAScan) {
  const scenario::Scenario scenario = mapping_scenario();
  test::Random random(5305);
  TeamMap team_map(scenario, "Q1");
  models::RangeScan scan = scan_of(scenario, random);
  scan.viewpoint.world_from_body = {0.05, 0.05, 0.4};
  EXPECT_LT(map_of(team_map, {{scan}}).own_looks[0], 0);
  EXPECT_EQ(team_map.counters().malformed_scans, 0);
}

TEST(MapCounters, AreListedWhenNonZero) {
  EXPECT_TRUE(MapCounters{}.named().empty());
  const std::vector<models::NamedCount> all = MapCounters{1, 2, 3}.named();
  ASSERT_EQ(all.size(), 3U);
  const std::string names[] = {"map.jammed_scans", "map.malformed_scans", "map.malformed_maps"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(all[i].name, names[i]);
    EXPECT_EQ(all[i].count, static_cast<std::int64_t>(i) + 1);
  }
}

}  // namespace
}  // namespace vantage::estimator
