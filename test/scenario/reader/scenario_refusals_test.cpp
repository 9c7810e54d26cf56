#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/utf8.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/support/lab_text.hpp"

namespace vantage::scenario {
namespace {

/// One change of config/lab.yaml that must be refused. The '@' in `becomes` marks the line that the
/// message must name; it is removed before reading.
struct BadEdit {
  const char* name;
  const char* was;
  const char* becomes;
  const char* words;
};

void PrintTo(const BadEdit& edit, std::ostream* out) { *out << edit.name; }

std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(parse_scenario(text, "lab.yaml"));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "accepted";
}

class BadScenario : public testing::TestWithParam<BadEdit> {};

TEST_P(BadScenario, IsRefusedWithLineAndReason) {
  std::string text = test::lab_with({{GetParam().was, GetParam().becomes}});
  const std::size_t mark = text.find('@');
  ASSERT_NE(mark, std::string::npos);
  text.erase(mark, 1);
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(mark), '\n');

  const std::string refusal = refusal_of(text);
  EXPECT_EQ(refusal.rfind("lab.yaml:" + std::to_string(line) + ": ", 0), 0U)
      << "expected line " << line << " in: " << refusal;
  EXPECT_NE(refusal.find(GetParam().words), std::string::npos)
      << "expected '" << GetParam().words << "' in: " << refusal;
}

// clang-format off
const BadEdit kKeys[] = {
    {"UnknownKey", "duration_s: 300", "@duration: 300", "duration: unknown key, wrong unit; did you mean duration_s?"},
    {"UnknownKeyWithin", "ceiling_m: 3", "@sealing_m: 3", "world.sealing_m: unknown key; did you mean ceiling_m?"},
    {"UnknownKeyFarFromAll", "seed: 1 ", "@colour: 1 ", "colour: unknown key; valid keys are name, duration_s, seed, world"},
    {"UnknownKeyInDefaults", "  device: direct             # direct", "  @devise: direct #", "robot_defaults.devise: unknown key; did you mean device?"},
    {"UnknownKeyInRobot", "    height_m: 1.5", "    @heigth_m: 1.5", "robots[1].heigth_m: unknown key; did you mean height_m?"},
    {"MergeKey", "seed: 1 ", "@<<: {} ", "<<: unknown key"},
    {"Millimetres", "range_max_m: 1 ", "@range_max_mm: 1 ", "robot_defaults.sensor.range_max_mm: unknown key, wrong unit; did you mean range_max_m?"},
    {"KilometresPerHour", "    speed_max_mps: 1 ", "    @speed_max_kmh: 1 ", "wrong unit; did you mean speed_max_mps?"},
    {"Milliseconds", "  latency_s: 0.005", "  @latency_ms: 5", "mocap.latency_ms: unknown key, wrong unit; did you mean latency_s?"},
    {"AngleWithoutUnit", "fov_deg: 360", "@fov: 360", "fov: unknown key, wrong unit; did you mean fov_rad?"},
    {"DuplicateKey", "seed: 1 ", "seed: 1\n@seed: 2 ", "seed: duplicate key, first given on line"},
    {"DuplicateKeyWithin", "  step_s: 0.5", "  step_s: 0.5\n  @step_s: 0.5", "planner.step_s: duplicate key, first given on line"},
    {"DuplicateKeyInFlow", "{x_m: 0, y_m: 0, yaw_deg: 90}", "{x_m: 0, y_m: 0,\n      @x_m: 0}", "robots[1].start.x_m: duplicate key"},
    {"AngleTwice", "fov_deg: 360 ", "fov_deg: 360\n    @fov_rad: 6 ", "fov_rad: given twice, as fov_rad and as fov_deg"},
};

