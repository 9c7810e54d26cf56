#include "logs/types/type_library.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "core/check.hpp"
#include "foreign/arm_t.hpp"
#include "foreign/joint_t.hpp"
#include "foreign/point_t.hpp"
#include "foreign/tree_t.hpp"
#include "logs/json/wire_json.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using Json = nlohmann::ordered_json;

const std::string kHouse = std::string(VANTAGE_SOURCE_DIR) + "/lcmtypes";
const std::string kForeign = std::string(VANTAGE_SOURCE_DIR) + "/test/logs/types";

template <class... Wire>
void expect_fingerprints(const TypeLibrary& types, const std::string& package) {
  const auto expect = [&](const std::string& name, std::int64_t hash) {
    EXPECT_EQ(types.fingerprint(package + "." + name), static_cast<std::uint64_t>(hash)) << name;
  };
  (expect(Wire::getTypeName(), Wire::getHash()), ...);
}

foreign::arm_t an_arm() {
  foreign::arm_t arm{};
  arm.utime = -5;
  arm.name = "left";
  arm.mode = -3;
  arm.gear = -300;
  arm.num_joints = 2;
  arm.position_rad = {0.25, -1.5};
  arm.bias_rad[2] = 7.0;
  arm.effort_n = {{1.5F, 2.5F}, {std::numeric_limits<float>::infinity(), 0.0F}};
  arm.is_enabled = 1;
  arm.raw = {0, 255};
  arm.joints.resize(2);
  arm.joints[1].name = "elbow";
  arm.joints[1].at_m.y = 0.5;
  arm.tip_m.z = 2.0;
  arm.touch.assign(2, {2, std::vector<std::int16_t>(3)});
  arm.touch[1][0][2] = -9;
  arm.notes[0] = "ü";
  return arm;
}

TEST(TypeLibrary, ComputesLcmGensFingerprints) {
  using namespace vantage_lcm;  // NOLINT(google-build-using-namespace): all of them
  const TypeLibrary house({kHouse});
  expect_fingerprints<attack_t, belief_t, mocap_body_t, collision_t, command_t, counter_t,
                      detection_t, health_t, host_t, input_ref_t, map_t, measurement_t,
                      mixture_component_t, mixture_t, target_mixture_t, plan_segment_t, plan_t,
                      proposal_t, vehicle_t, scan_t, scenario_t, supervised_t, target_belief_t,
                      team_choice_t, team_proposal_t, truth_body_t, truth_t, mocap_frame_t>(
      house, "vantage_lcm");
  const TypeLibrary others({kForeign});
  EXPECT_EQ(others.size(), 4U);
  expect_fingerprints<foreign::arm_t, foreign::joint_t, foreign::point_t, foreign::tree_t>(
      others, "foreign");
  EXPECT_FALSE(others.fingerprint("foreign.nobody_t"));
}

TEST(TypeLibrary, ReadsEveryKindOfMember) {
  const TypeLibrary types(
      {kForeign + "/arm_t.lcm", kForeign + "/joint_t.lcm", kForeign + "/point_t.lcm"});
  const auto bytes = test::encoded(an_arm());
  EXPECT_FALSE(message_json(bytes)) << "not a vantage type";
  ASSERT_NE(types.find(bytes), nullptr);
  EXPECT_EQ(types.find(bytes)->name, "foreign.arm_t");
  const auto json = message_json(bytes, *types.find(bytes));
  ASSERT_TRUE(json);
  EXPECT_EQ(*json, Json::parse(R"({
    "utime": -5, "name": "left", "mode": -3, "gear": -300, "num_joints": 2,
    "position_rad": [0.25, -1.5], "bias_rad": [0.0, 0.0, 7.0],
    "effort_n": [[1.5, 2.5], [null, 0.0]], "is_enabled": true, "raw": [0, 255],
    "joints": [{"name": "", "at_m": {"x": 0.0, "y": 0.0, "z": 0.0}},
               {"name": "elbow", "at_m": {"x": 0.0, "y": 0.5, "z": 0.0}}],
    "tip_m": {"x": 0.0, "y": 0.0, "z": 2.0},
    "touch": [[[0, 0, 0], [0, 0, 0]], [[0, 0, -9], [0, 0, 0]]],
    "notes": ["ü", ""]})"));
}

TEST(TypeLibrary, ReadsRecursiveTypes) {
  const TypeLibrary types({kForeign});
  foreign::tree_t tree{};
  tree.value = 1;
  tree.num_children = 2;
  tree.children.resize(2);
  tree.children[1].value = 3;
  const auto bytes = test::encoded(tree);
  ASSERT_NE(types.find(bytes), nullptr);
  const auto json = message_json(bytes, *types.find(bytes));
  ASSERT_TRUE(json);
  EXPECT_EQ(json->at("children").at(1).at("value"), 3);
}

