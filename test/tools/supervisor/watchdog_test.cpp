#include "tools/supervisor/watchdog.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

constexpr Time at(double s) { return from_utime(static_cast<std::int64_t>(s * 1e6)); }
using Names = std::vector<std::string>;

TEST(Watchdog, ProcessThatStopsGivingSignsIsOverdueOnce) {
  Watchdog dog;
  dog.watch("a", 1.0);
  dog.watch("b", 3.0);
  dog.on_sign("a", at(0.0));
  dog.on_sign("b", at(0.0));
  EXPECT_EQ(dog.overdue(at(1.0)), Names{});
  EXPECT_EQ(dog.overdue(at(1.001)), Names{"a"});
  EXPECT_EQ(dog.overdue(at(2.0)), Names{});
  EXPECT_EQ(dog.overdue(at(3.001)), Names{"b"});
}

TEST(Watchdog, WaitsForTheVeryFirstSignHoweverLong) {
  Watchdog dog;
  dog.watch("a", 1.0);
  EXPECT_EQ(dog.overdue(at(100.0)), Names{});
  dog.on_start("a", at(100.0));  // it may be one that never says anything
  EXPECT_EQ(dog.overdue(at(1000.0)), Names{});
}

// Flown: a planner that was hung up again before it had said a word was left so for good.
TEST(Watchdog, OneThatIsStartedAgainHasAWhileForItsFirstSign) {
  Watchdog dog;
  dog.watch("a", 1.0);
  for (const double begin_s : {100.0, 200.0}) {  // and once more
    dog.on_sign("a", at(begin_s));
    EXPECT_EQ(dog.overdue(at(begin_s + 1.5)), Names{"a"});
    dog.on_end("a");
    EXPECT_EQ(dog.overdue(at(begin_s + 40.0)), Names{}) << "nothing runs";
    for (const double start_s : {begin_s + 40.0, begin_s + 60.0}) {
      dog.on_start("a", at(start_s));
      EXPECT_EQ(dog.overdue(at(start_s + Watchdog::kFirstSignS)), Names{});
      EXPECT_EQ(dog.overdue(at(start_s + Watchdog::kFirstSignS + 0.001)), Names{"a"});
      EXPECT_EQ(dog.overdue(at(start_s + Watchdog::kFirstSignS + 1.0)), Names{}) << "named once";
    }
    dog.on_start("a", at(begin_s + 80.0));
    dog.on_sign("a", at(begin_s + 81.0));
    EXPECT_EQ(dog.overdue(at(begin_s + 81.9)), Names{});
    EXPECT_EQ(dog.overdue(at(begin_s + 82.1)), Names{"a"}) << "its own patience from then on";
  }
}

TEST(Watchdog, AStartBeforeItIsOverdueGivesItTime) {
  Watchdog dog;
  dog.watch("a", 1.0);
  dog.on_sign("a", at(0.0));
  dog.on_start("a", at(0.5));
  EXPECT_EQ(dog.overdue(at(10.0)), Names{});
}

TEST(Watchdog, SignsOfStrangersAreNobodys) {
  Watchdog dog;
  dog.watch("a", 1.0);
  dog.on_sign("x", at(0.0));
  EXPECT_EQ(dog.overdue(at(10.0)), Names{});
}

}  // namespace
}  // namespace vantage::tools
