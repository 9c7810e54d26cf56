#include "tools/console/operator_input.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

using models::OperatorAction;
using Kind = OperatorRequest::Kind;
const std::vector<std::string> kRobots = {"Q1", "Q2"};

TEST(RequestFromKey, SpaceAndEStopEveryone) {
  for (const char key : {' ', 'e', 'E'}) {
    const auto request = request_from_key(key, kRobots, "");
    ASSERT_TRUE(request);
    EXPECT_EQ(request->kind, Kind::kCommand);
    EXPECT_EQ(request->action, OperatorAction::kEmergencyStop);
    EXPECT_EQ(request->robot, "");
  }
}

TEST(RequestFromKey, SendsToTheSelectedRobot) {
  const std::vector<std::pair<char, OperatorAction>> keys = {{'a', OperatorAction::kArm},
                                                             {'t', OperatorAction::kTakeOff},
                                                             {'f', OperatorAction::kFollow},
                                                             {'h', OperatorAction::kHold},
                                                             {'l', OperatorAction::kLand}};
  for (const auto& [key, action] : keys) {
    const auto request = request_from_key(key, kRobots, "Q2");
    ASSERT_TRUE(request) << key;
    EXPECT_EQ(request->action, action) << key;
    EXPECT_EQ(request->robot, "Q2") << key;
  }
}

TEST(RequestFromKey, SelectsByDigitAndIgnoresDigitsWithoutARobot) {
  EXPECT_EQ(request_from_key('2', kRobots, "")->robot, "Q2");
  EXPECT_EQ(request_from_key('2', kRobots, "")->kind, Kind::kSelect);
  EXPECT_EQ(request_from_key('0', kRobots, "Q1")->robot, "");
  EXPECT_FALSE(request_from_key('3', kRobots, ""));
  EXPECT_FALSE(request_from_key('x', kRobots, ""));
}

TEST(RequestFromLine, ReadsAnActionAndARobot) {
  const auto request = request_from_line("  land Q1 ", kRobots);
  ASSERT_TRUE(request.ok());
  EXPECT_EQ(request.value().action, OperatorAction::kLand);
  EXPECT_EQ(request.value().robot, "Q1");
  EXPECT_EQ(request_from_line("hold all", kRobots).value().robot, "");
  EXPECT_EQ(request_from_line("quit", kRobots).value().kind, Kind::kQuit);
}

TEST(RequestFromLine, ReadsEveryWordItWrites) {
  for (const auto action :
       {OperatorAction::kArm, OperatorAction::kTakeOff, OperatorAction::kFollow,
        OperatorAction::kHold, OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    const auto request = request_from_line(word_for(action), kRobots);
    ASSERT_TRUE(request.ok()) << word_for(action);
    EXPECT_EQ(request.value().action, action);
  }
}

TEST(RequestFromLine, RefusesWhatItDoesNotKnow) {
  EXPECT_FALSE(request_from_line("fly Q1", kRobots).ok());
  EXPECT_FALSE(request_from_line("land Q9", kRobots).ok());
  EXPECT_FALSE(request_from_line("land Q1 now", kRobots).ok());
}

TEST(RequestFromLine, StopsEveryoneWhenTheRobotOfAnEmergencyStopIsMistyped) {
  const auto request = request_from_line("ESTOP Q9", kRobots);
  ASSERT_TRUE(request.ok());
  EXPECT_EQ(request.value().action, OperatorAction::kEmergencyStop);
  EXPECT_EQ(request.value().robot, "");
}

}  // namespace
}  // namespace vantage::tools