TEST(TypeLibrary, RefusesTruncatedAndOversizedMessages) {
  const TypeLibrary types({kForeign});
  auto bytes = test::encoded(an_arm());
  const bus::WireSchema& schema = *types.find(bytes);
  for (std::size_t size = 8; size < bytes.size(); ++size) {
    EXPECT_FALSE(message_json(std::span(bytes).first(size), schema)) << size;
  }
  bytes.push_back(0);
  EXPECT_FALSE(message_json(bytes, schema));
  EXPECT_EQ(types.find(std::span(bytes).first(7)), nullptr);
  bytes[0] ^= 1U;
  EXPECT_EQ(types.find(bytes), nullptr);
}

TEST(TypeLibrary, RefusesHugeCountsOfEmptyRows) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.file("deep.lcm")) << "struct deep_t { int32_t a, b, c; byte x[a][b][c]; }";
  const TypeLibrary types({folder.file("deep.lcm")});
  std::vector<std::uint8_t> bytes;
  const auto put = [&](std::uint64_t value, int width) {
    for (int i = width; i-- > 0;) {
      bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  };
  put(*types.fingerprint("deep_t"), 8);
  for (const std::uint64_t count : {0x7FFFFFFFU, 0x7FFFFFFFU, 0U}) {
    put(count, 4);
  }
  ASSERT_NE(types.find(bytes), nullptr);
  EXPECT_FALSE(message_json(bytes, *types.find(bytes)));
}

TEST(TypeLibrary, ContainsVantagesTypes) {
  const TypeLibrary types({kHouse, kForeign});
  const auto bytes = test::encoded(vantage_lcm::attack_t{});
  EXPECT_EQ(types.find(bytes), bus::find_wire_schema("attack_t"));
  EXPECT_EQ(TypeLibrary().find(bytes), bus::find_wire_schema("attack_t"));
  EXPECT_EQ(TypeLibrary().find(test::encoded(an_arm())), nullptr);
}

TEST(TypeLibrary, ReportsFaultyFiles) {
  test::TemporaryFolder folder;
  const auto why_not = [](const std::vector<std::string>& paths) {
    try {
      const TypeLibrary types(paths);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto written = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder.file(name)) << text;
    return folder.file(name);
  };
  EXPECT_EQ(why_not({folder.file("none.lcm")}), folder.file("none.lcm") + ": cannot be read");
  EXPECT_NE(why_not({folder.file("")}).find("contains no .lcm file"), std::string::npos);
  const std::string lonely = written("lonely.lcm", "struct a_t {\n  b_t b;\n}\n");
  EXPECT_EQ(why_not({lonely}),
            lonely + ":1: a_t: its member b has type b_t, which none of the given files defines");
  const std::string other = written("other.lcm", "struct b_t { double x; }");
  EXPECT_EQ(why_not({lonely, other}), "");
  EXPECT_EQ(why_not({lonely, other, other}), "") << "a repeated type";
  const std::string another = written("another.lcm", "\nstruct b_t { float x; }");
  EXPECT_EQ(why_not({lonely, other, another}),
            another + ":2: b_t differs from its definition in " + other);
}

TEST(TypeLibrary, ReportsOversizedFiles) {
  const test::TemporaryFolder folder;
  const auto library = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder.file(name)) << text;
    try {
      const TypeLibrary types({folder.file(name)});
      EXPECT_EQ(types.size(), 1U);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(library("flat.lcm", "struct a_t { byte x[1][2][3][4]; }"), "");
  EXPECT_EQ(library("deep.lcm", "\nstruct a_t { byte x[1][2][3][4][5]; }"),
            folder.file("deep.lcm") + ":2: a_t: its member x has more than " +
                std::to_string(bus::kWireDims) + " dimensions");
  for (const std::size_t more : {0U, 1U}) {
    std::string text = "struct a_t {";
    for (std::size_t i = 0; i < bus::kWireFieldsMax + more; ++i) {
      text += "byte x" + std::to_string(i) + ";";
    }
    const std::string name = "wide" + std::to_string(more) + ".lcm";
    EXPECT_EQ(library(name, text + "}"), more == 0 ? ""
                                                   : folder.file(name) + ":1: a_t: more than " +
                                                         std::to_string(bus::kWireFieldsMax) +
                                                         " members");
  }
}

// The first in alphabetical order of two types with the same wire format is used; folders are
// searched recursively.
TEST(TypeLibrary, FindsTypesInFoldersAndUsesTheFirstMatch) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder.file("deep/deeper"));
  std::ofstream(folder.file("deep/z.lcm")) << "struct z_t { double x; }";
  std::ofstream(folder.file("deep/deeper/b.lcm")) << "package p; struct b_t { double x; }";
  std::ofstream(folder.file("deep/no.txt")) << "struct {";
  const TypeLibrary types({folder.path()});
  EXPECT_EQ(types.size(), 2U);
  ASSERT_TRUE(types.fingerprint("z_t"));
  EXPECT_EQ(types.fingerprint("z_t"), types.fingerprint("p.b_t"))
      << "names do not change the fingerprint";
  std::vector<std::uint8_t> bytes;
  append_big_endian(*types.fingerprint("z_t"), 8, bytes);
  ASSERT_NE(types.find(bytes), nullptr);
  EXPECT_EQ(types.find(bytes)->name, "p.b_t");
  bytes.pop_back();
  EXPECT_EQ(types.find(bytes), nullptr);
}

}  // namespace
}  // namespace vantage::logs
