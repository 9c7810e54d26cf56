#include "trial/virtual_loop.hpp"

#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

namespace vantage::trial {
namespace {

constexpr Time kStart = from_utime(1'000'000);
using Diary = std::vector<std::string>;

/// Ticks at a fixed period, publishes on a channel of its own, writes down all that happens to it.
class DiaryNode : public bus::Node {
 public:
  DiaryNode(std::string name, bus::Bus& bus, Diary& diary, Duration period)
      : name_(std::move(name)), bus_(bus), diary_(diary), period_(period), next_(kStart) {
    bus_.subscribe<models::AttackNotice>({"DIARY_*"}, [this](const models::AttackNotice& heard) {
      diary_.push_back(name_ + " hears " + heard.jammed.front());
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

TEST(VirtualTimeLoop, JumpsFromTickToTickAndDeliversBeforeTheNextOneActs) {
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

TEST(VirtualTimeLoop, IsTheSameInPiecesAsInOneGo) {
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

TEST(VirtualTimeLoop, DoesNotActAtItsEnd) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  loop.add_node(recipe("A", diary, Duration(10)), 1);
  loop.run_until(kStart + Duration(10));
  EXPECT_EQ(diary, (Diary{"A at 0", "A hears A"}));
}

TEST(VirtualTimeLoop, RefusesANodeWhoseTimeStandsStill) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  loop.add_node(recipe("A", diary, Duration(0)), 1);
  EXPECT_THROW(loop.run_until(kStart + Duration(10)), std::logic_error);
}

TEST(VirtualTimeLoop, ReportsTheHealthOfItsNodes) {
  Diary diary;
  VirtualTimeLoop loop(kStart);
  std::set<std::string> heard;
  loop.add_bus(9).subscribe<models::ProcessHealth>(
      bus::health_channel("*"),
      [&heard](const models::ProcessHealth& health) { heard.insert(health.process); });
  loop.add_node(recipe("A", diary, std::chrono::milliseconds(500)), 1);
  loop.add_node(recipe("B", diary, std::chrono::milliseconds(500)), 2);
  loop.run_until(kStart + std::chrono::seconds(3));
  EXPECT_EQ(heard, (std::set<std::string>{"A", "B"}));
}

TEST(DeterministicRunId, DependsOnSeedAndNameAndIsNeverZero) {
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
