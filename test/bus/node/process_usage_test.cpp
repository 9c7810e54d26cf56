#include "bus/node/process_usage.hpp"

#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace vantage::bus {
namespace {

// A line of proc(5), fields 3 to 24: state, …, utime 250, stime 50, …, start, vsize, rss 1000.
const std::string kRest =
    " S 1 9 9 0 -1 4194560 100 0 0 0 250 50 0 0 20 0 3 0 1234 500000000 1000 18446744073709551615";

TEST(UsageFromStat, CountsUserAndSystemTimeAndResidentPages) {
  const auto usage = usage_from_stat("77 (vantage-sim)" + kRest, 100, 4096);
  ASSERT_TRUE(usage);
  EXPECT_EQ(usage->cpu_us, 3'000'000);
  EXPECT_EQ(usage->memory_bytes, 4'096'000);
}

TEST(UsageFromStat, IsNotMisledByTheName) {
  const auto usage = usage_from_stat("77 (a) R 1 (2 b)" + kRest, 100, 4096);
  ASSERT_TRUE(usage);
  EXPECT_EQ(usage->cpu_us, 3'000'000);
}

TEST(UsageFromStat, RefusesWhatIsNoSuchLine) {
  EXPECT_FALSE(usage_from_stat("", 100, 4096));
  EXPECT_FALSE(usage_from_stat("77 (x) S 1 9 9", 100, 4096));
  EXPECT_FALSE(usage_from_stat("77 (x) S 1 9 9 0 -1 4 1 0 0 0 many 50 0 0 20 0 3 0 1 5 1", 100, 1));
  EXPECT_FALSE(usage_from_stat("77 (vantage-sim)" + kRest, 0, 4096));
}

TEST(UsageFromStat, NeedsNoMoreThanTheFieldsThatItReads) {
  const std::string least = kRest.substr(0, kRest.rfind(' '));
  const auto usage = usage_from_stat("77 (x)" + least, 1, 1);
  ASSERT_TRUE(usage);
  EXPECT_EQ(usage->cpu_us, 300'000'000) << "of ticks of a second";
  EXPECT_EQ(usage->memory_bytes, 1'000);
  EXPECT_EQ(usage->memory_most_bytes, 0);
  EXPECT_FALSE(usage_from_stat("77 (x)" + least.substr(0, least.rfind(' ')), 1, 1));
  EXPECT_FALSE(usage_from_stat("77 (x)" + least, -1, 1));
  EXPECT_FALSE(usage_from_stat("77 x" + least, 1, 1)) << "no name";
}

// What the kernel says before and after holds what is said in between.
TEST(UsageCounters, AreWhatTheKernelSaysOfThisProcess) {
  const auto asked = [] {
    rusage own{};
    ::getrusage(RUSAGE_SELF, &own);
    return own;
  };
  const auto cpu_us = [](const rusage& own) {
    return (own.ru_utime.tv_sec + own.ru_stime.tv_sec) * 1'000'000 + own.ru_utime.tv_usec +
           own.ru_stime.tv_usec;
  };
  const rusage before = asked();
  const auto counters = usage_counters();
  const rusage after = asked();
  ASSERT_EQ(counters.size(), 3U);
  EXPECT_GE(counters[0].count, cpu_us(before));
  EXPECT_LE(counters[0].count, cpu_us(after));
  EXPECT_EQ(counters[1].name, "process.memory_bytes");
  EXPECT_EQ(counters[1].count % ::sysconf(_SC_PAGESIZE), 0);
  EXPECT_EQ(counters[2].name, "process.memory_most_bytes");
  EXPECT_GE(counters[2].count, before.ru_maxrss * 1024);
  EXPECT_LE(counters[2].count, after.ru_maxrss * 1024);
}

TEST(UsageOf, KnowsThisProcessAndNoneThatIsGone) {
  const auto own = usage_of(::getpid());
  ASSERT_TRUE(own);
  EXPECT_GT(own->memory_bytes, 0);
  EXPECT_FALSE(usage_of(-1));
  const auto counters = usage_counters();
  ASSERT_EQ(counters.size(), 3U);
  EXPECT_EQ(counters[0].name, "process.cpu_us");
  EXPECT_GE(counters[2].count, counters[1].count / 2) << "kernels count the two differently";
}

}  // namespace
}  // namespace vantage::bus