const BadEdit kValues[] = {
    {"TextForNumber", "duration_s: 300", "@duration_s: five minutes", "duration_s: must be a number, is 'five minutes'"},
    {"NumberWithUnit", "duration_s: 300", "@duration_s: 300s", "must be a number, is '300s'"},
    {"QuotedNumber", "duration_s: 300", "@duration_s: \"300\"", "must be a plain number, is the text '300'"},
    {"ListForNumber", "duration_s: 300", "@duration_s: [300]", "must be a number, is a list"},
    {"NothingForNumber", "duration_s: 300", "@duration_s:", "duration_s: has no value"},
    {"NotANumber", "duration_s: 300", "@duration_s: .nan", "must be a finite number, is '.nan'"},
    {"Infinity", "range_max_m: 1 ", "@range_max_m: .inf", "range_max_m: must be a finite number"},
    {"CInfinity", "range_max_m: 1 ", "@range_max_m: -inf", "range_max_m: must be a finite number"},
    {"TooLongANumber", "range_max_m: 1 ", "@range_max_m: 1e999", "must be a finite number that a double can hold, is '1e999'"},
    {"FractionForInteger", "horizon_steps: 12", "@horizon_steps: 12.0", "must be a whole number, is '12.0'"},
    {"NegativeSeed", "seed: 1 ", "@seed: -1 ", "seed: must be a whole number of at least 0"},
    {"SeedOverflow", "seed: 1 ", "@seed: 18446744073709551616 ", "seed: must be a whole number of at least 0"},
    {"WordForFlag", "variance_grows_with_range: false", "@variance_grows_with_range: no", "must be true or false, is 'no'"},
    {"UnknownWord", "algorithm: arvi", "@algorithm: dijkstra", "must be one of arvi, beam, rvi, fvi, greedy, astar, wastar, aegis, sampling_tree, random_walk, lawn_mower, external; is 'dijkstra'"},
    {"UnknownAutopilotKey", "  - name: Q3\n", "  - name: Q3\n    @autopilot: {dialect: px4, url: \"udp://:14540\", port: 1}\n", "autopilot.port: unknown key"},
    {"AutopilotWithoutAUrl", "  - name: Q3\n", "  - name: Q3\n    @autopilot: {dialect: px4}\n", "url"},
    {"AutopilotWithAStrangeUrl", "  - name: Q3\n", "  - name: Q3\n    @autopilot: {dialect: px4, url: \"tcp://h:1\"}\n", "must begin with udp://, udpout:// or serial:"},
    {"UnknownDialect", "  - name: Q3\n", "  - name: Q3\n    @autopilot: {dialect: ino, url: \"udp://:1\"}\n", "must be one of px4, ardupilot"},
    {"AutopilotSystemIdBeyondAByte", "  - name: Q3\n", "  - name: Q3\n    @autopilot: {dialect: px4, url: \"udp://:1\", system_id: 256}\n", "system_id"},
    {"NeighbourhoodThatIsTooSmall", "  communication_range_m: 3 ", "  @neighbourhood_m: 5\n  communication_range_m: 3 ", "must be 0 (off) or at least 17.5 here"},
    {"SecurityWithoutKeys", "network:\n", "@security:\n  mode: require\nnetwork:\n", "must name the folder that `vantage keys new` created"},
    {"SecurityOfAnUnknownMode", "network:\n", "security:\n  @mode: always\n  keys: keys\nnetwork:\n", "off"},
    {"SecurityWithoutAMode", "network:\n", "@security: {keys: keys}\nnetwork:\n", "mode"},
    {"RealAutopilotWithoutASystemId", "  - name: Q3\n", "  - name: Q3\n    device: real\n    @autopilot: {dialect: px4, url: \"udp://:1\"}\n", "must contain the system_id, 1 to 255, of a real vehicle"},
    {"RealAutopilotThatDoesNotSign", "  - name: Q3\n", "  - name: Q3\n    device: real\n    @autopilot: {dialect: px4, url: \"udp://:1\", system_id: 1}\n", "must contain the key_file of a real vehicle"},
    {"UnknownParameterPolicy", "  - name: Q3\n", "  - name: Q3\n    @autopilot: {dialect: px4, url: \"udp://:1\", parameters: perhaps}\n", "must be one of verify, warn, ignore; is 'perhaps'"},
    {"BatteryWithoutCells", "  - name: Q3\n", "  - name: Q3\n    @autopilot: {dialect: px4, url: \"udp://:1\", battery: {full_v: 4.2}}\n", "cells"},
    {"BatteryFullerWhenEmpty", "  - name: Q3\n", "  - name: Q3\n    @autopilot: {dialect: px4, url: \"udp://:1\", battery: {cells: 3, empty_v: 4.2, full_v: 4.1}}\n", "must be above empty_v (4.2), but is 4.1"},
    {"RoverWithoutAUrl", "  - name: Q3\n", "  - name: Q3\n    @rover: {number: 1}\n", "url"},
    {"RoverOnASerialLine", "  - name: Q3\n", "  - name: Q3\n    @rover: {url: \"serial:/dev/ttyS0\"}\n", "must begin with udp:// or udpout://"},
    {"RoverNumberZero", "  - name: Q3\n", "  - name: Q3\n    @rover: {url: \"udp://:1\", number: 0}\n", "number"},
    {"UnknownDevice", "  device: direct             # direct", "  @device: fake #", "must be one of direct, wire, real; is 'fake'"},
    {"MappingForList", "  regions: []", "  @regions: {a: 1}", "world.regions: must be a list, is a mapping"},
    {"PointOfThree", "max_m: [4, 2]", "@max_m: [4, 2, 3]", "world.bounds.max_m: must be a list of two numbers [x, y], is a list of 3"},
    {"TextInPoint", "max_m: [4, 2]", "max_m: [4,\n      @two]", "world.bounds.max_m[1]: must be a number, is 'two'"},
    {"BadName", "name: lab ", "@name: ../lab ", "must contain only letters, digits, - and _"},
    {"BadUrl", "url: \"udpm://", "@url: \"tcp://", "must begin with udpm:// or memq://"},
};

