#include "bus/node/replay_queue.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace vantage::bus {
namespace {

/// Makes again all but `missing`, of which it takes down when it gave up.
struct Player {
  ReplayQueue<int> queue{3};
  int missing = 0;
  std::vector<int> made;
  int given_up = 0;

  void work() {
    queue.work([this](int logged, bool is_last_chance) {
      if (logged != missing) {
        made.push_back(logged);
        return true;
      }
      given_up += is_last_chance ? 1 : 0;
      return false;
    });
  }
};

TEST(ReplayQueue, KeepsTheOrderOfTheLog) {
  Player player;
  for (int i = 1; i <= 3; ++i) {
    player.queue.add(i);
  }
  player.work();
  EXPECT_EQ(player.made, (std::vector<int>{1, 2, 3}));
}

TEST(ReplayQueue, WaitsUntilTheInputComes) {
  Player player;
  player.missing = 1;
  player.queue.add(1);
  player.queue.add(2);
  player.work();
  EXPECT_TRUE(player.made.empty());
  player.missing = 0;
  player.work();
  EXPECT_EQ(player.made, (std::vector<int>{1, 2}));
  EXPECT_EQ(player.given_up, 0);
}

TEST(ReplayQueue, GivesUpWhenMoreWaitBehindIt) {
  Player player;
  player.missing = 1;
  for (int i = 1; i <= 3; ++i) {
    player.queue.add(i);
    player.work();
  }
  EXPECT_EQ(player.given_up, 0);
  player.queue.add(4);
  player.work();
  EXPECT_EQ(player.given_up, 1);
  EXPECT_EQ(player.made, (std::vector<int>{2, 3, 4}));
}

TEST(ReplayQueue, GivesUpAfterTwoSecondsOfTicksEachAnew) {
  Player player;
  player.missing = 7;
  for (int i = 0; i < 30; ++i) {  // with nothing to wait for
    player.queue.tick();
  }
  player.queue.add(7);
  player.queue.add(7);
  int ticks = 0;
  for (; player.given_up == 0; ++ticks) {
    player.queue.tick();
    player.work();
  }
  EXPECT_EQ(ticks, from_seconds(2.0) / kReplayTick);
  for (; player.given_up == 1; ++ticks) {
    player.queue.tick();
    player.work();
  }
  EXPECT_EQ(ticks, 2 * (from_seconds(2.0) / kReplayTick));
}

}  // namespace
}  // namespace vantage::bus
