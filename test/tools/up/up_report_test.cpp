#include "tools/up/up_report.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

using models::SupervisedPhase;

UpResult with(const SupervisedStatus& process) {
  UpResult result;
  result.processes = {{"planner Q1"}, process};
  return result;
}

TEST(UpReport, IsEmptyForAnUneventfulTrial) {
  const UpResult result = with({"sensor Q1"});
  EXPECT_TRUE(is_good(result));
  EXPECT_TRUE(remarks(result).empty());
  EXPECT_TRUE(to_json(result)["processes"].empty());
}

TEST(UpReport, ListsRestartsOfAGoodTrial) {
  SupervisedStatus sensor{"sensor Q1"};
  sensor.restarts = 2;
  sensor.down_s = 0.7;
  sensor.last_end = "signal 9";
  const UpResult result = with(sensor);
  EXPECT_TRUE(is_good(result));
  EXPECT_EQ(remarks(result),
            std::vector<std::string>{"sensor Q1: 2 restarts, 0.7 s down, running at the end"});
  const auto json = to_json(result);
  EXPECT_EQ(json["restarts"], 2);
  ASSERT_EQ(json["processes"].size(), 1U);
  EXPECT_EQ(json["processes"][0]["name"], "sensor Q1");
  EXPECT_EQ(json["processes"][0]["last_end"], "signal 9");
}

TEST(UpReport, IsNotGoodAfterALogError) {
  UpResult result;
  result.log_was_unwritten = true;
  EXPECT_FALSE(is_good(result));
  EXPECT_EQ(remarks(result), std::vector<std::string>{"log: could not be written for some time"});
  EXPECT_EQ(to_json(result)["log"]["was_unwritten"], true);
}

TEST(UpReport, ReportsForgedContactsWithoutCountingThem) {
  UpResult result;
  result.contacts_unverified = contacts_unverified({{"COLLISION.unsigned", 30'000},
                                                    {"COLLISION.bad_mac", 2},
                                                    {"COLLISION.fresh", 9},
                                                    {"VICON.unsigned", 5}});
  EXPECT_EQ(result.contacts_unverified, 30'002);
  EXPECT_TRUE(is_good(result));
  ASSERT_EQ(remarks(result).size(), 1U);
  EXPECT_NE(remarks(result)[0].find("30002 messages on COLLISION"), std::string::npos);
  EXPECT_EQ(to_json(result)["contacts_unverified"], 30'002);
}

TEST(UpReport, IsNotGoodAfterAnInternalError) {
  UpResult result;
  result.broken = "out of memory";
  EXPECT_FALSE(is_good(result));
  EXPECT_EQ(remarks(result), std::vector<std::string>{
                                 "the trial ended because of an internal error: out of memory"});
  EXPECT_EQ(to_json(result)["broken"], "out of memory");
}

TEST(UpReport, ReportsWhyAProcessWasKilled) {
  UpResult result;
  result.killed = {"sim"};
  EXPECT_FALSE(is_good(result));
  EXPECT_EQ(remarks(result).at(0), "sim did not end when requested and was killed");
  result = {};
  result.cut_short = {"sim"};
  EXPECT_FALSE(is_good(result));
  EXPECT_EQ(remarks(result).at(0), "sim was killed at once because of another Ctrl-C");
  EXPECT_EQ(to_json(result)["cut_short"].size(), 1U);
}

TEST(UpReport, IsNotGoodWithAnAbandonedProcess) {
  SupervisedStatus sensor{"sensor Q1"};
  sensor.phase = SupervisedPhase::kGivenUp;
  sensor.last_end = "exit 1";
  const UpResult result = with(sensor);
  EXPECT_FALSE(is_good(result));
  EXPECT_EQ(remarks(result).at(0), "sensor Q1: 0 restarts, 0.0 s down, given up (exit 1)");
  EXPECT_EQ(to_json(result)["given_up"][0], "sensor Q1");
}

TEST(UpReport, IsNotGoodAfterRestartOrIncompleteLog) {
  UpResult result;
  result.world_restarts = 1;
  EXPECT_FALSE(is_good(result));
  EXPECT_NE(remarks(result).at(0).find("was restarted 1 times"), std::string::npos);
  result = {};
  result.log.is_to_the_end = false;
  EXPECT_FALSE(is_good(result));
  result = {};
  result.ended_badly = {"sim (signal 6)"};
  EXPECT_FALSE(is_good(result));
  EXPECT_EQ(remarks(result).at(0), "sim (signal 6) ended with an error");
  result = {};
  result.has_other_scenario = true;
  EXPECT_FALSE(is_good(result));
}

TEST(UpReport, NamesVehiclesThatNeverFlewOrDidNotLand) {
  UpResult result;
  result.left_flying = {"Q2"};
  EXPECT_FALSE(is_good(result));
  EXPECT_EQ(remarks(result),
            std::vector<std::string>{"Q2 had not landed when its driver was ended"});
  EXPECT_EQ(to_json(result)["left_flying"], nlohmann::ordered_json::array({"Q2"}));
  result = {};
  result.never_flown = {"Q4"};
  EXPECT_FALSE(is_good(result));
  EXPECT_EQ(remarks(result), std::vector<std::string>{"Q4 never followed a plan"});
}

TEST(UpReport, ReportsTheLossOfAFailedRecorder) {
  UpResult result;
  result.log = {"a.lcmlog", 1, 0.75, 120, true};
  EXPECT_TRUE(is_good(result));
  EXPECT_EQ(remarks(result).at(0),
            "log: 0.75 s not recorded, 120 bytes of an incomplete event removed; event numbers "
            "start again");
  EXPECT_EQ(to_json(result)["log"]["unrecorded_s"], 0.75);
}

}  // namespace
}  // namespace vantage::tools
