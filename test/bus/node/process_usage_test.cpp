#include "bus/node/process_usage.hpp"

#include <string>

#include <gtest/gtest.h>
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
