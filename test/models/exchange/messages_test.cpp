#include "models/exchange/messages.hpp"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/exchange/counts.hpp"
#include "models/exchange/neighbours.hpp"

namespace vantage::models {
namespace {

template <class Kind>
void expect_names(const std::vector<Kind>& kinds, const std::vector<std::string>& names) {
  ASSERT_EQ(kinds.size(), names.size());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    EXPECT_EQ(name_of(kinds[i]), names[i]);
  }
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
}

// Logs and viewer pages contain these names, so a change of a name breaks their readers.
TEST(Names, EqualTheDocumentedNames) {
  expect_names<PlanSource>({PlanSource::kSearched, PlanSource::kShifted, PlanSource::kBraking},
                           {"searched", "shifted", "braking"});
  expect_names<FlightState>({FlightState::kIdle, FlightState::kFollow, FlightState::kHold,
                             FlightState::kLand, FlightState::kKilled},
                            {"idle", "follow", "hold", "land", "killed"});
  expect_names<SupervisedPhase>({SupervisedPhase::kRunning, SupervisedPhase::kWaiting,
                                 SupervisedPhase::kGivenUp, SupervisedPhase::kEnded},
                                {"running", "waiting", "given up", "ended"});
  EXPECT_STREQ(name_of(static_cast<PlanSource>(9)), "?");
  EXPECT_STREQ(name_of(static_cast<FlightState>(9)), "?");
  EXPECT_STREQ(name_of(static_cast<SupervisedPhase>(9)), "?");
}

MocapBody body(const std::string& name, double x_m, double y_m, bool occluded = false) {
  MocapBody out;
  out.name = name;
  out.world_from_body.translation_m = {x_m, y_m, 5.0 * x_m};  // heights must have no effect
  out.occluded = occluded;
  return out;
}

TEST(MocapFrame, FindsABodyAtAnyIndex) {
  MocapFrame frame;
  frame.bodies = {body("a", 1.0, 0.0), body("b", 2.0, 0.0), body("b", 3.0, 0.0)};
  EXPECT_EQ(frame.find("a"), &frame.bodies[0]);
  EXPECT_EQ(frame.find("b"), &frame.bodies[1]);
  EXPECT_EQ(frame.find("c"), nullptr);
  EXPECT_EQ(frame.find("b", 2), &frame.bodies[2]) << "at the given index";
  EXPECT_EQ(frame.find("b", 0), &frame.bodies[1]);
  EXPECT_EQ(frame.find("a", 3), &frame.bodies[0]) << "index beyond the end";
  EXPECT_EQ(frame.find("a", 99), &frame.bodies[0]);
  EXPECT_EQ(frame.find("c", 0), nullptr);
  EXPECT_EQ(MocapFrame{}.find("a", 0), nullptr);
}

TEST(Neighbours, AreRobotsWithinAHorizontalDistance) {
  MocapFrame frame;
  frame.bodies = {body("q1", 1.0, 1.0), body("q2", 4.0, 5.0), body("q3", -2.0, -3.0 - 1e-9),
                  body("q4", 1.0, 1.0, true)};
  const std::vector<std::string> robots{"q1", "q2", "q3", "q4", "q5"};
  std::vector<std::uint8_t> is_near{0, 7, 7, 7, 7};
  find_neighbours(frame, robots, 0, 5.0, is_near);
  // A distance of exactly five metres counts as near; robots that are not in the frame keep their
  // flag.
  EXPECT_EQ(is_near, (std::vector<std::uint8_t>{0, 1, 0, 7, 7}));
  find_neighbours(frame, robots, 0, 5.0 - 1e-9, is_near);
  EXPECT_EQ(is_near, (std::vector<std::uint8_t>{0, 0, 0, 7, 7}));
  is_near.assign(5, 3);
  find_neighbours(frame, robots, 3, 50.0, is_near);
  EXPECT_EQ(is_near, (std::vector<std::uint8_t>(5, 3))) << "the robot itself is not visible";
  find_neighbours(frame, robots, 4, 50.0, is_near);
  EXPECT_EQ(is_near, (std::vector<std::uint8_t>(5, 3)));
  is_near[1] = 0;
  find_neighbours(frame, robots, 1, 50.0, is_near);
  EXPECT_EQ(is_near, (std::vector<std::uint8_t>{1, 0, 1, 3, 3}));
}

TEST(BeliefMixture, MatchesTheBeliefOfTheSameRobotStepAndTime) {
  RobotBelief belief;
  belief.robot = "q1";
  belief.step = 4;
  belief.stamp.run_id = 7;
  belief.stamp.time = Time{Duration{100}};
  BeliefMixture mixture;
  mixture.robot = belief.robot;
  mixture.step = belief.step;
  mixture.stamp = belief.stamp;
  mixture.stamp.sequence = 99;  // sent separately from the belief
  EXPECT_TRUE(is_of_belief(mixture, belief));
  BeliefMixture other = mixture;
  other.robot = "q2";
  EXPECT_FALSE(is_of_belief(other, belief));
  other = mixture;
  ++other.step;
  EXPECT_FALSE(is_of_belief(other, belief));
  other = mixture;
  ++other.stamp.run_id;
  EXPECT_FALSE(is_of_belief(other, belief));
  other = mixture;
  other.stamp.time += Duration{1};
  EXPECT_FALSE(is_of_belief(other, belief));
}

TEST(TeamProposal, FindsTheChoiceOfARobot) {
  TeamProposal proposal;
  EXPECT_EQ(proposal.find("q1"), nullptr);
  for (const char* const robot : {"q1", "q2", "q3"}) {
    proposal.choices.push_back({robot, {}, 0.0, 0.0});
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(proposal.find(proposal.choices[i].robot), &proposal.choices[i]);
  }
  EXPECT_EQ(proposal.find("q4"), nullptr);
}

TEST(OperatorAction, MakesSaferIfItIsHoldLandOrEmergencyStop) {
  using Action = OperatorAction;
  for (const Action action : {Action::kHold, Action::kLand, Action::kEmergencyStop}) {
    EXPECT_TRUE(makes_safer(action));
  }
  for (const Action action :
       {Action::kHeartbeat, Action::kArm, Action::kTakeOff, Action::kFollow}) {
    EXPECT_FALSE(makes_safer(action));
  }
}

TEST(Counts, OmitZerosAndKeepOrder) {
  const std::vector<NamedCount> some{{"a", 0}, {"b", 2}, {"c", -1}, {"d", 0}};
  const std::vector<NamedCount> left = nonzero(some);
  ASSERT_EQ(left.size(), 2U);
  EXPECT_EQ(left[0].name, "b");
  EXPECT_EQ(left[1].count, -1);
  std::vector<NamedCount> all{{"first", 0}};
  append_nonzero(all, some);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].name, "first");
  EXPECT_EQ(all[2].name, "c");

  LatencyRecord record;
  append_latency(all, "plan", record);
  EXPECT_EQ(all.size(), 3U) << "an empty measurement";
  for (int i = 1; i <= 100; ++i) {
    record.add(Duration{100 * i});
  }
  append_latency(all, "plan", record);
  ASSERT_EQ(all.size(), 6U);
  EXPECT_EQ(all[3].name, "plan_p50_us");
  EXPECT_NEAR(static_cast<double>(all[3].count), 5'000.0, 10.0);
  EXPECT_EQ(all[4].name, "plan_p99_us");
  EXPECT_NEAR(static_cast<double>(all[4].count), 9'900.0, 10.0);
  EXPECT_EQ(all[5].name, "plan_max_us");
  EXPECT_EQ(all[5].count, 10'000);
}

}  // namespace
}  // namespace vantage::models
