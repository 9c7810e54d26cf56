#include "logs/columns/log_columns.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "vantage_lcm/plan_t.hpp"

#include "logs/json/wire_json.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_messages.hpp"
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

// Numbers are read correctly although texts and lists of different lengths precede them.
TEST(LogColumns, ContainEveryFieldByName) {
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

TEST(LogColumns, RefuseIncompleteMessages) {
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

using Json = nlohmann::ordered_json;

/// The expected columns, built from the JSON of the same messages.
struct Oracle {
  std::map<std::string, std::vector<Json>> values;
  std::map<std::string, std::vector<std::int64_t>> counts;
  std::map<std::string, std::string> list_of;  ///< by column; "NAME itself": parent of list NAME

  void add(const bus::WireSchema& schema, const Json& message, const std::string& prefix,
           const std::string& list) {
    for (const bus::WireField& field : schema.fields) {
      const std::string name = prefix + std::string(field.name);
      std::vector<Json> elements{message.at(std::string(field.name))};
      for (int dim = 0; dim < field.rank; ++dim) {
        std::vector<Json> inner;
        for (const Json& each : elements) {
          inner.insert(inner.end(), each.begin(), each.end());
        }
        elements = inner;
      }
      const bool is_list = field.rank > 0 && (field.kind == bus::WireKind::kStruct ||
                                              field.dims[0].field >= 0 || field.dims[1].field >= 0);
      if (is_list) {
        counts[name].push_back(std::ssize(elements));
        list_of[name + " itself"] = list;
      }
      list_of[name] = is_list ? name : list;
      for (const Json& each : elements) {
        if (field.kind == bus::WireKind::kStruct) {
          add(*field.nested, each, name + ".", is_list ? name : list);
        } else {
          values[name].push_back(each);
        }
      }
    }
  }
};

void expect_same(const LogColumn& column, const std::vector<Json>& wanted) {
  std::visit(
      [&](const auto& values) {
        ASSERT_EQ(values.size(), wanted.size()) << column.name;
        for (std::size_t i = 0; i < wanted.size(); ++i) {
          using Value = std::decay_t<decltype(values[i])>;
          if constexpr (std::is_same_v<Value, double>) {
            ASSERT_TRUE(wanted[i].is_null() ? !std::isfinite(values[i])
                                            : wanted[i].get<double>() == values[i])
                << column.name;
          } else if constexpr (std::is_same_v<Value, std::uint8_t>) {
            ASSERT_EQ(wanted[i].is_boolean(), column.is_boolean) << column.name;
            ASSERT_EQ(wanted[i].get<int>(), int{values[i]}) << column.name;
          } else {
            ASSERT_EQ(wanted[i].get<Value>(), values[i]) << column.name;
          }
        }
      },
      column.values);
}

template <class Message>
class LogColumnsOf : public ::testing::Test {};
TYPED_TEST_SUITE(LogColumnsOf, vantage::test::MessageTypes);

TYPED_TEST(LogColumnsOf, EqualTheJsonOfTheSameMessages) {
  const bus::WireSchema& schema = *bus::find_wire_schema(bus::WireOf<TypeParam>::getTypeName());
  LogColumns columns(schema);
  Oracle oracle;
  vantage::test::Sampler sampler(17);
  for (int i = 0; i < 30; ++i) {
    const auto bytes = vantage::test::encoded(vantage::test::sample<TypeParam>(sampler));
    ASSERT_TRUE(columns.add(from_utime(i), bytes));
    oracle.add(schema, *message_json(bytes), "", "");
  }
  const auto name_of = [&](int list) {
    return list < 0 ? std::string() : columns.lists().at(static_cast<std::size_t>(list)).name;
  };
  for (const LogColumn& column : columns.columns()) {
    expect_same(column, oracle.values[column.name]);
    if (!oracle.values[column.name].empty()) {
      EXPECT_EQ(name_of(column.list), oracle.list_of[column.name]) << column.name;
    }
  }
  for (const LogList& list : columns.lists()) {
    const std::vector<std::int64_t>& counts = oracle.counts[list.name];
    ASSERT_EQ(list.offsets.size(), counts.size() + 1) << list.name;
    EXPECT_EQ(list.offsets[0], 0);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      EXPECT_EQ(list.offsets[i + 1] - list.offsets[i], counts[i]) << list.name;
    }
    if (!counts.empty()) {
      EXPECT_EQ(name_of(list.parent), oracle.list_of[list.name + " itself"]) << list.name;
    }
  }
  EXPECT_EQ(columns.logged_utime().size(), 30U);
}

TEST(LogColumns, ReportTheShapeOfFixedArrays) {
  LogColumns columns(*bus::find_wire_schema("mocap_frame_t"));
  std::map<std::string, std::vector<std::size_t>> shapes;
  for (const LogColumn& column : columns.columns()) {
    shapes[column.name] = column.item_shape;
  }
  using Shape = std::vector<std::size_t>;
  EXPECT_EQ(shapes.at("bodies.position_world_m"), Shape{3});
  EXPECT_EQ(shapes.at("bodies.quaternion_wxyz"), Shape{4});
  EXPECT_EQ(shapes.at("bodies.name"), Shape{});
  EXPECT_EQ(shapes.at("utime"), Shape{});
}

}  // namespace
}  // namespace vantage::logs
