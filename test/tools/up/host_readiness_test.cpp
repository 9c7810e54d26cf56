#include "tools/up/host_readiness.hpp"

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

TEST(ProcessorTimes, TreatIdleNiceAndDiskWaitAsFree) {
  const auto times =
      processor_times("cpu  100 20 30 400 50 6 7 8 9 10\ncpu0 1 2 3 4 5 6 7 8 0 0\n");
  ASSERT_TRUE(times);
  EXPECT_EQ(times->total, 621);
  EXPECT_EQ(times->free, 470);
}

TEST(ProcessorTimes, RefuseInvalidText) {
  for (const char* text : {"", "cpu ", "cpu  1 2 3 4 5 6 7", "cpu0 1 2 3 4 5 6 7 8", "cpu  a",
                           "cpu  1 2 3 -4 5 6 7 8", "intr 5"}) {
    EXPECT_FALSE(processor_times(text)) << text;
  }
}

TEST(FreeProcessors, EqualsFreeTimeOverElapsedTime) {
  const ProcessorTimes before{100, 1'000};
  EXPECT_NEAR(free_processors(before, {150, 1'200}, 8).value_or(-1.0), 2.0, 1e-12);
  EXPECT_NEAR(free_processors(before, {100, 1'200}, 8).value_or(-1.0), 0.0, 1e-12);
  EXPECT_FALSE(free_processors(before, before, 8)) << "no time has passed";
}

struct Row {
  bool has_priority;
  std::optional<double> free_processors;
  bool is_fault;
};

TEST(HostFault, RequiresPriorityOrFreeProcessors) {
  for (const Row& row : std::vector<Row>{{true, std::nullopt, false},
                                         {true, 0.0, false},
                                         {false, 4.0, false},
                                         {false, 0.5, false},
                                         {false, 0.49, true},
                                         {false, 0.0, true},
                                         {false, std::nullopt, false}}) {
    const auto fault = host_fault({row.has_priority, row.free_processors});
    EXPECT_EQ(fault.has_value(), row.is_fault)
        << row.has_priority << " " << row.free_processors.value_or(-1.0);
    if (fault) {
      for (const char* part : {"free processors", "SCHED_FIFO 50", "ulimit -r", "CAP_SYS_NICE"}) {
        EXPECT_NE(fault->find(part), std::string::npos) << *fault;
      }
    }
  }
}

}  // namespace
}  // namespace vantage::tools
