#include "tools/console/operator_input.hpp"

#include <gtest/gtest.h>

#include "tools/console/terminal.hpp"

namespace vantage::tools {
namespace {

using models::OperatorAction;
using Kind = OperatorRequest::Kind;
const std::vector<std::string> kRobots = {"Q1", "Q2"};

TEST(RequestFromKey, SpaceAndEStopEveryone) {
  for (const char* key : {" ", "e", "E"}) {
    const auto request = request_from_key(key, kRobots, "");
    ASSERT_TRUE(request);
    EXPECT_EQ(request->kind, Kind::kCommand);
    EXPECT_EQ(request->action, OperatorAction::kEmergencyStop);
    EXPECT_EQ(request->robot, "");
  }
}

TEST(RequestFromKey, SendsToTheSelectedRobot) {
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

TEST(RequestFromKey, SelectsByDigitAndIgnoresDigitsWithoutARobot) {
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

TEST(RequestFromLine, RefusesWhatItDoesNotKnow) {
  EXPECT_FALSE(request_from_line("fly Q1").ok());
  EXPECT_FALSE(request_from_line("land Q1 now").ok());
}

TEST(RequestFromLine, UnderstandsAnActionInAnyLetterCase) {
  const auto request = request_from_line("ESTOP Q9");
  ASSERT_TRUE(request.ok());
  EXPECT_EQ(request.value().action, OperatorAction::kEmergencyStop);
  EXPECT_EQ(request.value().robot, "Q9");
}

/// The keys of `typed`, one after the other; what is not all there yet ends in "…".
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

// Each ends in a letter or digit that alone arms, follows, quits or selects.
TEST(Keys, OfMoreBytesThanOneAreOneKeyAndNoOrder) {
  for (const char* key :
       {"\x1b[A",   "\x1b[B",    "\x1b[F",    "\x1b[H",  "\x1bOA",    "\x1bOF",  "\x1bOH",
        "\x1bOP",   "\x1bOQ",    "\x1b[[A",   "\x1b[[E", "\x1b[3~",   "\x1b[5~", "\x1b[15~",
        "\x1b[24~", "\x1b[1;5A", "\x1b[1;2Q", "\x1bO5Q", "\x1b[200~", "\x1b[Z"}) {
    const std::string text(key);
    EXPECT_EQ(keys_of(text + "h" + text + text), (Keys{text, "h", text, text})) << text.substr(1);
    EXPECT_FALSE(request_from_key(text, kRobots, ""));
    for (std::size_t part = 1; part < text.size(); ++part) {
      EXPECT_EQ(keys_of(text.substr(0, part)), Keys{text.substr(0, part) + "…"})
          << "cut in two by " << part;
    }
  }
}

TEST(Keys, NeverSwallowTheEmergencyStop) {
  EXPECT_EQ(keys_of("\x1b "), (Keys{"\x1b", " "})) << "after the key ESC";
  EXPECT_EQ(keys_of("\x1b[ "), (Keys{"\x1b[", " "}));
  EXPECT_EQ(keys_of("\x1bO "), (Keys{"\x1bO", " "}));
  EXPECT_EQ(keys_of("\x1b[1; "), (Keys{"\x1b[1;", " "}));
  EXPECT_EQ(keys_of("\x1b[[ "), (Keys{"\x1b[[", " "}));
  EXPECT_EQ(keys_of("\x1b\x1b[A "), (Keys{"\x1b", "\x1b[A", " "}));
  EXPECT_EQ(keys_of("h l "), (Keys{"h", " ", "l", " "}));
  EXPECT_EQ(keys_of(""), Keys{});
}

}  // namespace
}  // namespace vantage::tools