const BadEdit kRanges[] = {
    {"NoDuration", "duration_s: 300", "@duration_s: 0", "must be above 0 and at most 86400, is 0"},
    {"EmptyBounds", "max_m: [4, 2]", "@max_m: [4, -2]", "must be above min_m ([-4, -2]) in x and in y, but is [4, -2]"},
    {"ObstacleInsideOut", "max_m: [-1.2, 1.1]", "@max_m: [-1.9, 1.1]", "world.obstacles[0].footprint.max_m: must be above min_m"},
    {"ObstacleOutside", "{min_m: [-1.8, 0.5], max_m: [-1.2, 1.1]}", "@{min_m: [-1.8, 5], max_m: [-1.2, 6]}", "footprint: must overlap world.bounds; is entirely outside"},
    {"NegativeRange", "range_max_m: 1 ", "@range_max_m: -1 ", "range_max_m: must be above 0 and at most 10000, is -1"},
    {"RangesCrossed", "range_min_m: 0.1", "@range_min_m: 1.5", "must be below range_max_m (1), but is 1.5"},
    {"BearingWithoutLeastRange", "range_min_m: 0.1", "@range_min_m: 0", "must be above 0 for a sensor that measures bearings"},
    {"CameraWithoutLeastDepth", "depth_min_m: 0.05", "@depth_min_m: 0", "depth_min_m: must be above 0, is 0"},
    {"MoreThanATurn", "fov_deg: 360", "@fov_deg: 361", "must be above 0 and at most 360, is 361"},
    {"SpeedsCrossed", "speed_min_mps: 0.2", "@speed_min_mps: 2", "must be at most speed_max_mps (1.4), but is 2"},
    {"CertainDetection", "detection_probability: 0.8", "@detection_probability: 1", "must be at least 0 and below 1, is 1"},
    {"EndlessGrid", "grid_resolution_m: 0.25", "@grid_resolution_m: 0.0001", "must divide world.bounds into at most"},
    {"NegativeQ", "    q: 0.3", "    @q: -0.15", "estimator.target_model.q: must be at least 0, is -0.15"},
    {"OscillatorWithoutDamping", "damping_per_s: [0.24, 0.41]", "@damping_per_s: [0.24, 0]", "estimator.target_model.damping_per_s[1]: must be above 0, is 0"},
    {"OscillatorWithoutSpread", "position_sigma_m: [1.75, 0.83]", "@position_sigma_m: [0, 0.83]", "estimator.target_model.position_sigma_m[0]: must be above 0 and at most 10000, is 0"},
    {"OscillatorOfOneSigma", "velocity_sigma_mps: [0.47, 0.29]", "@velocity_sigma_mps: 0.4", "estimator.target_model.velocity_sigma_mps: must be a list of two numbers [x, y]"},
    {"TargetsInFourDimensions", "position_dim: 2", "@position_dim: 4", "must be at least 2 and at most 3, is '4'"},
    {"RoundTooShort", "team_budget_s: 0.5", "@team_budget_s: 0.96", "must be at most the round (execute_steps · step_s = 1 s) minus publish_margin_s (0.05), but is 0.96"},
    {"ExecutesBeyondItsHorizon", "execute_steps: 2", "@execute_steps: 13", "must be at most horizon_steps (12), but is 13"},
    {"MocapOfAnUnknownProtocol", "  rate_hz: 50\n", "  rate_hz: 50\n  @protocol: xsens\n", "mocap.protocol: must be one of datastream, object_stream, vrpn, natnet, qtm; is 'xsens'"},
    {"MocapPort", "  rate_hz: 50\n", "  rate_hz: 50\n  @port: 0\n", "mocap.port: must be at least 1 and at most 65535, is '0'"},
    {"MocapBlock", "  rate_hz: 50\n", "  rate_hz: 50\n  @block_bytes: 500\n", "mocap.block_bytes: must be one of 256, 512, 1024; is 500"},
    {"MocapUnknownKey", "  rate_hz: 50\n", "  rate_hz: 50\n  @adress: x\n", "mocap.adress: unknown key"},
    {"MocapTooFast", "rate_hz: 50", "@rate_hz: 5000", "mocap.rate_hz: must be above 0 and at most 1000, is 5000"},
};

