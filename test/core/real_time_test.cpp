#include "core/real_time.hpp"

#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sched.h>

#include "core/check.hpp"

namespace vantage {
namespace {

struct Arguments {
  explicit Arguments(std::vector<std::string> given) : words(std::move(given)) {
    for (std::string& word : words) {
      pointers.push_back(word.data());
    }
    pointers.push_back(nullptr);
    count = static_cast<int>(words.size());
  }
  std::vector<std::string> words;
  std::vector<char*> pointers;
  int count = 0;
};

RealTime take(std::vector<std::string> words) {
  Arguments arguments(std::move(words));
  return take_real_time(arguments.count, arguments.pointers.data());
}

TEST(TakeRealTime, KeepsOtherArgumentsInOrder) {
  Arguments arguments(
      {"program", "--scenario", "a", "--fifo", "50", "--cpu", "1", "--lock-memory", "--robot"});
  const RealTime real_time = take_real_time(arguments.count, arguments.pointers.data());
  EXPECT_EQ(real_time.fifo_priority, 50);
  EXPECT_EQ(real_time.cpu, 1);
  EXPECT_TRUE(real_time.lock_memory);
  ASSERT_EQ(arguments.count, 4);
  EXPECT_STREQ(arguments.pointers[1], "--scenario");
  EXPECT_STREQ(arguments.pointers[2], "a");
  EXPECT_STREQ(arguments.pointers[3], "--robot");
  EXPECT_EQ(arguments.pointers[4], nullptr);
}

TEST(TakeRealTime, RequestsNothingByDefault) {
  const RealTime real_time = take({"program"});
  EXPECT_EQ(real_time.fifo_priority, 0);
  EXPECT_EQ(real_time.cpu, -1);
  EXPECT_FALSE(real_time.lock_memory);
  apply(real_time);
}

// grants_fifo() does not change the calling thread; its result agrees with that of apply().
TEST(GrantsFifo, AgreesWithApply) {
  const int policy_before = sched_getscheduler(0);
  const bool is_granted = grants_fifo(50);
  EXPECT_EQ(sched_getscheduler(0), policy_before);
  bool is_applied = true;
  std::thread([&] {
    RealTime real_time;
    real_time.fifo_priority = 50;
    try {
      apply(real_time);
    } catch (const StartupError&) {
      is_applied = false;
    }
  }).join();
  EXPECT_EQ(is_granted, is_applied);
  EXPECT_FALSE(grants_fifo(1'000)) << "this priority does not exist";
}

TEST(RunsInRealTime, IsTrueOnlyWithARealTimePolicy) {
  std::thread([] {
    sched_param parameters{};
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &parameters);
    EXPECT_FALSE(runs_in_real_time());
    parameters.sched_priority = 1;
    for (const int policy : {SCHED_FIFO, SCHED_RR}) {
      const bool is_set = pthread_setschedparam(pthread_self(), policy, &parameters) == 0;
      EXPECT_EQ(runs_in_real_time(), is_set);
    }
  }).join();
}

TEST(TakeRealTime, RefusesInvalidValues) {
  EXPECT_THROW(take({"program", "--fifo"}), UsageError);
  EXPECT_THROW(take({"program", "--fifo", "0"}), UsageError);
  EXPECT_THROW(take({"program", "--fifo", "100"}), UsageError);
  EXPECT_THROW(take({"program", "--fifo", "5x"}), UsageError);
  EXPECT_THROW(take({"program", "--cpu", "-1"}), UsageError);
  EXPECT_THROW(take({"program", "--cpu", ""}), UsageError);
}

TEST(ApplyRealTime, ReportsRefusalAndRemedy) {
  RealTime real_time;
  real_time.cpu = 1023;  // no existing machine has this CPU
  try {
    apply(real_time);
    FAIL() << "a missing CPU was accepted";
  } catch (const StartupError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("--cpu 1023"), std::string::npos) << text;
    EXPECT_NE(text.find("choose a CPU that exists"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace vantage
