#include "tools/console/operator_input.hpp"

#include <gtest/gtest.h>

#include "tools/console/terminal.hpp"

namespace vantage::tools {
namespace {

using models::OperatorAction;
using Kind = OperatorRequest::Kind;
const std::vector<std::string> kRobots = {"Q1", "Q2"};

std::optional<OperatorRequest> request_from_key(std::string_view key,
                                                const std::vector<std::string>& robots,
                                                const std::string& selected) {
  return KeyInput().on_key(key, robots, selected);
}

TEST(KeyInput, StopsAllBySpaceAndTheSelectedRobotByE) {
  struct Row {
    const char* key;
    const char* selected;
    const char* stopped;
  };
  for (const Row& row : {Row{" ", "", ""}, Row{" ", "Q2", ""}, Row{"e", "", ""},
                         Row{"e", "Q2", "Q2"}, Row{"E", "Q2", "Q2"}}) {
    const auto request = request_from_key(row.key, kRobots, row.selected);
    ASSERT_TRUE(request) << row.key << row.selected;
    EXPECT_EQ(request->kind, Kind::kCommand);
    EXPECT_EQ(request->action, OperatorAction::kEmergencyStop);
    EXPECT_EQ(request->robot, row.stopped) << row.key << row.selected;
  }
}

TEST(KeyInput, SelectsAnyRobotByItsName) {
  std::vector<std::string> robots{"alpha"};
  for (int i = 1; i <= 120; ++i) {
    robots.push_back("Q" + std::to_string(i));
  }
  struct Row {
    const char* typed;
    std::optional<Kind> kind;
    const char* robot;
  };
  for (const Row& row : {Row{"rQ117\n", Kind::kSelect, "Q117"}, Row{"rq12\r", Kind::kSelect, "Q12"},
                         Row{"ral\n", Kind::kSelect, "alpha"}, Row{"rq\n", Kind::kNoRobot, "q"},
                         Row{"rQ999\n", Kind::kNoRobot, "Q999"},
                         Row{"rQ13\x7f\x7f\x7f\x7f\x7f"
                             "Q2\n",
                             Kind::kSelect, "Q2"},
                         Row{"r\n", std::nullopt, ""}, Row{"rQ3\x1b", std::nullopt, ""},
                         Row{"rhal ", Kind::kCommand, ""}}) {
    KeyInput input;
    std::optional<OperatorRequest> request;
    for (const char key : std::string(row.typed)) {
      ASSERT_FALSE(request) << row.typed << ": requested before its last key";
      request = input.on_key({&key, 1}, robots, "Q1");
    }
    ASSERT_EQ(request.has_value(), row.kind.has_value()) << row.typed;
    EXPECT_TRUE(input.prompt().empty()) << row.typed;
    if (request) {
      EXPECT_EQ(request->kind, row.kind) << row.typed;
      EXPECT_EQ(request->robot, row.robot) << row.typed;
    }
  }
}

TEST(KeyInput, SelectsEachRobotThenAllByTab) {
  std::vector<std::string> robots;
  for (int i = 1; i <= 12; ++i) {
    robots.push_back("Q" + std::to_string(i));
  }
  std::string selected;
  for (const std::string& robot : robots) {
    selected = request_from_key("\t", robots, selected)->robot;
    EXPECT_EQ(selected, robot);
  }
  EXPECT_EQ(request_from_key("\t", robots, selected)->robot, "");
}

TEST(KeyInput, ShowsTheTypedName) {
  KeyInput input;
  EXPECT_FALSE(input.on_key("r", kRobots, ""));
  EXPECT_FALSE(input.on_key("Q", kRobots, ""));
  EXPECT_TRUE(input.prompt().starts_with("robot: Q_"));
}

TEST(KeyInput, SendsToTheSelectedRobot) {
  const std::vector<std::pair<std::string, OperatorAction>> keys = {{"a", OperatorAction::kArm},
                                                                    {"t", OperatorAction::kTakeOff},
                                                                    {"f", OperatorAction::kFollow},
                                                                    {"h", OperatorAction::kHold},
                                                                    {"l", OperatorAction::kLand}};
  for (const auto& [key, action] : keys) {
    const auto request = request_from_key(key, kRobots, "Q2");
    ASSERT_TRUE(request) << key;
    EXPECT_EQ(request->action, action) << key;
    EXPECT_EQ(request->robot, "Q2") << key;
  }
}

TEST(KeyInput, SelectsByDigitAndIgnoresDigitsWithoutARobot) {
  EXPECT_EQ(request_from_key("2", kRobots, "")->robot, "Q2");
  EXPECT_EQ(request_from_key("2", kRobots, "")->kind, Kind::kSelect);
  EXPECT_EQ(request_from_key("0", kRobots, "Q1")->robot, "");
  EXPECT_FALSE(request_from_key("3", kRobots, ""));
  EXPECT_FALSE(request_from_key("x", kRobots, ""));
}

TEST(RequestFromLine, ReadsAnActionAndARobot) {
  const auto request = request_from_line("  land Q1 ");
  ASSERT_TRUE(request.ok());
  EXPECT_EQ(request.value().action, OperatorAction::kLand);
  EXPECT_EQ(request.value().robot, "Q1");
  EXPECT_EQ(request_from_line("hold all").value().robot, "");
  EXPECT_EQ(request_from_line("quit").value().kind, Kind::kQuit);
}

TEST(RequestFromLine, ReadsEveryWordItWrites) {
  for (const auto action :
       {OperatorAction::kArm, OperatorAction::kTakeOff, OperatorAction::kFollow,
        OperatorAction::kHold, OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    const auto request = request_from_line(word_for(action));
    ASSERT_TRUE(request.ok()) << word_for(action);
    EXPECT_EQ(request.value().action, action);
  }
}

TEST(RequestFromLine, RefusesUnknownWords) {
  EXPECT_FALSE(request_from_line("fly Q1").ok());
  EXPECT_FALSE(request_from_line("land Q1 now").ok());
}

TEST(RequestFromLine, IgnoresLetterCase) {
  const auto request = request_from_line("ESTOP Q9");
  ASSERT_TRUE(request.ok());
  EXPECT_EQ(request.value().action, OperatorAction::kEmergencyStop);
  EXPECT_EQ(request.value().robot, "Q9");
}

/// Splits `typed` into keys; an incomplete key ends in "…".
std::vector<std::string> keys_of(std::string typed) {
  std::vector<std::string> out;
  while (!typed.empty()) {
    const std::size_t bytes = key_bytes(typed);
    if (bytes == 0) {
      out.push_back(typed + "…");
      break;
    }
    out.push_back(typed.substr(0, bytes));
    typed.erase(0, bytes);
  }
  return out;
}
using Keys = std::vector<std::string>;

// Each sequence ends in a letter or digit that would, as a single key, arm, follow, quit or select.
TEST(KeyBytes, TreatsAnEscapeSequenceAsOneKey) {
  for (const char* key :
       {"\x1b[A",   "\x1b[B",    "\x1b[F",    "\x1b[H",  "\x1bOA",    "\x1bOF",  "\x1bOH",
        "\x1bOP",   "\x1bOQ",    "\x1b[[A",   "\x1b[[E", "\x1b[3~",   "\x1b[5~", "\x1b[15~",
        "\x1b[24~", "\x1b[1;5A", "\x1b[1;2Q", "\x1bO5Q", "\x1b[200~", "\x1b[Z"}) {
    const std::string text(key);
    EXPECT_EQ(keys_of(text + "h" + text + text), (Keys{text, "h", text, text})) << text.substr(1);
    EXPECT_FALSE(request_from_key(text, kRobots, ""));
    for (std::size_t part = 1; part < text.size(); ++part) {
      EXPECT_EQ(keys_of(text.substr(0, part)), Keys{text.substr(0, part) + "…"})
          << "split by " << part;
    }
  }
}

TEST(KeyBytes, KeepsAnEmergencyStopAfterAPartialSequence) {
  EXPECT_EQ(keys_of("\x1b "), (Keys{"\x1b", " "})) << "after the key ESC";
  EXPECT_EQ(keys_of("\x1b[ "), (Keys{"\x1b[", " "}));
  EXPECT_EQ(keys_of("\x1bO "), (Keys{"\x1bO", " "}));
  EXPECT_EQ(keys_of("\x1b[1; "), (Keys{"\x1b[1;", " "}));
  EXPECT_EQ(keys_of("\x1b[[ "), (Keys{"\x1b[[", " "}));
  EXPECT_EQ(keys_of("\x1b\x1b[A "), (Keys{"\x1b", "\x1b[A", " "}));
  EXPECT_EQ(keys_of("h l "), (Keys{"h", " ", "l", " "}));
  EXPECT_EQ(keys_of(""), Keys{});
}

// Checks every order in every state: only an order that the vehicle ignores has a reason.
TEST(ReasonForNoEffect, IsGivenForEveryOrderThatAVehicleIgnores) {
  using models::FlightState;
  const std::string not_flying = "not in operation; arm and take off first";
  const std::string in_operation = "already in operation";
  const std::string landing = "is landing";
  const std::string stopped = "stopped; arm it first";
  struct Row {
    OperatorAction action;
    std::vector<std::string> by_state;  ///< idle, follow, hold, land, killed
  };
  for (const Row& row :
       {Row{OperatorAction::kArm, {"", in_operation, in_operation, landing, ""}},
        Row{OperatorAction::kTakeOff, {"", in_operation, in_operation, landing, stopped}},
        Row{OperatorAction::kFollow, {not_flying, "", "", landing, stopped}},
        Row{OperatorAction::kHold, {"", "", "", landing, ""}},
        Row{OperatorAction::kLand, {"", "", "", "", ""}},
        Row{OperatorAction::kEmergencyStop, {"", "", "", "", ""}}}) {
    const FlightState states[] = {FlightState::kIdle, FlightState::kFollow, FlightState::kHold,
                                  FlightState::kLand, FlightState::kKilled};
    for (std::size_t i = 0; i < std::size(states); ++i) {
      EXPECT_EQ(obstacle(row.action, states[i]), row.by_state[i])
          << word_for(row.action) << " in " << name_of(states[i]);
    }
  }
}

}  // namespace
}  // namespace vantage::tools
