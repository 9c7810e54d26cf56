#include "core/processor_wait.hpp"

#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace vantage {
namespace {

Time at(double t_s) { return from_utime(1'700'000'000'000'000) + from_seconds(t_s); }

struct Row {
  const char* what;
  std::vector<std::pair<double, std::int64_t>> readings;  ///< time in s; total wait in µs
  double recent_s;
};

TEST(ProcessorWait, IsTheSumOfTheLastSecond) {
  for (const Row& row : std::vector<Row>{
           {"nothing read", {}, 0.0},
           {"one reading, of a thread that has waited for long", {{0.0, 9'000'000}}, 0.0},
           {"two readings", {{0.0, 5'000}, {0.05, 25'000}}, 0.02},
           {"no wait", {{0.0, 5'000}, {0.5, 5'000}, {1.0, 5'000}}, 0.0},
           {"a wait at the beginning of the second",
            {{0.0, 0}, {0.1, 80'000}, {1.0, 80'000}},
            0.08},
           {"a wait before the second", {{0.0, 0}, {0.1, 80'000}, {1.1, 80'000}}, 0.0},
           {"a wait in each part of it",
            {{0.0, 0}, {0.5, 100'000}, {1.0, 200'000}, {1.5, 300'000}, {2.0, 400'000}},
            0.2},
           {"a gap in the readings", {{0.0, 0}, {3.0, 2'500'000}}, 2.5},
           {"after the gap", {{0.0, 0}, {3.0, 2'500'000}, {4.0, 2'500'000}}, 0.0},
           {"a counter that falls is another one",
            {{0.0, 700'000}, {0.5, 100}, {0.6, 10'100}},
            0.01},
           {"a time that does not rise", {{0.0, 0}, {0.0, 700'000}, {0.1, 705'000}}, 0.005},
       }) {
    ProcessorWait wait;
    for (const auto& [t_s, waited_us] : row.readings) {
      wait.add(at(t_s), waited_us);
    }
    EXPECT_NEAR(wait.recent_s(), row.recent_s, 1e-12) << row.what;
  }
}

// At any reading rate, the result is the wait since the newest reading that is at least one second
// old. It includes all waits of the last second and none from before that reading.
TEST(ProcessorWait, CoversTheWindowAtAnyReadingRate) {
  std::mt19937_64 rng(7);
  std::uniform_int_distribution<int> step_ms(31, 900);
  std::uniform_int_distribution<int> waits_us(0, 20'000);
  ProcessorWait wait;
  std::vector<std::pair<double, std::int64_t>> readings;
  double t_s = 0.0;
  std::int64_t sum_us = 0;
  for (int i = 0; i < 2'000; ++i) {
    wait.add(at(t_s), sum_us);
    readings.emplace_back(t_s, sum_us);
    std::int64_t from_us = readings.front().second;
    for (const auto& [time_s, waited_us] : readings) {
      from_us = t_s - time_s >= 1.0 ? waited_us : from_us;
    }
    EXPECT_NEAR(wait.recent_s(), 1e-6 * static_cast<double>(sum_us - from_us), 1e-12) << i;
    t_s += 1e-3 * step_ms(rng);
    sum_us += waits_us(rng);
  }
}

// With more readings per second than the capacity, the result covers less than a second, and the
// memory stays bounded.
TEST(ProcessorWait, KeepsTheNewestReadings) {
  ProcessorWait wait;
  for (int i = 0; i < 1'000; ++i) {
    wait.add(at(0.001 * i), 1'000 * i);
  }
  EXPECT_NEAR(wait.recent_s(), 0.031, 1e-12);
}

}  // namespace
}  // namespace vantage
