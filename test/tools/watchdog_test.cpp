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

TEST(Watchdog, WaitsForTheFirstSignHoweverLongAndAgainAfterEachStart) {
  Watchdog dog;
  dog.watch("a", 1.0);
  EXPECT_EQ(dog.overdue(at(100.0)), Names{});
  for (const double begin_s : {100.0, 200.0}) {  // and once more
    dog.on_sign("a", at(begin_s));
    EXPECT_EQ(dog.overdue(at(begin_s + 1.5)), Names{"a"});
    dog.on_start("a");
    EXPECT_EQ(dog.overdue(at(begin_s + 50.0)), Names{});
  }
}

TEST(Watchdog, AStartBeforeItIsOverdueGivesItTime) {
  Watchdog dog;
  dog.watch("a", 1.0);
  dog.on_sign("a", at(0.0));
  dog.on_start("a");
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
