#include "logs/json/wire_json.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "bus/convert/wire_walk.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_messages.hpp"

namespace vantage::logs {
namespace {

using Json = nlohmann::ordered_json;

bool is_matrix(const Json& value) {
  return value.is_array() &&
         std::all_of(value.begin(), value.end(), [](const Json& row) { return row.is_array(); });
}

/// Expects that every value of `json` has the type that `schema` states, and that no member is
/// unknown or missing. Matrices are the exception: the schema must not contain them.
void expect_fits(const Json& schema, const Json& json, const std::string& path) {
  const std::string type = schema.at("type");
  if (type == "object") {
    ASSERT_TRUE(json.is_object()) << path;
    const Json& known = schema.at("properties");
    for (const auto& [name, property] : known.items()) {
      EXPECT_TRUE(json.contains(name)) << path << "." << name;
      EXPECT_TRUE(property.at("type") != "array" || property.at("items").at("type") != "array")
          << path << "." << name << ": Foxglove's viewers refuse a channel with lists of lists";
    }
    for (const auto& [name, value] : json.items()) {
      if (known.contains(name)) {
        expect_fits(known.at(name), value, path + "." + name);
      } else {
        EXPECT_TRUE(is_matrix(value)) << path << "." << name;
      }
    }
  } else if (type == "array") {
    ASSERT_TRUE(json.is_array()) << path;
    for (const Json& element : json) {
      expect_fits(schema.at("items"), element, path + "[]");
    }
  } else if (type == "number") {
    EXPECT_TRUE(json.is_number_float() || json.is_null()) << path << json;
  } else {
    EXPECT_TRUE(type == "integer"   ? json.is_number_integer()
                : type == "boolean" ? json.is_boolean()
                                    : json.is_string())
        << path << json;
  }
}

template <class Message>
class MessageJson : public ::testing::Test {};
TYPED_TEST_SUITE(MessageJson, test::MessageTypes);

TYPED_TEST(MessageJson, FitsItsSchemaForEveryMessage) {
  test::Sampler sampler(7);
  for (int i = 0; i < 200; ++i) {
    const TypeParam message = test::sample<TypeParam>(sampler);
    const auto json = message_json(test::encoded(message));
    ASSERT_TRUE(json.has_value());
    const auto* schema = bus::find_wire_schema(bus::WireOf<TypeParam>::getTypeName());
    expect_fits(json_schema(*schema), *json, std::string(schema->name));
    EXPECT_EQ(json->at("utime"), to_utime(message.stamp.time));
    EXPECT_EQ(json->at("run_id"), message.stamp.run_id);
    EXPECT_EQ(json->at("sequence"), message.stamp.sequence);
  }
}

TEST(MessageJsonOfAPlan, ContainsEveryNumberExactly) {
  test::Sampler sampler(3);
  for (int i = 0; i < 100; ++i) {
    models::RobotPlan plan = test::sample<models::RobotPlan>(sampler);
    plan.lower_bound = -std::numeric_limits<double>::infinity();
    const Json json = Json::parse(message_json(test::encoded(plan))->dump());
    ASSERT_EQ(json.at("segments").size(), plan.trajectory.segments.size());
    for (std::size_t k = 0; k < plan.trajectory.segments.size(); ++k) {
      EXPECT_EQ(json.at("segments")[k].at("speed_mps").template get<double>(),
                plan.trajectory.segments[k].control.speed_mps);
    }
    EXPECT_EQ(json.at("robot"), plan.robot);
    EXPECT_TRUE(json.at("lower_bound_nat").is_null());
    EXPECT_EQ(json.at("late"), plan.late);
  }
}

TEST(MessageJsonOfABelief, WritesMatricesAsRows) {
  vantage_lcm::belief_t belief{};
  vantage_lcm::target_belief_t target{};
  target.target_id = 4;
  target.dim = 2;
  target.information_vector = {1.0, 2.0};
  target.information_matrix = {{3.0, 4.0}, {4.0, 5.0}};
  belief.num_targets = 1;
  belief.targets = {target};
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(belief.getEncodedSize()));
  belief.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  const auto json = message_json(bytes);
  ASSERT_TRUE(json.has_value());
  EXPECT_EQ(json->at("targets")[0].at("information_matrix"), (Json{{3.0, 4.0}, {4.0, 5.0}}));
}

TEST(MessageJson, RefusesEmptyAndTruncatedMessages) {
  EXPECT_FALSE(message_json({}).has_value());
  test::Sampler sampler(3);
  auto bytes = test::encoded(test::sample<models::MocapFrame>(sampler));
  bytes.pop_back();
  EXPECT_FALSE(message_json(bytes).has_value());
  bytes[0] ^= 1U;
  EXPECT_FALSE(message_json(bytes).has_value());
}

}  // namespace
}  // namespace vantage::logs
