#include "bus/node/neighbour_watch.hpp"

#include <set>

#include <gtest/gtest.h>

namespace vantage::bus {
namespace {

scenario::Scenario in_a_row(int robots, double neighbourhood_m) {
  scenario::Scenario scenario;
  for (int i = 0; i < robots; ++i) {
    scenario.robots.emplace_back().name.append("Q").append(std::to_string(i + 1));
  }
  scenario.network.neighbourhood_m = neighbourhood_m;
  return scenario;
}

/// Returns a frame with robots 10 m apart along x, the first one at `x_m`.
models::MocapFrame frame_of(const scenario::Scenario& scenario, Time time, double x_m) {
  models::MocapFrame frame;
  frame.stamp.time = time;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    models::MocapBody& body = frame.bodies.emplace_back();
    body.name = scenario.robots[i].name;
    body.world_from_body.translation_m = {i == 0 ? x_m : 10.0 * static_cast<double>(i), 0.0, 1.0};
  }
  return frame;
}

class NeighbourSubscriptions : public ::testing::Test {
 protected:
  NeighbourWatch watch(const scenario::Scenario& scenario, const std::string& robot = "Q1") {
    return {scenario, robot,
            [this](const std::string& name) { EXPECT_TRUE(to.insert(name).second); },
            [this](const std::string& name) { EXPECT_EQ(to.erase(name), 1U); }};
  }
  static constexpr Time kStart = from_utime(1'000'000'000);
  static constexpr Duration kStep{500'000};
  std::set<std::string> to;
};
using Names = std::set<std::string>;

TEST_F(NeighbourSubscriptions, SubscribesToAllRobotsWithoutANeighbourhood) {
  const scenario::Scenario scenario = in_a_row(4, 0.0);
  NeighbourWatch all = watch(scenario);
  EXPECT_EQ(to, (Names{"Q2", "Q3", "Q4"}));
  all.on_frame(frame_of(scenario, kStart, 1e6));
  EXPECT_EQ(to, (Names{"Q2", "Q3", "Q4"}));
}

TEST_F(NeighbourSubscriptions, SubscribesToNearRobotsOnly) {
  const scenario::Scenario scenario = in_a_row(65, 20.0);
  NeighbourWatch near = watch(scenario);
  EXPECT_EQ(to, Names{});
  near.on_frame(frame_of(scenario, kStart, 0.0));
  EXPECT_EQ(to, (Names{"Q2", "Q3"})) << "20 m counts as near";
  near.on_frame(frame_of(scenario, kStart + kStep / 2, 630.0));
  EXPECT_EQ(to, (Names{"Q2", "Q3"})) << "evaluated once per step";
  near.on_frame(frame_of(scenario, kStart + kStep, 630.0));
  EXPECT_EQ(to, (Names{"Q62", "Q63", "Q64", "Q65"}));
}

// One frame is stamped a year ahead, or the clock was ahead and is set back.
TEST_F(NeighbourSubscriptions, ContinuesAfterAFutureFrame) {
  const scenario::Scenario scenario = in_a_row(9, 20.0);
  NeighbourWatch near = watch(scenario);
  for (const Duration ahead : {3 * kStep, Duration{365 * 86'400 * INT64_C(1'000'000)}}) {
    near.on_frame(frame_of(scenario, kStart, 0.0));
    EXPECT_EQ(to, (Names{"Q2", "Q3"}));
    near.on_frame(frame_of(scenario, kStart + ahead, 0.0));
    near.on_frame(frame_of(scenario, kStart + kStep, 80.0));
    EXPECT_EQ(to, (Names{"Q7", "Q8", "Q9"}));
    near.on_frame(frame_of(scenario, kStart + kStep - Duration{1}, 0.0));
    EXPECT_EQ(to, (Names{"Q7", "Q8", "Q9"})) << "an overtaken frame is ignored";
    near.on_frame(frame_of(scenario, kStart + kStep + kStep, 80.0));
  }
}

TEST_F(NeighbourSubscriptions, ExcludesTheRobotItselfAtAnyTeamIndex) {
  const scenario::Scenario alone = in_a_row(4, 0.0);
  NeighbourWatch all = watch(alone, "Q3");
  EXPECT_EQ(to, (Names{"Q1", "Q2", "Q4"}));
  to.clear();
  const scenario::Scenario scenario = in_a_row(9, 10.0);
  for (const int own : {1, 2, 5, 9}) {
    NeighbourWatch near = watch(scenario, "Q" + std::to_string(own));
    near.on_frame(frame_of(scenario, kStart, 0.0));
    Names expected;
    for (const int other : {own - 1, own + 1}) {
      if (other >= 1 && other <= 9) {
        expected.insert("Q" + std::to_string(other));
      }
    }
    EXPECT_EQ(to, expected) << own;
    to.clear();
  }
}

TEST_F(NeighbourSubscriptions, UpdatesOncePerStep) {
  scenario::Scenario scenario = in_a_row(2, 10.0);
  scenario.planner.step_s = 0.25;
  NeighbourWatch near = watch(scenario);
  const auto listens_at = [&](int ms, double x_m) {
    near.on_frame(frame_of(scenario, kStart + Duration{1'000} * ms, x_m));
    return !to.empty();
  };
  EXPECT_TRUE(listens_at(0, 0.0));
  EXPECT_TRUE(listens_at(249, 30.0));
  EXPECT_FALSE(listens_at(250, 30.0));
  EXPECT_FALSE(listens_at(499, 0.0));
  EXPECT_TRUE(listens_at(600, 0.0));
  EXPECT_TRUE(listens_at(849, 30.0)) << "one step after the last evaluation";
  EXPECT_FALSE(listens_at(850, 30.0));
}

TEST_F(NeighbourSubscriptions, KeepsUnseenRobots) {
  const scenario::Scenario scenario = in_a_row(4, 20.0);
  NeighbourWatch near = watch(scenario);
  near.on_frame(frame_of(scenario, kStart, 0.0));
  models::MocapFrame dark = frame_of(scenario, kStart + kStep, 25.0);
  dark.bodies[1].occluded = true;  // occluded; its new position would change the result
  dark.bodies[3].occluded = true;
  near.on_frame(dark);
  EXPECT_EQ(to, (Names{"Q2", "Q3"}));
  models::MocapFrame blind = frame_of(scenario, kStart + 2 * kStep, 1e3);
  blind.bodies[0].occluded = true;
  near.on_frame(blind);
  EXPECT_EQ(to, (Names{"Q2", "Q3"})) << "its own position is unknown";
}

}  // namespace
}  // namespace vantage::bus