const BadEdit kRos2[] = {
    {"Ros2Domain", "seed: 1 ", "ros2:\n  @domain: 233\nseed: 1 ", "ros2.domain: must be at least 0 and at most 232, is '233'"},
    {"Ros2Interface", "seed: 1 ", "ros2:\n  @interface: '<a>'\nseed: 1 ", "ros2.interface: must be the name of a network card, is '<a>'"},
    {"Ros2Prefix", "seed: 1 ", "ros2:\n  @prefix: lab\nseed: 1 ", "ros2.prefix: must be a ROS 2 name such as /lab, is 'lab'"},
    {"Ros2Topic", "seed: 1 ", "ros2:\n  poses: [{@topic: /1a, body: Q1}]\nseed: 1 ", "ros2.poses[0].topic: must be a full ROS 2 topic such as /Q1/pose, is '/1a'"},
    {"Ros2PoseWithoutBody", "seed: 1 ", "ros2:\n  poses: [{@topic: /a}]\nseed: 1 ", "ros2.poses[0]: body: is missing"},
    {"Ros2PosesOfASimulatedMocap", "seed: 1 ", "ros2:\n  @poses: [{topic: /a, body: Q1}]\nseed: 1 ", "ros2.poses: replace a real motion capture, but mocap is simulated"},
    {"Ros2ReadsItsOwnTopic", "seed: 1 ", "ros2:\n  poses: [{@topic: /tf, type: tf}]\nseed: 1 ", "ros2.poses[0].topic: must not be /tf, on which vantage publishes"},
    {"Ros2DetectionsNextToOurSensor", "seed: 1 ", "ros2:\n  detections: [{topic: /a, @robot: Q1}]\nseed: 1 ", "ros2.detections[0].robot: has a sensor of vantage: set sensor.device: external for Q1"},
    {"Ros2DetectionsOfNoRobot", "seed: 1 ", "ros2:\n  detections: [{topic: /a, @robot: Q9}]\nseed: 1 ", "must be the name of a robot, is 'Q9'"},
    {"Ros2TrustedTopic", "seed: 1 ", "ros2:\n  trusted_topics:\n    - @/b\nseed: 1 ", "must be a topic of `poses` or `detections`, is '/b'"},
};

