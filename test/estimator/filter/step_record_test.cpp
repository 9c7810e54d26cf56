#include "estimator/filter/step_record.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "test/estimator/filter_support.hpp"
#include "test/support/allocation_counter.hpp"

// Tests of the records of a step's observations.

namespace vantage::estimator {
namespace {

using test::instant;

std::vector<std::pair<Time, int>> looks_of(const StepRecord& record) {
  std::vector<std::pair<Time, int>> looks;
  for (int i = 0; i < record.observation_count; ++i) {
    const Observation& look = record.observations[static_cast<std::size_t>(i)];
    looks.emplace_back(look.time, look.source);
  }
  return looks;
}

// Observations are sorted for any order of arrival, also beyond the capacity.
TEST(StepRecord, OrdersMeasurementsByTimeAndRobot) {
  std::vector<std::pair<Time, int>> sorted;
  for (int step = 0; step < 2; ++step) {
    for (int source = -1; source < 2; ++source) {
      sorted.emplace_back(instant(step), source);
    }
  }
  std::vector<std::pair<Time, int>> order = sorted;
  StepRecord record(3, 4);
  do {
    record.start({0, instant(0), instant(1), false});
    EXPECT_EQ(record.observation_count, 0);
    for (const auto& [time, source] : order) {
      EXPECT_FALSE(record.holds(time, source));
      Observation& look = record.insert(time, source);
      EXPECT_EQ(look.time, time);
      EXPECT_EQ(look.source, source);
      EXPECT_TRUE(look.detections.empty()) << "no detection of an earlier record";
      EXPECT_FALSE(look.counted);
      look.detections.emplace_back();
      look.counted = true;
      EXPECT_TRUE(record.holds(time, source));
    }
    ASSERT_EQ(looks_of(record), sorted);
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_FALSE(record.holds(instant(0), 2));
  EXPECT_FALSE(record.holds(instant(2), 1));
}

TEST(StepRecord, RestartsWithoutObservations) {
  StepRecord record(3, 4);
  record.insert(instant(1), 0);
  record.start({2, instant(2), instant(3), true});
  EXPECT_EQ(record.step.slot, 2);
  EXPECT_EQ(record.step.from, instant(2));
  EXPECT_EQ(record.step.to, instant(3));
  EXPECT_TRUE(record.step.is_first);
  EXPECT_EQ(record.observation_count, 0);
  EXPECT_FALSE(record.holds(instant(1), 0));
}

TEST(StepRecord, HasCapacityForASmallTeam) {
  if (!vantage::test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the allocation counter is inert under sanitizers";
  }
  const auto room_of = [](int targets, int looks) {
    const StepRecord record(targets, looks);
    std::size_t room = 0;
    for (const Observation& look : record.observations) {
      EXPECT_EQ(look.detections.capacity(), record.observations.front().detections.capacity());
      room += look.detections.capacity();
    }
    return room;
  };
  EXPECT_EQ(room_of(10, 8), 80U);
  EXPECT_EQ(room_of(64, 8), StepRecord::kDetectionsReserved);
  EXPECT_EQ(room_of(1000, 8), StepRecord::kDetectionsReserved) << "a large team reserves no more";
  EXPECT_EQ(room_of(5, 0), 0U);
  EXPECT_GE(StepRecord::kDetectionsReserved, 512U);
}

}  // namespace
}  // namespace vantage::estimator
