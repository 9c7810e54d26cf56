#include "bus/node/air_budget.hpp"

#include <gtest/gtest.h>

#include "bus/node/bus.hpp"
#include "core/index.hpp"

namespace vantage::bus {
namespace {

constexpr Time kStart = from_utime(1'000'000'000'000'000);

scenario::Scenario team(double budget_kbitps) {
  scenario::Scenario scenario;
  for (const char* name : {"Q1", "Q2"}) {
    scenario.robots.emplace_back();
    scenario.robots.back().name = name;
  }
  scenario.network.budget_kbitps = budget_kbitps;
  return scenario;
}

struct ClassRow {
  const char* channel;
  AirClass kind;
};

TEST(AirBudget, ClassifiesChannels) {
  const AirBudget budget(team(10.0));
  const ClassRow rows[] = {{"PLAN_Q1", AirClass::kMotion},
                           {"TEAM_PROPOSAL_Q2", AirClass::kMotion},
                           {"MEASUREMENT_Q1", AirClass::kObservation},
                           {"VEHICLE_Q1", AirClass::kStatus},
                           {"COMPACT_BELIEF_Q1", AirClass::kKnowledge},
                           {"MAP_Q1", AirClass::kKnowledge},
                           {"HEALTH_PLANNER_Q1", AirClass::kHealth},
                           {"BELIEF_Q1", AirClass::kHost},
                           {"SIGHTINGS_Q1", AirClass::kHost},
                           {"MIXTURE_Q1", AirClass::kHost},
                           {"PLAN_Q3", AirClass::kUnlimited},
                           {"HEALTH_SIM", AirClass::kUnlimited},
                           {"VICON", AirClass::kUnlimited},
                           {"COMMAND", AirClass::kUnlimited}};
  for (const ClassRow& row : rows) {
    EXPECT_EQ(budget.class_of(row.channel), row.kind) << row.channel;
  }
}

TEST(AirBudget, SharesAddUpToTheWholeBudget) {
  double sum = 4.0 * share_of(AirClass::kHealth);
  for (const AirClass kind :
       {AirClass::kMotion, AirClass::kObservation, AirClass::kStatus, AirClass::kKnowledge}) {
    sum += share_of(kind);
  }
  EXPECT_DOUBLE_EQ(sum, 1.0);
}

TEST(BytesOnAir, IncludeAllHeaders) {
  EXPECT_EQ(bytes_on_air(7, 100), 20U + 8 + 8 + 8 + 100);
  EXPECT_EQ(bytes_on_air(7, 1456), 1500U);        // one full frame
  EXPECT_EQ(bytes_on_air(7, 1457), 1501U + 20U);  // one full frame and a second one
}

/// Returns the bytes sent in `seconds`, with a message of `payload` bytes every `period_us`.
double sent(AirBudget& budget, const char* channel, std::size_t payload, std::int64_t period_us,
            double seconds) {
  double bytes = 0.0;
  for (Time t = kStart; t < kStart + from_seconds(seconds); t += Duration{period_us}) {
    bytes += budget.admit(channel, payload, t) == Reach::kAll
                 ? static_cast<double>(bytes_on_air(std::string_view(channel).size(), payload))
                 : 0.0;
  }
  return bytes;
}

struct RateRow {
  const char* channel;
  AirClass kind;
  std::size_t payload;
};

TEST(AirBudget, LimitsTheMeanRateOfEachShare) {
  for (const RateRow& row : {RateRow{"MEASUREMENT_Q1", AirClass::kObservation, 120},
                             RateRow{"COMPACT_BELIEF_Q1", AirClass::kKnowledge, 700},
                             RateRow{"COMPACT_BELIEF_Q1", AirClass::kKnowledge, 5000}}) {
    AirBudget budget(team(16.0));
    const double rate_Bps = 16.0 * 125.0 * share_of(row.kind);
    const double bytes = sent(budget, row.channel, row.payload, 10'000, 200.0);
    // The bytes exceed the mean rate at most by two seconds of the share and one message.
    EXPECT_GE(bytes, rate_Bps * 199.0) << row.channel;
    EXPECT_LE(bytes, rate_Bps * 202.0 + 1.1 * static_cast<double>(row.payload) + 100.0)
        << row.channel;
  }
}

TEST(AirBudget, NeverHoldsBackPlans) {
  AirBudget budget(team(4.0));
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(budget.admit("PLAN_Q1", 5000, kStart + Duration{i * 1000}), Reach::kAll);
  }
  EXPECT_EQ(budget.counters()[1].name, "air.overdrawn");
  EXPECT_GT(budget.counters()[1].count, 900);
}

TEST(AirBudget, SendsStatusAndHealthAtAMinimumRate) {
  AirBudget budget(team(4.0));
  EXPECT_GE(sent(budget, "VEHICLE_Q1", 500, 100'000, 60.0), 119.0 * 546.0);  // one per 0.5 s
  EXPECT_GE(sent(budget, "HEALTH_PLANNER_Q1", 3000, 1'000'000, 90.0), 3.0 * 3000.0);
}

TEST(AirBudget, HasSeparateSharesForEachRobot) {
  AirBudget budget(team(4.0));
  sent(budget, "COMPACT_BELIEF_Q1", 5000, 100'000, 1.0);
  EXPECT_EQ(budget.admit("COMPACT_BELIEF_Q1", 100, kStart + Duration{1'000'000}), Reach::kHost);
  EXPECT_EQ(budget.admit("COMPACT_BELIEF_Q2", 100, kStart + Duration{1'000'000}), Reach::kAll);
}

TEST(AirBudget, IsAPureFunctionOfTimesAndBytes) {
  AirBudget first(team(7.0));
  AirBudget second(team(7.0));
  for (int i = 0; i < 5000; ++i) {
    const Time at = kStart + Duration{i * 7919 % 100'000 + i * 50'000};
    const auto bytes = static_cast<std::size_t>(i * 31 % 900);
    ASSERT_EQ(first.payload_left("COMPACT_BELIEF_Q1", at),
              second.payload_left("COMPACT_BELIEF_Q1", at));
    ASSERT_EQ(first.admit("COMPACT_BELIEF_Q1", bytes, at),
              second.admit("COMPACT_BELIEF_Q1", bytes, at));
  }
}

/// Transport that records the published channels by reach.
struct Outbox : Transport {
  std::vector<std::string> all;
  std::vector<std::string> host;
  void subscribe(const std::string& /*channel*/, Handler /*handler*/) override {}
  void unsubscribe(const std::string& /*channel*/) override {}
  bool publish(const std::string& channel, std::span<const std::uint8_t> /*bytes*/) override {
    all.push_back(channel);
    return true;
  }
  bool publish_on_host(const std::string& channel,
                       std::span<const std::uint8_t> /*bytes*/) override {
    host.push_back(channel);
    return true;
  }
  int handle(std::chrono::microseconds /*timeout*/) override { return 0; }
  [[nodiscard]] TransportStats stats() const override { return {}; }
};

TEST(LimitedBus, KeepsBeliefsOnItsHost) {
  Outbox outbox;
  const VirtualClock clock(kStart);
  Bus bus(outbox, 1);
  models::RobotBelief belief;
  bus.publish(belief_channel("Q1"), belief);
  bus.limit_air(std::make_unique<AirBudget>(team(10.0)), clock);
  bus.publish(belief_channel("Q1"), belief);
  bus.publish(plan_channel("Q1"), models::RobotPlan{});
  EXPECT_EQ(outbox.all, (std::vector<std::string>{"BELIEF_Q1", "PLAN_Q1", "PLAN_Q1"}));
  EXPECT_EQ(outbox.host, (std::vector<std::string>{"BELIEF_Q1"}));
}

}  // namespace
}  // namespace vantage::bus