const BadEdit kTeams[] = {
    {"DuplicateRobot", "  - name: Q2", "  - @name: Q1", "robots[1].name: must be unique; an earlier robot or target is called Q1"},
    {"LowerCaseRobot", "  - name: Q2", "  - @name: q2", "must contain only A-Z and 0-9, is 'q2'"},
    {"RobotNamedAsATarget", "name_prefix: R", "@name_prefix: Q", "gives a target the name Q1, which a robot already has"},
    {"RobotWithoutName", "  - name: Q2\n    start: {x_m: 0,", "  - @start: {x_m: 0,", "robots[1]: missing required key name"},
    {"StartOutside", "    start: {x_m: 0, y_m: 0, yaw_deg: 90}", "    @start: {x_m: 0, y_m: 2.5}", "robots[1].start: (0, 2.5) m is outside world.bounds"},
    {"StartInObstacle", "    start: {x_m: 0, y_m: 0, yaw_deg: 90}", "    @start: {x_m: 1.5, y_m: -0.8}", "robots[1].start: (1.5, -0.8) m is inside an obstacle"},
    {"StartAtTheWall", "    start: {x_m: 0, y_m: 0, yaw_deg: 90}", "    @start: {x_m: 0, y_m: 1.9}", "must be at least 0.35 m from obstacles and walls; at (0, 1.9) m it is 0.1"},
    {"StartsTooNear", "    start: {x_m: 0, y_m: 0, yaw_deg: 90}", "    @start: {x_m: -2.8, y_m: 0}", "must be at least planner.separation_m (0.6 m) from the start of Q1, but is 0.539"},
    {"StartWithoutY", "    start: {x_m: 0, y_m: 0, yaw_deg: 90}", "    @start: {x_m: 0}", "robots[1].start: missing required key y_m"},
    {"AboveTheCeiling", "height_m: 2.0", "@height_m: 3.0", "robots[2].height_m: must be below world.ceiling_m (3), but is 3"},
    {"TouchingTheCeiling", "height_m: 2.0", "@height_m: 2.8", "robots[2].height_m: must be at most world.ceiling_m (3) minus the robot's radius_m (0.25), otherwise it touches the ceiling; is 2.8"},
    {"NoPrimitives", "primitives: lab", "@primitives: []", "must contain at least 1 and at most 64 primitives, contains 0"},
    {"PrimitivesTooFast", "primitives: lab", "@primitives: standard", "speed_mps must be at most limits.speed_max_mps (1), but is 3"},
    {"PrimitivesTurnTooFast", "primitives: lab", "@primitives: [{speed_mps: 1, yaw_rate_radps: -4}]", "yaw_rate_radps must be at most limits.yaw_rate_max_radps (3) in either direction, but is -4"},
    {"PrimitiveBackwards", "primitives: lab", "@primitives: [{speed_mps: -1, yaw_rate_radps: 0}]", "primitives[0].speed_mps: must be at least 0, is -1"},
    {"PrimitivesUnknown", "primitives: lab", "@primitives: fast", "must be one of standard, lab; is 'fast'"},
    {"FalseAlarmsWithIds", "clutter_per_look: 0 ", "@clutter_per_look: 1 ", "clutter_per_look: must be 0 with detects_ids: true: a false alarm cannot have the id of a target; is 1"},
    {"FalseAlarmsWithoutEnd", "clutter_per_look: 0 ", "@clutter_per_look: 21 ", "clutter_per_look: must be at least 0 and at most 20, is 21"},
    {"BlindSensor", "detection_probability: 1 ", "@detection_probability: 0 ", "detection_probability: must be above 0 and at most 1, is 0"},
    {"NoTargets", "  count: 5 ", "  @count: 0 ", "targets.count: must be at least 1 and at most 10000, is '0'"},
};
// clang-format on

std::string name_of(const testing::TestParamInfo<BadEdit>& edit) { return edit.param.name; }

INSTANTIATE_TEST_SUITE_P(Keys, BadScenario, testing::ValuesIn(kKeys), name_of);
INSTANTIATE_TEST_SUITE_P(Values, BadScenario, testing::ValuesIn(kValues), name_of);
INSTANTIATE_TEST_SUITE_P(Ranges, BadScenario, testing::ValuesIn(kRanges), name_of);
INSTANTIATE_TEST_SUITE_P(Teams, BadScenario, testing::ValuesIn(kTeams), name_of);
INSTANTIATE_TEST_SUITE_P(Ros2, BadScenario, testing::ValuesIn(kRos2), name_of);

/// A whole file and its whole error message.
struct BadFile {
  const char* text;
  const char* refusal;
};

const std::string kWorld = "world: {bounds: {min_m: [0, 0], max_m: [9, 9]}}\n";
const std::string kRobot =
    "robots: [{name: A, start: {x_m: 2, y_m: 2}, primitives: lab, sensor: {kind: range}}]\n";
const std::string kTargets = "targets: {count: 1}\n";

TEST(ParseScenario, NamesMissingKeys) {
  EXPECT_EQ(refusal_of(kWorld + kRobot + kTargets), "lab.yaml:1: missing required key name");
  EXPECT_EQ(refusal_of("name: x\n" + kRobot + kTargets), "lab.yaml:1: missing required key world");
  EXPECT_EQ(refusal_of("name: x\n" + kWorld + kTargets), "lab.yaml:1: missing required key robots");
  EXPECT_EQ(refusal_of("name: x\n" + kWorld + kRobot), "lab.yaml:1: missing required key targets");
  EXPECT_EQ(refusal_of("name: x\nworld: {ceiling_m: 3}\n" + kRobot + kTargets),
            "lab.yaml:2: world: missing required key bounds");
  const auto with_robot = [](const std::string& robot) {
    return refusal_of("name: x\n" + kWorld + "robots:\n  - " + robot + "\n" + kTargets);
  };
  EXPECT_EQ(with_robot("{name: A, primitives: lab, sensor: {kind: range}}"),
            "lab.yaml:4: robots[0]: missing required key start");
  EXPECT_EQ(with_robot("{name: A, start: {x_m: 2, y_m: 2}, primitives: lab}"),
            "lab.yaml:4: robots[0]: missing required key sensor");
  EXPECT_EQ(with_robot("{name: A, start: {x_m: 2, y_m: 2}, sensor: {kind: range}}"),
            "lab.yaml:4: robots[0]: missing required key primitives");
}

