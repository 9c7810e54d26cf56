#include "trial/virtual_loop.hpp"

#include <map>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "test/logs/file_support.hpp"

namespace vantage::trial {
namespace {

constexpr Time kStart = from_utime(1'000'000);
using Diary = std::vector<std::string>;

/// A node that ticks at a fixed period, publishes on its own channel and records its events.
class DiaryNode : public bus::Node {
 public:
  DiaryNode(std::string name, bus::Bus& bus, Diary& diary, Duration period)
      : name_(std::move(name)), bus_(bus), diary_(diary), period_(period), next_(kStart) {
    bus_.subscribe<models::AttackNotice>({"DIARY_*"}, [this](const models::AttackNotice& received) {
      diary_.push_back(name_ + " hears " + received.jammed.front());
    });
  }
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] Time next_tick() const override { return next_; }
  void tick(Time now) override {
    diary_.push_back(name_ + " at " + std::to_string(to_utime(now) - to_utime(kStart)));
    models::AttackNotice notice;
    notice.stamp.time = now;
    notice.jammed = {name_};
    bus_.publish(bus::Channel<models::AttackNotice>{"DIARY_" + name_}, notice);
    next_ += period_;
  }

 private:
  std::string name_;
  bus::Bus& bus_;
  Diary& diary_;
  Duration period_;
  Time next_;
};

NodeRecipe recipe(const std::string& name, Diary& diary, Duration period) {
  return {name, [name, &diary, period](bus::Bus& bus, const bus::Clock&) {
            return std::make_unique<DiaryNode>(name, bus, diary, period);
          }};
}

TEST(VirtualTimeLoop, DeliversBetweenTicks) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  loop.add_node(recipe("A", diary, Duration(20)), 1);
  loop.add_node(recipe("B", diary, Duration(30)), 2);
  loop.run_until(kStart + Duration(31));
  const Diary expected = {"A at 0",  "A hears A", "B hears A", "B at 0",  "A hears B", "B hears B",
                          "A at 20", "A hears A", "B hears A", "B at 30", "A hears B", "B hears B"};
  EXPECT_EQ(diary, expected);
  EXPECT_EQ(loop.clock().now(), kStart + Duration(31));
  EXPECT_EQ(loop.messages_lost(), 0);
}

TEST(VirtualTimeLoop, IsIndependentOfTheStepLength) {
  Diary whole;
  Diary pieces;
  VirtualTimeLoop one(kStart);
  one.add_node(recipe("A", whole, Duration(7)), 1);
  one.add_node(recipe("B", whole, Duration(11)), 2);
  one.run_until(kStart + Duration(200));
  VirtualTimeLoop many(kStart);
  many.add_node(recipe("A", pieces, Duration(7)), 1);
  many.add_node(recipe("B", pieces, Duration(11)), 2);
  for (int end = 13; end <= 208; end += 13) {
    many.run_until(kStart + Duration(std::min(end, 200)));
  }
  EXPECT_EQ(whole, pieces);
}

TEST(VirtualTimeLoop, DoesNotTickAtItsEnd) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  loop.add_node(recipe("A", diary, Duration(10)), 1);
  loop.run_until(kStart + Duration(10));
  EXPECT_EQ(diary, (Diary{"A at 0", "A hears A"}));
}

TEST(VirtualTimeLoop, RefusesANodeWhoseNextTickDoesNotAdvance) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  loop.add_node(recipe("A", diary, Duration(0)), 1);
  EXPECT_THROW(loop.run_until(kStart + Duration(10)), std::logic_error);
}

TEST(VirtualTimeLoop, ReportsTheHealthOfItsNodes) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  std::set<std::string> received;
  loop.add_bus(9).subscribe<models::ProcessHealth>(
      bus::health_channel("*"),
      [&received](const models::ProcessHealth& health) { received.insert(health.process); });
  loop.add_node(recipe("A", diary, std::chrono::milliseconds(500)), 1);
  loop.add_node(recipe("B", diary, std::chrono::milliseconds(500)), 2);
  loop.run_until(kStart + std::chrono::seconds(3));
  EXPECT_EQ(received, (std::set<std::string>{"A", "B"}));
}

TEST(VirtualTimeLoop, DeliversToListenersBeforeTheNextTick) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  const auto receiver = loop.connect();
  receiver->subscribe("DIARY_*", [&diary](std::string_view channel, const auto& /*bytes*/) {
    diary.push_back("recorded " + std::string(channel));
  });
  loop.on_delivered([&receiver] {
    while (receiver->handle(std::chrono::microseconds(0)) > 0) {
    }
  });
  loop.add_node(recipe("A", diary, Duration(20)), 1);
  loop.add_node(recipe("B", diary, Duration(30)), 2);
  loop.run_until(kStart + Duration(1));
  EXPECT_EQ(diary, (Diary{"A at 0", "A hears A", "B hears A", "recorded DIARY_A", "B at 0",
                          "A hears B", "B hears B", "recorded DIARY_B"}));
}

