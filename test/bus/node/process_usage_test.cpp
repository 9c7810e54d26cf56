#include "bus/node/process_usage.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include "test/support/emulation.hpp"

namespace vantage::bus {
namespace {

// Fields 3 to 24 of a line of proc(5) stat: state, …, utime 250, stime 50, …, start, vsize, rss
// 1000.
const std::string kRest =
    " S 1 9 9 0 -1 4194560 100 0 0 0 250 50 0 0 20 0 3 0 1234 500000000 1000 18446744073709551615";

TEST(UsageFromStat, CountsUserAndSystemTimeAndResidentPages) {
  const auto usage = usage_from_stat("77 (vantage-sim)" + kRest, 100, 4096);
  ASSERT_TRUE(usage);
  EXPECT_EQ(usage->cpu_us, 3'000'000);
  EXPECT_EQ(usage->memory_bytes, 4'096'000);
}

TEST(UsageFromStat, AcceptsAnyProcessName) {
  const auto usage = usage_from_stat("77 (a) R 1 (2 b)" + kRest, 100, 4096);
  ASSERT_TRUE(usage);
  EXPECT_EQ(usage->cpu_us, 3'000'000);
}

TEST(UsageFromStat, RefusesMalformedLines) {
  EXPECT_FALSE(usage_from_stat("", 100, 4096));
  EXPECT_FALSE(usage_from_stat("77 (x) S 1 9 9", 100, 4096));
  EXPECT_FALSE(usage_from_stat("77 (x) S 1 9 9 0 -1 4 1 0 0 0 many 50 0 0 20 0 3 0 1 5 1", 100, 1));
  EXPECT_FALSE(usage_from_stat("77 (vantage-sim)" + kRest, 0, 4096));
}

TEST(UsageFromStat, RequiresOnlyTheFieldsThatItReads) {
  const std::string least = kRest.substr(0, kRest.rfind(' '));
  const auto usage = usage_from_stat("77 (x)" + least, 1, 1);
  ASSERT_TRUE(usage);
  EXPECT_EQ(usage->cpu_us, 300'000'000) << "in ticks of one second";
  EXPECT_EQ(usage->memory_bytes, 1'000);
  EXPECT_EQ(usage->memory_most_bytes, 0);
  EXPECT_FALSE(usage_from_stat("77 (x)" + least.substr(0, least.rfind(' ')), 1, 1));
  EXPECT_FALSE(usage_from_stat("77 (x)" + least, -1, 1));
  EXPECT_FALSE(usage_from_stat("77 x" + least, 1, 1)) << "the name is missing";
}

TEST(WaitedUsFromSchedstat, ReadsTheSecondNumber) {
  EXPECT_EQ(waited_us_from_schedstat("5000000 1234567 42\n"), 1'234);
  EXPECT_EQ(waited_us_from_schedstat("1 999 1"), 0);
  EXPECT_EQ(waited_us_from_schedstat("0 5000 0"), 5) << "a thread that has not run yet";
  EXPECT_EQ(waited_us_from_schedstat("1 0 1"), 0);
}

TEST(WaitedUsFromSchedstat, RefusesMalformedLinesAndZeroCounters) {
  EXPECT_FALSE(waited_us_from_schedstat(""));
  EXPECT_FALSE(waited_us_from_schedstat("5000000"));
  EXPECT_FALSE(waited_us_from_schedstat("5000000 1234567"));
  EXPECT_FALSE(waited_us_from_schedstat("5000000 many 42"));
  EXPECT_FALSE(waited_us_from_schedstat("5000000,1234567 42"));
  EXPECT_FALSE(waited_us_from_schedstat("99999999999999999999 1234567 42"));
  EXPECT_FALSE(waited_us_from_schedstat("0 0 0"));
}

/// Restricts the calling thread to the first processor that it may use.
void stay_on_one_processor() {
  cpu_set_t allowed;
  ASSERT_EQ(sched_getaffinity(0, sizeof(allowed), &allowed), 0);
  std::size_t cpu = 0;
  while (!CPU_ISSET(cpu, &allowed)) {
    ++cpu;
  }
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(cpu, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
}

/// Returns the waiting time of all threads of this process, µs, by the kernel's statistics.
std::int64_t waited_us_by_thread() {
  std::int64_t sum_us = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(task.path() / "schedstat");
    std::int64_t ran_ns = 0;
    std::int64_t waited_ns = 0;
    file >> ran_ns >> waited_ns;
    sum_us += waited_ns / 1'000;
  }
  return sum_us;
}

// Threads on one processor take turns: while one thread runs, the others wait.
TEST(WaitedUsOf, SumsTheWaitsOfAllThreads) {
  if (!waited_us_of(::getpid())) {
    GTEST_SKIP() << "this kernel does not count waits";
  }
  std::atomic<bool> is_over = false;
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back([&is_over] {
      stay_on_one_processor();
      while (!is_over) {
      }
    });
  }
  for (std::int64_t before_us = 0; before_us < 30'000;) {
    before_us = waited_us_by_thread();
    const std::int64_t waited_us = waited_us_of(::getpid()).value_or(-1);
    EXPECT_GE(waited_us, before_us);
    EXPECT_LE(waited_us, waited_us_by_thread());
  }
  is_over = true;
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_FALSE(waited_us_of(-1));
}

TEST(ThreadWait, ReadsTheCounterOfTheThreadThatOpenedIt) {
  const auto by_file = [] {
    std::ifstream file("/proc/thread-self/schedstat");
    std::string text;
    std::getline(file, text);
    return waited_us_from_schedstat(text);
  };
  const auto before_us = by_file();
  const ThreadWait wait;
  const auto read_us = wait.waited_us();
  const auto after_us = by_file();
  ASSERT_EQ(read_us.has_value(), before_us.has_value());
  if (!read_us) {
    GTEST_SKIP() << "this kernel does not count waits";
  }
  EXPECT_GE(*read_us, *before_us);
  EXPECT_LE(*read_us, *after_us);
  EXPECT_GE(wait.waited_us().value_or(-1), *read_us) << "the file is read from its beginning again";
}

// The reported values are between the kernel's values read before and after the report.
TEST(UsageCounters, AgreeWithTheKernelsFigures) {
  const auto kernel_usage = [] {
    rusage own{};
    ::getrusage(RUSAGE_SELF, &own);
    return own;
  };
  const auto cpu_us = [](const rusage& own) {
    return (own.ru_utime.tv_sec + own.ru_stime.tv_sec) * 1'000'000 + own.ru_utime.tv_usec +
           own.ru_stime.tv_usec;
  };
  const auto waited_before_us = waited_us_of(::getpid());
  const rusage before = kernel_usage();
  const auto counters = usage_counters();
  const rusage after = kernel_usage();
  ASSERT_GE(counters.size(), 3U);
  EXPECT_GE(counters[0].count, cpu_us(before));
  EXPECT_LE(counters[0].count, cpu_us(after));
  EXPECT_EQ(counters[1].name, "process.memory_bytes");
  EXPECT_EQ(counters[1].count % ::sysconf(_SC_PAGESIZE), 0);
  EXPECT_EQ(counters[2].name, "process.memory_most_bytes");
  EXPECT_GE(counters[2].count, before.ru_maxrss * 1024);
  EXPECT_LE(counters[2].count, after.ru_maxrss * 1024);
  ASSERT_EQ(counters.size(), waited_before_us ? 4U : 3U);
  if (waited_before_us) {
    EXPECT_EQ(counters[3].name, "process.waited_us");
    EXPECT_GE(counters[3].count, *waited_before_us);
    EXPECT_LE(counters[3].count, waited_us_of(::getpid()));
  }
}

TEST(UsageOf, ReadsThisProcessAndReturnsNothingForAnEndedOne) {
  const auto own = usage_of(::getpid());
  ASSERT_TRUE(own);
  if (!test::is_emulated()) {
    EXPECT_GT(own->memory_bytes, 0);
  }
  EXPECT_FALSE(usage_of(-1));
  const auto counters = usage_counters();
  ASSERT_GE(counters.size(), 3U);
  EXPECT_EQ(counters[0].name, "process.cpu_us");
  EXPECT_GE(counters[2].count, counters[1].count / 2)
      << "the kernel counts the two values differently";
}

}  // namespace
}  // namespace vantage::bus
