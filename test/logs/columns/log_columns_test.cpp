#include "logs/columns/log_columns.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "vantage_lcm/plan_t.hpp"

#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

template <class Value>
std::vector<Value> column(LogColumns& of, const std::string& name) {
  for (const LogColumn& each : of.columns()) {
    if (each.name == name) {
      return std::get<std::vector<Value>>(each.values);
    }
  }
  ADD_FAILURE() << "no column " << name;
  return {};
}

vantage_lcm::plan_t plan(std::int64_t round, const std::string& robot) {
  vantage_lcm::plan_t out{};
  out.utime = 1'000 + round;
  out.robot = robot;
  out.round = round;
  out.source = -2;
  out.height_m = 1.5;
  out.late = static_cast<std::int8_t>(round % 2);
  for (int i = 0; i < round; ++i) {
    vantage_lcm::plan_segment_t segment{};
    segment.speed_mps = 0.25 * i;
    out.segments.push_back(segment);
    out.inputs.push_back({"BELIEF_" + robot, i, 7});
  }
  out.num_segments = out.num_inputs = static_cast<std::int32_t>(round);
  return out;
}

// Text and lists stand before numbers that are read right: nothing is read from another's place.
TEST(LogColumns, HaveEveryFieldOfEveryMessageUnderItsName) {
  LogColumns columns(*bus::find_wire_schema("plan_t"));
  const std::string robots[] = {"Q1", "", "a robot with a name"};
  for (int round = 0; round < 3; ++round) {
    EXPECT_TRUE(columns.add(from_utime(5 + round), test::encoded(plan(round, robots[round]))));
  }
  EXPECT_EQ(columns.logged_utime(), (std::vector<std::int64_t>{5, 6, 7}));
  EXPECT_EQ(column<std::int64_t>(columns, "utime"), (std::vector<std::int64_t>{1000, 1001, 1002}));
  EXPECT_EQ(column<std::string>(columns, "robot"),
            (std::vector<std::string>{robots[0], robots[1], robots[2]}));
  EXPECT_EQ(column<std::int64_t>(columns, "round"), (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_EQ(column<std::int64_t>(columns, "source"), (std::vector<std::int64_t>{-2, -2, -2}));
  EXPECT_EQ(column<double>(columns, "height_m"), (std::vector<double>{1.5, 1.5, 1.5}));
  EXPECT_EQ(column<std::uint8_t>(columns, "late"), (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_EQ(column<double>(columns, "segments.speed_mps"), (std::vector<double>{0.0, 0.0, 0.25}));
  EXPECT_EQ(column<std::string>(columns, "inputs.channel"),
            (std::vector<std::string>{"BELIEF_", "BELIEF_" + robots[2], "BELIEF_" + robots[2]}));
  EXPECT_EQ(column<std::int64_t>(columns, "inputs.run_id"), (std::vector<std::int64_t>{0, 0, 1}));
  ASSERT_EQ(columns.lists().size(), 2U);
  for (const LogList& list : columns.lists()) {
    EXPECT_EQ(list.offsets, (std::vector<std::int64_t>{0, 0, 1, 3})) << list.name;
    EXPECT_EQ(list.parent, -1);
  }
}

TEST(LogColumns, TakeNothingOfWhatIsNotExactlyOneMessage) {
  LogColumns columns(*bus::find_wire_schema("plan_t"));
  test::Bytes bytes = test::encoded(plan(1, "Q1"));
  bytes.push_back(0);
  EXPECT_FALSE(columns.add({}, bytes));
  bytes.resize(bytes.size() - 2);
  EXPECT_FALSE(columns.add({}, bytes));
  EXPECT_FALSE(columns.add({}, {}));
  EXPECT_TRUE(columns.logged_utime().empty());
  EXPECT_TRUE(column<std::string>(columns, "robot").empty());
}

}  // namespace
}  // namespace vantage::logs