TEST(VirtualTimeLoop, DeliversMessagesPublishedDuringDelivery) {
  VirtualTimeLoop loop(kStart);
  const bus::Channel<models::AttackNotice> ask{"ASK"};
  const bus::Channel<models::AttackNotice> answer{"ANSWER"};
  bus::Bus& one = loop.add_bus(1);
  bus::Bus& two = loop.add_bus(2);
  int left = 5;
  int requests = 0;
  two.subscribe<models::AttackNotice>(ask, [&](const models::AttackNotice& notice) {
    ++requests;
    two.publish(answer, notice);
  });
  one.subscribe<models::AttackNotice>(answer, [&](const models::AttackNotice& notice) {
    if (--left > 0) {
      one.publish(ask, notice);
    }
  });
  one.publish(ask, {});
  loop.deliver();
  EXPECT_EQ(left, 0);
  EXPECT_EQ(requests, 5);
  EXPECT_EQ(loop.messages_lost(), 0);
}

TEST(VirtualTimeLoop, ExecutesAnOverdueTickAtThePresentTime) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  loop.run_until(kStart + Duration(100));
  EXPECT_EQ(loop.clock().now(), kStart + Duration(100));
  loop.add_node(recipe("A", diary, Duration(150)), 1);  // due since 100 us
  loop.run_until(kStart + Duration(140));
  EXPECT_EQ(diary.front(), "A at 100");
  EXPECT_EQ(loop.clock().now(), kStart + Duration(140));
  loop.run_until(kStart + Duration(160));
  ASSERT_EQ(diary.size(), 4U);
  EXPECT_EQ(diary[2], "A at 150");
}

vantage_lcm::attack_t attack_numbered(std::int64_t sequence) {
  vantage_lcm::attack_t attack{};
  attack.utime = to_utime(kStart) + sequence;
  attack.run_id = 5;
  attack.sequence = sequence;
  return attack;
}

// One bus misses four sequence numbers of channel A and three of B; another bus misses only the
// three of B. A third bus has a queue of ten thousand messages and drops seven.
TEST(VirtualTimeLoop, CountsLossAndDroppedMessages) {
  VirtualTimeLoop loop(kStart);
  const auto sending_end = loop.connect();
  const auto publish_numbered = [&](const std::string& channel, std::int64_t sequence) {
    sending_end->publish(channel, logs::test::encoded(attack_numbered(sequence)));
  };
  const auto ignore = [](const models::AttackNotice& /*notice*/) {};
  bus::Bus& both = loop.add_bus(1);
  both.subscribe<models::AttackNotice>({"A"}, ignore);
  both.subscribe<models::AttackNotice>({"B"}, ignore);
  loop.add_bus(2).subscribe<models::AttackNotice>({"B"}, ignore);
  for (const std::int64_t sequence : {0, 5}) {
    publish_numbered("A", sequence);
  }
  for (const std::int64_t sequence : {0, 4}) {
    publish_numbered("B", sequence);
  }
  loop.deliver();
  EXPECT_EQ(loop.messages_lost(), 4 + 3 + 3);
  loop.add_bus(3).subscribe<models::AttackNotice>({"C"}, ignore);
  for (int i = 0; i < 10'007; ++i) {
    publish_numbered("C", i);
  }
  loop.deliver();
  EXPECT_EQ(loop.messages_lost(), 4 + 3 + 3 + 7) << "losses on the first bus are unknown";
}

TEST(VirtualTimeLoop, CountsTheTicksOfEachNode) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  std::map<std::string, models::ProcessHealth> newest;
  loop.add_bus(9).subscribe<models::ProcessHealth>(
      bus::health_channel("*"),
      [&newest](const models::ProcessHealth& health) { newest[health.process] = health; });
  loop.add_node(recipe("A", diary, std::chrono::milliseconds(500)), 1);
  loop.add_node(recipe("B", diary, std::chrono::milliseconds(250)), 2);
  loop.run_until(kStart + std::chrono::microseconds(3'000'001));
  ASSERT_EQ(newest.size(), 2U);
  EXPECT_EQ(newest["A"].loops, 7) << "at 0, 0.5, ... and 3 s, the time of the report";
  EXPECT_EQ(newest["B"].loops, 13);
  for (const auto& [name, health] : newest) {
    EXPECT_EQ(health.loop_worst_s, 0.0) << "virtual time does not advance in a loop";
    EXPECT_EQ(health.stamp.time, kStart + std::chrono::seconds(3));
  }
}

TEST(DeterministicRunId, DependsOnSeedAndNameAndIsNonZero) {
  std::set<std::int64_t> ids;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    for (const std::string name : {"SIM", "PLANNER_Q1", "PLANNER_Q2"}) {
      const std::int64_t id = deterministic_run_id(seed, name);
      EXPECT_GT(id, 0);
      EXPECT_EQ(id, deterministic_run_id(seed, name));
      ids.insert(id);
    }
  }
  EXPECT_EQ(ids.size(), 300U);
}

}  // namespace
}  // namespace vantage::trial
