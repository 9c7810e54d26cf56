#include "trial/simulated_network.hpp"

#include <gtest/gtest.h>

#include "logs/metrics/trial_summary.hpp"
#include "scenario/reader/overrides.hpp"
#include "trial/trial.hpp"

namespace vantage::trial {
namespace {

scenario::Scenario two_robots(double loss, double rate_kbitps) {
  scenario::Scenario scenario;
  for (const char* name : {"Q1", "Q2"}) {
    scenario.robots.emplace_back();
    scenario.robots.back().name = name;
  }
  scenario.network.simulation = {loss, rate_kbitps};
  return scenario;
}

TEST(SimulatedNetwork, LosesTheGivenShareOfFrames) {
  const bus::VirtualClock clock(from_utime(1'000'000));
  SimulatedNetwork network(two_robots(0.2, 0.0), clock);
  int one_frame = 0;
  int three_frames = 0;
  constexpr int kMessages = 20'000;
  for (int i = 0; i < kMessages; ++i) {
    network.send("PLAN_Q1", 500, bus::Reach::kAll);
    one_frame += network.arrives_at("Q2") ? 1 : 0;
    EXPECT_TRUE(network.arrives_at("Q1"));
    network.send("PLAN_Q1", 4000, bus::Reach::kAll);
    three_frames += network.arrives_at("Q2") ? 1 : 0;
  }
  // The tolerance is four standard deviations of the binomial shares.
  EXPECT_NEAR(one_frame / double{kMessages}, 0.8, 4.0 * 0.0028);
  EXPECT_NEAR(three_frames / double{kMessages}, 0.512, 4.0 * 0.0035);
}

TEST(SimulatedNetwork, GivesAllProcessesOfAHostTheSameMessages) {
  const bus::VirtualClock clock(from_utime(1'000'000));
  SimulatedNetwork network(two_robots(0.5, 0.0), clock);
  for (int i = 0; i < 100; ++i) {
    network.send("PLAN_Q1", 500, bus::Reach::kAll);
    EXPECT_EQ(network.arrives_at("Q2"), network.arrives_at("Q2"));
  }
}

TEST(SimulatedNetwork, DropsMessagesThatExceedTheQueue) {
  bus::VirtualClock clock(from_utime(1'000'000));
  SimulatedNetwork network(two_robots(0.0, 80.0), clock);  // 10 kB/s: the queue holds 12 000 bytes
  constexpr std::size_t kPayload = 3000;
  for (int i = 0; i < 3; ++i) {
    network.send("PLAN_Q1", kPayload, bus::Reach::kAll);
    EXPECT_TRUE(network.arrives_at("Q2"));
  }
  network.send("PLAN_Q1", kPayload, bus::Reach::kAll);
  EXPECT_FALSE(network.arrives_at("Q2"));
  EXPECT_TRUE(network.arrives_at("Q1"));
  network.send("PLAN_Q2", kPayload, bus::Reach::kAll);  // another link
  EXPECT_TRUE(network.arrives_at("Q1"));
  clock.set(from_utime(2'200'000));
  network.send("PLAN_Q1", kPayload, bus::Reach::kAll);
  EXPECT_TRUE(network.arrives_at("Q2"));
}

TEST(SimulatedNetwork, DoesNotSendHostOnlyMessagesToOtherHosts) {
  const bus::VirtualClock clock(from_utime(1'000'000));
  SimulatedNetwork network(two_robots(0.0, 0.0), clock);
  network.send("BELIEF_Q1", 500, bus::Reach::kHost);
  EXPECT_TRUE(network.arrives_at("Q1"));
  EXPECT_FALSE(network.arrives_at("Q2"));
  EXPECT_TRUE(network.bytes_sent().empty());
  network.send("VICON", 500, bus::Reach::kAll);
  EXPECT_TRUE(network.arrives_at("Q2"));
}

scenario::Scenario short_field(double budget_kbitps, double loss) {
  scenario::Overrides overrides;
  overrides.duration_s = 30.0;
  overrides.node_budget = 200;
  auto scenario = scenario::load_scenario_with(VANTAGE_SOURCE_DIR "/config/field.yaml", overrides);
  scenario.network.budget_kbitps = budget_kbitps;
  scenario.network.simulation.loss = loss;
  return scenario;
}

TEST(TrialWithBudget, StaysBelowTheBudgetAndIsAPureFunctionOfTheSeed) {
  const scenario::Scenario scenario = short_field(32.0, 0.2);
  const TrialResult first = run_trial(scenario, trial_recipes(scenario));
  const TrialResult second = run_trial(scenario, trial_recipes(scenario));
  EXPECT_EQ(logs::to_json(first.summary).dump(), logs::to_json(second.summary).dump());
  std::int64_t bytes = 0;
  for (const models::NamedCount& each : first.air_bytes) {
    bytes += each.count;
  }
  EXPECT_GT(bytes, 0);
  // The full buckets at the start allow two more seconds of traffic: 32 s instead of 30 s.
  EXPECT_LE(static_cast<double>(bytes), 4.0 * 32.0 * 125.0 * 32.0);
}

TEST(TrialWithBudget, SharesBeliefs) {
  const scenario::Scenario scenario = short_field(32.0, 0.0);
  const TrialResult limited = run_trial(scenario, trial_recipes(scenario));
  auto alone = scenario;
  alone.network.communication_range_m = 0.0;
  const TrialResult silent = run_trial(alone, trial_recipes(alone));
  EXPECT_GT(limited.summary.per_robot.discovered, silent.summary.per_robot.discovered + 1.0);
}

}  // namespace
}  // namespace vantage::trial
