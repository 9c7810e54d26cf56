#include "logs/file/log_scan.hpp"

#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/logs/damage.hpp"

namespace vantage::logs {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<PlacedEvent> all_events(LogScan& scan) {
  std::vector<PlacedEvent> out;
  while (const auto event = scan.next()) {
    out.push_back(*event);
  }
  return out;
}

Bytes log_of(const std::vector<std::pair<std::int64_t, Bytes>>& events) {
  Bytes out;
  for (const auto& [number, data] : events) {
    append_event({number, from_utime(1'000'000 + number), "A", data}, out);
  }
  return out;
}

TEST(EventAt, ReadsWhatAppendEventWrote) {
  Bytes bytes{1, 2, 3};
  const Bytes data{9, 8, 7};
  append_event({41, from_utime(1'700'000'000'123'456), "VICON", data}, bytes);
  const auto event = event_at(bytes, 3);
  ASSERT_TRUE(event.has_value());
  EXPECT_EQ(event->number, 41);
  EXPECT_EQ(to_utime(event->time), 1'700'000'000'123'456);
  EXPECT_EQ(event->channel, "VICON");
  EXPECT_EQ(Bytes(event->data.begin(), event->data.end()), data);
  EXPECT_EQ(event->size_bytes(), bytes.size() - 3);
}

TEST(EventAt, RefusesWhatCannotBeTrue) {
  Bytes good;
  append_event({1, from_utime(1), "ABC", Bytes{5}}, good);
  ASSERT_TRUE(event_at(good, 0).has_value());
  const auto refuses = [&](std::size_t at, std::uint8_t value) {
    Bytes bad = good;
    bad[at] = value;
    return !event_at(bad, 0).has_value();
  };
  EXPECT_TRUE(refuses(3, 0x02)) << "sync word";
  EXPECT_TRUE(refuses(4, 0x80)) << "negative number";
  EXPECT_TRUE(refuses(12, 0xFF)) << "negative time";
  EXPECT_TRUE(refuses(23, 0)) << "no name";
  EXPECT_TRUE(refuses(23, 64)) << "name too long";
  EXPECT_TRUE(refuses(27, 2)) << "data beyond the end";
  EXPECT_TRUE(refuses(24, 0xFF)) << "data far beyond the end";
  EXPECT_TRUE(refuses(28, '\n')) << "control character in the name";
  EXPECT_FALSE(event_at(good, 1).has_value());
  EXPECT_FALSE(event_at(good, good.size()).has_value());
  EXPECT_FALSE(event_at(good, ~std::size_t{0}).has_value());
}

TEST(LogScan, ReadsAWholeLogWithTrapsInItsData) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::mt19937_64 rng(seed);
    const test::MadeLog log = test::random_log(rng, 60);
    LogScan scan(log.bytes);
    const auto events = all_events(scan);
    ASSERT_EQ(events.size(), 60U);
    for (std::size_t i = 0; i < events.size(); ++i) {
      EXPECT_EQ(events[i].offset, log.begins[i]);
      EXPECT_FALSE(events[i].is_doubtful);
    }
    EXPECT_EQ(scan.counts().bytes_damaged, 0U);
  }
}

TEST(LogScan, RecoversEveryIntactEventOfTwoThousandDamagedLogs) {
  std::int64_t intact = 0;
  std::int64_t besides = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    std::mt19937_64 rng(seed);
    const test::MadeLog log = test::random_log(rng, 40);
    const test::DamagedLog damaged = test::damage(log, rng);
    LogScan scan(damaged.bytes);
    std::set<std::size_t> found;
    std::size_t end = 0;
    std::uint64_t covered = 0;
    for (const PlacedEvent& event : all_events(scan)) {
      ASSERT_GE(event.offset, end) << "seed " << seed << ": events overlap";
      end = event.offset + event.size_bytes();
      covered += event.size_bytes();
      found.insert(event.offset);
      besides += damaged.intact.contains(event.offset) ? 0 : 1;
    }
    EXPECT_EQ(covered + scan.counts().bytes_damaged, damaged.bytes.size()) << "seed " << seed;
    for (const std::size_t offset : damaged.intact) {
      EXPECT_TRUE(found.contains(offset)) << "seed " << seed << ", event at byte " << offset;
    }
    intact += std::ssize(damaged.intact);
  }
  RecordProperty("intact", static_cast<int>(intact));
  RecordProperty("besides", static_cast<int>(besides));
  EXPECT_GT(intact, 60'000);
}

TEST(LogScan, EndsOnNoiseAndOnLogsCutAnywhere) {
  std::mt19937_64 rng(3);
  const test::MadeLog log = test::random_log(rng, 8);
  for (std::size_t size = 0; size <= log.bytes.size(); ++size) {
    LogScan scan(std::span(log.bytes).first(size));
    std::size_t whole = 0;
    while (whole + 1 < log.begins.size() && log.begins[whole + 1] <= size) {
      ++whole;
    }
    EXPECT_GE(all_events(scan).size(), whole) << size;
  }
  Bytes noise(100'000);
  for (std::uint8_t& byte : noise) {
    byte = static_cast<std::uint8_t>(rng());
  }
  LogScan scan(noise);
  EXPECT_TRUE(all_events(scan).empty());
  EXPECT_EQ(scan.counts().bytes_damaged, noise.size());
}

TEST(LogScan, NamesTheStretchesThatAreNoEvents) {
  const Bytes data(20, 7);
  Bytes bytes = log_of({{0, data}, {1, data}, {2, data}});
  const std::size_t size = bytes.size() / 3;
  bytes[size] ^= 1U;           // the second one's sync word
  bytes.resize(3 * size - 5);  // the third one's end
  LogScan scan(bytes);
  EXPECT_EQ(all_events(scan).size(), 1U);
  ASSERT_EQ(scan.stretches().size(), 1U);
  EXPECT_EQ(scan.stretches()[0].offset, size);
  EXPECT_EQ(scan.stretches()[0].size_bytes, 2 * size - 5);
  EXPECT_TRUE(scan.stretches()[0].is_tail);
}

TEST(LogScan, BelievesAWitnessAboutALength) {
  const Bytes data(50, 7);
  Bytes bytes = log_of({{0, data}, {1, data}, {2, data}});
  bytes[27] = 30;  // of the first one, shorter than it was
  LogScan plain(bytes);
  const auto without = all_events(plain);
  ASSERT_EQ(without.size(), 3U);
  EXPECT_TRUE(without[0].is_doubtful);
  LogScan witnessed(bytes, [](const LogEvent& event) {
    return event.data.size() == 50 ? Testimony::kWhole : Testimony::kDamaged;
  });
  EXPECT_EQ(all_events(witnessed).size(), 2U);
  EXPECT_EQ(witnessed.stretches().size(), 1U);
}

TEST(LogScan, KeepsLogsThatWerePutTogether) {
  const Bytes data(10, 7);
  Bytes bytes = log_of({{500, data}, {501, data}});
  const Bytes second = log_of({{0, data}, {1, data}, {7, data}});
  bytes.insert(bytes.end(), second.begin(), second.end());
  LogScan scan(bytes);
  EXPECT_EQ(all_events(scan).size(), 5U);
  EXPECT_EQ(scan.counts().bytes_damaged, 0U);
}

}  // namespace
}  // namespace vantage::logs