TEST(ParseScenario, RefusesTextThatIsNotAScenario) {
  const BadFile files[] = {
      {"", "lab.yaml:1: empty file; expected a scenario"},
      {"# only\n# comments\n", "lab.yaml:1: empty file; expected a scenario"},
      {"- a\n- list\n", "lab.yaml:1: must be a mapping of keys to values"},
      {"name", "lab.yaml:1: must be a mapping of keys to values"},
      {"name: a\n---\nname: b\n",
       "lab.yaml:3: a second YAML document begins here; a file may "
       "contain only one"},
      {"name: a\nworld:\n\tbounds: 1\n", "lab.yaml:3: tab character; use spaces"},
      {"name: a\nwo\xFFrld: 1\n", "lab.yaml:2: byte 0xff is not UTF-8 text"},
      {"name: a\nw\xC0\xAFld: 1\n", "lab.yaml:2: byte 0xc0 is not UTF-8 text"},
      {"name: \x1b[31m\n", "lab.yaml:1: control character 0x1b"},
      {"name: a\n? [b]\n: 1\n", "lab.yaml:2: keys must be plain words"},
  };
  for (const BadFile& file : files) {
    EXPECT_EQ(refusal_of(file.text), file.refusal) << "for: " << file.text;
  }
  EXPECT_EQ(refusal_of(std::string("name: a\0b\n", 10)), "lab.yaml:1: control character 0x00");
  EXPECT_EQ(refusal_of("name: a\nworld: [1, 2\n").rfind("lab.yaml:3: not YAML: ", 0), 0U);
  EXPECT_EQ(refusal_of(std::string(2'000'000, ' ')), "lab.yaml: must be at most 1048576 bytes");
  EXPECT_EQ(refusal_of("name: " + std::string(100'000, '[')), "lab.yaml:1: nested deeper than 32");
}

TEST(ParseScenario, ErrorIsOneShortLine) {
  EXPECT_EQ(refusal_of("\"na\\nme\": x\n" + kWorld).find("lab.yaml:1: na\\x0Ame: unknown key; "),
            0U);
  EXPECT_EQ(refusal_of("name: \"a\\eb\"\n" + kWorld + kRobot + kTargets),
            "lab.yaml:1: name: must contain only letters, digits, - and _, is 'a\\x1Bb'");
  // The limit of forty bytes falls inside a two-byte character.
  std::string umlauts = "x";
  for (int i = 0; i < 50'000; ++i) {
    umlauts += "ä";
  }
  const std::string refusal =
      refusal_of("name: x\nduration_s: " + umlauts + "\n" + kWorld + kRobot);
  EXPECT_TRUE(is_utf8(refusal)) << refusal;
  EXPECT_EQ(refusal.find("lab.yaml:2: duration_s: must be a number, is 'xä"), 0U) << refusal;
  EXPECT_LT(refusal.size(), 120U);
  EXPECT_LT(refusal_of(umlauts + ": 1\n" + kWorld).size(), 400U);
}

// An alias refers to the node of its anchor, with the line of the alias's own key; the node is
// never copied.
TEST(ParseScenario, ReadsAliases) {
  const std::string text =
      "name: x\nworld:\n  bounds: {min_m: &zero [0, 0], max_m: [9, 9]}\n  obstacles:\n"
      "  - footprint: {min_m: *zero, max_m: &one [1, 1]}\n"
      "  - footprint: {min_m: *one, max_m: *one}\n" +
      kRobot + kTargets;
  EXPECT_EQ(refusal_of(text),
            "lab.yaml:6: world.obstacles[1].footprint.max_m: must be above min_m ([1, 1]) in x and "
            "in y, but is [1, 1]");
  EXPECT_EQ(refusal_of("name: x\nworld: &a {bounds: *a}\n" + kRobot + kTargets),
            "lab.yaml:2: world.bounds.bounds: unknown key; valid keys are min_m, max_m");
  // Each line is ten times as large as the previous one; if aliases were copied, there would be ten
  // thousand million nodes.
  std::string laughs = "name: x\nseed: &a0 [0]\n";
  for (char i = '1'; i <= '9'; ++i) {
    const std::string before = std::string("*a") + static_cast<char>(i - 1);
    laughs += std::string("k") + i + ": &a" + i + " [" + before;
    for (int k = 1; k < 10; ++k) {
      laughs += ", " + before;
    }
    laughs += "]\n";
  }
  EXPECT_EQ(refusal_of(laughs).find("lab.yaml:3: k1: unknown key"), 0U) << refusal_of(laughs);
}

TEST(ParseScenario, RefusesContradictingKeys) {
  const std::string good = "name: x\n" + kWorld + kTargets;
  EXPECT_EQ(refusal_of(good + kRobot), "accepted");
  EXPECT_EQ(refusal_of(good + kRobot + "mocap: 5\n"),
            "lab.yaml:5: mocap: must be a mapping of keys to values");
  EXPECT_EQ(
      refusal_of(good + kRobot + "mocap: xsens://lab\n"),
      "lab.yaml:5: mocap: must begin with the protocol, one of datastream, object_stream, vrpn, "
      "natnet, qtm; is 'xsens://lab'");
  EXPECT_EQ(refusal_of(good + kRobot + "mocap: natnet://lab:x\n"),
            "lab.yaml:5: mocap: a port from 1 to 65535 is expected after the last ':', is "
            "'natnet://lab:x'");
  EXPECT_EQ(refusal_of(good + kRobot + "mocap: qtm://\n"),
            "lab.yaml:5: mocap: must be qtm://HOST or qtm://HOST:PORT, is 'qtm://'");
  EXPECT_EQ(
      refusal_of(good + kRobot +
                 "estimator:\n  target_model: {kind: double_integrator,\n"
                 "    position_dim: 3}\n"),
      "lab.yaml:7: estimator.target_model.position_dim: must be 2 for kind double_integrator, "
      "is 3");
  EXPECT_EQ(
      refusal_of(good + kRobot +
                 "estimator:\n  target_model: {kind: damped_oscillator,\n"
                 "    position_dim: 3}\n"),
      "lab.yaml:7: estimator.target_model.position_dim: must be 2 for kind damped_oscillator, "
      "is 3");
  EXPECT_EQ(refusal_of(good + "robot_defaults: {primitives: lab, sensor: {kind: range}}\n"
                              "robots:\n"
                              "  - {name: A, start: {x_m: 2, y_m: 2}}\n"
                              "  - {name: B, start: {x_m: 6, y_m: 6}, limits: {radius_m: 0.4}}\n"),
            "lab.yaml:7: robots[1].limits: planner.separation_m must be at least the sum of the "
            "radii of A and B (0.65 m), but is 0.6");
  EXPECT_EQ(refusal_of("name: x\nworld: {bounds: {min_m: [0, 0], max_m: [9000, 9000]}}\n" + kRobot +
                       kTargets),
            "lab.yaml:1: grid_resolution_m: must divide world.bounds into at most 4000000 cells; "
            "0.25 gives 1296000000");
  const std::string base = "name: x\n" + kWorld + kRobot;
  EXPECT_EQ(refusal_of(base + "targets:\n  - {id: 1}\n  - {id: 1}\n"),
            "lab.yaml:6: targets[1].id: must be unique; an earlier target has the id 1");
  EXPECT_EQ(refusal_of(base + "targets:\n  - {id: 0}\n  - {id: 2}\n"),
            "lab.yaml:6: targets[1]: id must be at most 1, the number of targets minus 1; is 2");
  EXPECT_EQ(refusal_of(base + "targets:\n  - {name: A}\n"),
            "lab.yaml:5: targets[0].name: must be unique; an earlier robot or target is called A");
  EXPECT_EQ(refusal_of(base + "targets:\n  - {start: {x_m: 8.9, y_m: 5}}\n"),
            "lab.yaml:5: targets[0].start: must be at least 0.2 m from obstacles and walls; "
            "at (8.9, 5) m it is 0.1");
  EXPECT_EQ(refusal_of(base + "targets: []\n"),
            "lab.yaml:4: targets: must contain at least 1 and at most 10000 targets, contains 0");
  EXPECT_EQ(refusal_of("name: x\n" + kWorld + kTargets + "robots: []\n"),
            "lab.yaml:4: robots: must contain at least 1 and at most 10000 robots, contains 0");
}

TEST(ParseScenario, RefusesUnlabelledTeamThatCannotSeparateTargets) {
  const std::string sensor = "sensor: {kind: position, detects_ids: false, range_min_m: 0.1}";
  const std::string unnamed =
      "robots: [{name: A, start: {x_m: 2, y_m: 2}, primitives: lab, " + sensor + "}]\n";
  const std::string good = "name: x\n" + kWorld + unnamed;
  EXPECT_EQ(refusal_of(good + kTargets), "accepted");
  for (const char* kind : {"range", "bearing"}) {
    std::string alone = good + kTargets;
    alone.replace(alone.find("position, d"), 8, kind);
    EXPECT_EQ(refusal_of(alone),
              std::string("lab.yaml:3: robots[0].sensor.detects_ids: must be true for a sensor of "
                          "kind ") +
                  kind + ": without ids, each detection must give the position of its target");
  }
  EXPECT_EQ(refusal_of("name: x\n" + kWorld + kTargets +
                       "robot_defaults: {primitives: lab, sensor: {kind: position}}\n"
                       "robots:\n"
                       "  - {name: A, start: {x_m: 2, y_m: 2}}\n"
                       "  - {name: B, start: {x_m: 6, y_m: 6}, " +
                       sensor + "}\n"),
            "lab.yaml:5: robots: must all have the same detects_ids, true or false: the team "
            "shares one numbering of its targets");
  EXPECT_EQ(refusal_of(good + "targets: {count: 101}\n"),
            "lab.yaml:4: targets: must be 1 to 100 with detects_ids: false, are 101");
  EXPECT_EQ(refusal_of(good + "planner: {objective: mapping}\nmapping: {}\n"),
            "lab.yaml:1: targets: must be 1 to 100 with detects_ids: false, are 0");
  EXPECT_EQ(refusal_of(good + kTargets +
                       "estimator: {target_model: {kind: random_walk, position_dim: 3}}\n"),
            "lab.yaml:5: estimator: target_model.position_dim must be 2 with detects_ids: false: "
            "targets without ids are tracked in the plane only");
  EXPECT_EQ(refusal_of(good + kTargets + "network: {neighbourhood_m: 100}\n"),
            "lab.yaml:5: network: neighbourhood_m must be 0 with detects_ids: false: the "
            "number of targets is estimated for the whole world only");
}

TEST(ParseScenario, RefusesInvalidHosts) {
  const std::string base = "name: x\n" + kWorld + kRobot + kTargets + "hosts:\n";
  EXPECT_EQ(refusal_of(base + "  - {name: lab1, runs: []}\n"),
            "lab.yaml:6: hosts[0].name: must contain only A-Z and 0-9, is 'lab1'");
  EXPECT_EQ(refusal_of(base + "  - {name: LAB}\n"),
            "lab.yaml:6: hosts[0]: missing required key runs");
  EXPECT_EQ(refusal_of(base + "  - {name: LAB, run: []}\n"),
            "lab.yaml:6: hosts[0].run: unknown key; did you mean runs?");
  EXPECT_EQ(refusal_of(base + "  - {name: LAB, runs: [A, B]}\n"),
            "lab.yaml:6: hosts[0].runs[1]: must be the name of a robot, sim, vicon or logger; "
            "is 'B'");
  EXPECT_EQ(refusal_of(base + "  - {name: LAB, runs: [A]}\n  - {name: AIR, runs: [A]}\n"),
            "lab.yaml:7: hosts[1].runs[0]: 'A' already runs on LAB");
  EXPECT_EQ(refusal_of(base + "  - {name: LAB, runs: [sim, sim]}\n"),
            "lab.yaml:6: hosts[0].runs[1]: 'sim' already runs on LAB");
  EXPECT_EQ(refusal_of(base + "  - {name: LAB, runs: []}\n  - {name: LAB, runs: []}\n"),
            "lab.yaml:7: hosts[1].name: must be unique; an earlier host is called LAB");
  EXPECT_EQ(refusal_of("name: x\n" + kWorld + kRobot + kTargets + "hosts: []\n"),
            "lab.yaml:5: hosts: must contain at least 1 and at most 32 hosts, contains 0");
}

TEST(LoadScenario, RefusesPathsWithoutAFile) {
  const auto refusal = [](const std::string& path) -> std::string {
    try {
      static_cast<void>(load_scenario(path));
    } catch (const StartupError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal("no/such.yaml"), "no/such.yaml: no such file");
  const std::string folder = std::filesystem::temp_directory_path().string();
  EXPECT_EQ(refusal(folder), folder + ": is a directory; expected a scenario file");
  EXPECT_EQ(refusal("/dev/null"), "/dev/null: cannot be read");
}

}  // namespace
}  // namespace vantage::scenario
