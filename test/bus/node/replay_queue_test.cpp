#include "bus/node/replay_queue.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/node/input_store.hpp"

namespace vantage::bus {
namespace {

/// Reproduces all logged values except `missing`; counts how often the queue gives up on `missing`.
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

TEST(ReplayQueue, WaitsForTheInput) {
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

TEST(ReplayQueue, GivesUpWhenTheQueueIsFull) {
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

TEST(ReplayQueue, KeepsThreeWaitingMessagesByDefault) {
  Player player{ReplayQueue<int>(), 1, {}, 0};
  for (int i = 1; i <= 4; ++i) {
    EXPECT_EQ(player.given_up, 0) << i;
    player.queue.add(i);
    player.work();
  }
  EXPECT_EQ(player.given_up, 1);
  Player impatient{ReplayQueue<int>(0), 1, {}, 0};
  impatient.queue.add(1);
  impatient.work();
  EXPECT_EQ(impatient.given_up, 1);
}

TEST(ReplayQueue, MeasuresWaitsFromTheArrival) {
  Player player;
  player.missing = 7;
  player.queue.add(1);
  for (int i = 0; i < 15; ++i) {
    player.queue.tick();
  }
  player.work();  // reproduces 1; then the queue is empty
  player.queue.add(7);
  for (int i = 0; i < 19; ++i) {
    player.queue.tick();
    player.work();
  }
  EXPECT_EQ(player.given_up, 0);
  player.queue.tick();
  player.work();
  EXPECT_EQ(player.given_up, 1);
}

models::OperatorCommand numbered(std::int64_t run, std::int64_t sequence, std::string robot) {
  models::OperatorCommand out;
  out.stamp.run_id = run;
  out.stamp.sequence = sequence;
  out.robot = std::move(robot);
  return out;
}

TEST(InputStore, FindsTheReferencedMessage) {
  InputStore<models::OperatorCommand> store(8);
  EXPECT_EQ(store.find({"A", 1, 2}), nullptr);
  store.add("A", numbered(1, 2, "first"));
  store.add("B", numbered(1, 2, "of another channel"));
  store.add("A", numbered(2, 1, "of another run"));
  store.add("A", numbered(1, 3, "the next"));
  ASSERT_NE(store.find({"A", 1, 2}), nullptr);
  EXPECT_EQ(store.find({"A", 1, 2})->robot, "first");
  EXPECT_EQ(store.find({"B", 1, 2})->robot, "of another channel");
  EXPECT_EQ(store.find({"A", 2, 1})->robot, "of another run");
  EXPECT_EQ(store.find({"A", 1, 3})->robot, "the next");
  EXPECT_EQ(store.find({"B", 1, 3}), nullptr);
  EXPECT_EQ(store.find({"A", 2, 2}), nullptr);
  EXPECT_EQ(store.find({"A", 3, 3}), nullptr);
  store.add("A", numbered(1, 2, "again"));
  EXPECT_EQ(store.find({"A", 1, 2})->robot, "again") << "the newest of equal names";
}

TEST(InputStore, DropsTheOldestBeyondItsCapacity) {
  InputStore<models::OperatorCommand> store(3);
  for (std::int64_t i = 0; i < 10; ++i) {
    store.add("A", numbered(1, i, ""));
    for (std::int64_t k = 0; k <= i; ++k) {
      EXPECT_EQ(store.find({"A", 1, k}) != nullptr, k > i - 3) << i << ' ' << k;
    }
  }
}

// If a teammate's planner has ended, its last plan remains an input of every plan.
TEST(InputStore, KeepsTheLastMessageOfASilentPublisher) {
  InputStore<models::OperatorCommand> store(3);
  store.add("A", numbered(1, 7, "the last"));
  for (std::int64_t i = 0; i < 1000; ++i) {
    store.add(i % 2 == 0 ? "B" : "C", numbered(2, i, ""));
    ASSERT_NE(store.find({"A", 1, 7}), nullptr) << i;
  }
  EXPECT_EQ(store.find({"B", 2, 992}), nullptr);
  EXPECT_NE(store.find({"B", 2, 994}), nullptr);
}

TEST(ReplayQueue, GivesUpOnEachMessageAfterTwoSeconds) {
  Player player;
  player.missing = 7;
  for (int i = 0; i < 30; ++i) {  // no entry waits for input
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
