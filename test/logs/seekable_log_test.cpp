#include "logs/file/seekable_log.hpp"

#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "logs/file/wire_check.hpp"
#include "test/logs/damage.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;
using test::TemporaryFolder;

constexpr std::size_t kMib = std::size_t{1} << 20U;

/// Returns a log in which event i is at 1000 i µs, on channel RARE or OFTEN; `order` is the order
/// of events in the file.
Bytes log_of(const std::vector<std::int64_t>& order) {
  Bytes out;
  for (const std::int64_t i : order) {
    const Bytes data(static_cast<std::size_t>(i % 7), static_cast<std::uint8_t>(i));
    append_event({i, from_utime(1000 * i), i % 3 == 0 ? "RARE" : "OFTEN", data}, out);
  }
  return out;
}

std::vector<std::int64_t> first_numbers(std::size_t count) {
  std::vector<std::int64_t> numbers(count);
  for (std::size_t i = 0; i < count; ++i) {
    numbers[i] = static_cast<std::int64_t>(i);
  }
  return numbers;
}

/// Returns the offsets of the events, for comparison.
std::vector<std::size_t> offsets_of(const std::vector<LocatedEvent>& events) {
  std::vector<std::size_t> offsets;
  for (const LocatedEvent& event : events) {
    offsets.push_back(event.offset);
  }
  return offsets;
}

/// Returns all events of a log sorted by time, as found by one pass over the whole log.
std::vector<LocatedEvent> sorted_events(std::span<const std::uint8_t> bytes) {
  std::vector<LocatedEvent> all;
  LogScan scan(bytes, check_wire_data);
  while (const auto event = scan.next()) {
    all.push_back(*event);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const LocatedEvent& a, const LocatedEvent& b) { return a.time < b.time; });
  return all;
}

std::vector<LocatedEvent> between(const std::vector<LocatedEvent>& sorted, Time from, Time to) {
  std::vector<LocatedEvent> out;
  std::copy_if(sorted.begin(), sorted.end(), std::back_inserter(out),
               [&](const LocatedEvent& each) { return each.time >= from && each.time < to; });
  return out;
}

std::vector<std::size_t> newest(const std::vector<LocatedEvent>& sorted, Time time) {
  std::map<std::string_view, std::size_t> of_channel;
  for (std::size_t i = 0; i < sorted.size() && sorted[i].time < time; ++i) {
    of_channel[sorted[i].channel] = i;
  }
  std::vector<std::size_t> indices;
  for (const auto& [channel, index] : of_channel) {
    indices.push_back(index);
  }
  std::sort(indices.begin(), indices.end());
  for (std::size_t& index : indices) {
    index = sorted[index].offset;
  }
  return indices;
}

/// Checks at `count` random times that each query of a log gives the result of a complete pass.
void expect_as_in_one_pass(const SeekableLog& log, int count) {
  const std::vector<LocatedEvent> sorted = sorted_events(log.bytes());
  std::mt19937_64 rng(11);
  const auto [first, last] = log.range();
  EXPECT_EQ(first, sorted.front().time);
  EXPECT_EQ(last, sorted.back().time);
  std::uniform_int_distribution<std::int64_t> any_us(-2, (last - first).count() + 2);
  for (int i = 0; i < count; ++i) {
    const Time from = first + Duration{any_us(rng)};
    const Time to = from + Duration{any_us(rng) / 20};
    const auto expected = between(sorted, from, to);
    ASSERT_EQ(offsets_of(log.events(from, to)), offsets_of(expected)) << to_utime(from);
    ASSERT_EQ(offsets_of(log.newest_before(from)), newest(sorted, from)) << to_utime(from);
    const auto next = std::find_if(sorted.begin(), sorted.end(),
                                   [&](const LocatedEvent& each) { return each.time >= from; });
    ASSERT_EQ(log.next_time(from), next == sorted.end() ? std::nullopt : std::optional(next->time));
  }
}

/// Appends `seconds` seconds of events of about 1 kB, one per ms from `start_us` on. RARE gets one
/// per second, ONCE only the event with number 0.
void append_second(std::int64_t start_us, int seconds, std::int64_t& number, Bytes& out) {
  std::mt19937_64 rng(static_cast<std::uint64_t>(number) + 1);
  Bytes data(1000);
  for (int i = 0; i < 1000 * seconds; ++i) {
    std::generate(data.begin(), data.end(), [&] { return static_cast<std::uint8_t>(rng()); });
    const char* channel = number == 0 ? "ONCE" : i % 1000 == 0 ? "RARE" : "OFTEN";
    append_event({number++, from_utime(start_us + 1000 * i), channel, data}, out);
  }
}

TEST(SeekableLog, FindsEveryEventByTimeInAnyOrder) {
  std::vector<std::int64_t> order = first_numbers(100);
  std::mt19937 rng(5);
  for (std::size_t i = 0; i + 5 <= order.size(); i += 5) {  // groups of 5 in random order
    std::shuffle(order.begin() + std::ptrdiff_t(i), order.begin() + std::ptrdiff_t(i) + 5, rng);
  }
  const TemporaryFolder folder;
  test::write_file(folder.file("a.lcmlog"), log_of(order));
  const SeekableLog log(folder.file("a.lcmlog"));
  EXPECT_TRUE(log.is_surveyed());
  const auto all = log.events(from_utime(0), from_utime(100'000));
  ASSERT_EQ(all.size(), 100U);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].time, from_utime(static_cast<std::int64_t>(1000 * i)));
    EXPECT_EQ(all[i].number, static_cast<std::int64_t>(i));
    EXPECT_EQ(all[i].channel, i % 3 == 0 ? "RARE" : "OFTEN");
    EXPECT_EQ(Bytes(all[i].data.begin(), all[i].data.end()), Bytes(i % 7, std::uint8_t(i)));
  }
  EXPECT_EQ(log.range(), std::pair(from_utime(0), from_utime(99'000)));
  const auto newest = log.newest_before(from_utime(50'000));
  ASSERT_EQ(newest.size(), 2U);
  EXPECT_EQ(newest[0].number, 48);
  EXPECT_EQ(newest[1].number, 49);
  EXPECT_TRUE(log.newest_before(from_utime(0)).empty());
  EXPECT_EQ(log.next_time(from_utime(1'000'000'000)), std::nullopt);
  expect_as_in_one_pass(log, 100);
}

TEST(SeekableLog, OrdersOverlappingBlocksByTime) {
  Bytes bytes;
  std::int64_t number = 0;
  append_second(5'000'000, 2, number, bytes);
  append_second(2'000'500, 2, number, bytes);  // the clock was set back
  append_second(3'000'250, 1, number, bytes);
  append_event({number++, from_utime(1), "OFTEN", Bytes(9, 1)}, bytes);  // a broken stamp
  append_second(9'000'000, 1, number, bytes);
  const TemporaryFolder folder;
  test::write_file(folder.file("a.lcmlog"), bytes);
  const SeekableLog log(folder.file("a.lcmlog"));
  ASSERT_GT(log.survey().blocks.size(), 20U);
  expect_as_in_one_pass(log, 200);
}

TEST(SeekableLog, ContainsTheIntactEventsOfADamagedLog) {
  Bytes bytes = log_of(first_numbers(100));
  bytes.resize(bytes.size() - 3);
  std::fill_n(bytes.begin(), 7, std::uint8_t{0x55});
  const TemporaryFolder folder;
  test::write_file(folder.file("a.lcmlog"), bytes);
  const SeekableLog log(folder.file("a.lcmlog"));
  const auto all = log.events(from_utime(0), from_utime(1'000'000));
  EXPECT_EQ(all.size(), 98U);
  EXPECT_EQ(all.front().number, 1);
  EXPECT_GT(log.survey().scan.bytes_damaged, 0U);
}

TEST(SeekableLog, FindsTheSameEventsOfDamagedLogsAsOnePass) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    std::mt19937_64 rng(seed);
    Bytes bytes;
    std::int64_t number = 0;
    while (bytes.size() < 2 * kMib) {  // damaged and whole events
      const auto harmed = test::damage(test::random_log(rng, 40), rng);
      bytes.insert(bytes.end(), harmed.bytes.begin(), harmed.bytes.end());
      append_second(1'000'000 + 1000 * number, 1, number, bytes);
    }
    const TemporaryFolder folder;
    test::write_file(folder.file("a.lcmlog"), bytes);
    const SeekableLog log(folder.file("a.lcmlog"));
    ASSERT_TRUE(log.is_surveyed());
    ASSERT_EQ(offsets_of(log.events(Time::min(), Time::max())),
              offsets_of(sorted_events(log.bytes())))
        << "seed " << seed;
  }
}

TEST(SeekableLog, RefusesOtherFiles) {
  const TemporaryFolder folder;
  test::write_file(folder.file("a.txt"), Bytes(200, 'x'));
  EXPECT_THROW(SeekableLog{folder.file("a.txt")}, StartupError);
}

/// A log of 30 s and 30 MB, longer than the part that is read when it is opened.
class LongLog : public ::testing::Test {
 protected:
  static constexpr std::int64_t kStart_us = 1'000'000'000;
  static constexpr int kLength_s = 30;

  LongLog() {
    std::int64_t number = 0;
    append_second(kStart_us, kLength_s, number, bytes_);
  }
  std::string write() const {
    test::write_file(folder_.file("long.lcmlog"), bytes_);
    return folder_.file("long.lcmlog");
  }

  Bytes bytes_;

 private:
  TemporaryFolder folder_;
};

TEST_F(LongLog, IsUsableDuringItsFirstPass) {
  SeekableLog log(write());
  EXPECT_FALSE(log.is_surveyed());
  EXPECT_LT(log.surveyed_share(), 0.5);
  const auto sorted = sorted_events(log.bytes());
  EXPECT_EQ(log.range(), std::pair(sorted.front().time, sorted.back().time));
  // With ascending times, bisection finds the exact events.
  for (const int at_ms : {0, 1, 999, 8000, 9500, 20'000, 29'990, 31'000}) {
    const Time from = from_utime(kStart_us + 1000 * at_ms + 500);
    const Time to = from + std::chrono::milliseconds(300);
    EXPECT_EQ(offsets_of(log.events(from, to)), offsets_of(between(sorted, from, to))) << at_ms;
    const auto next = between(sorted, from, sorted.back().time + Duration{1});
    EXPECT_EQ(log.next_time(from), next.empty() ? std::nullopt : std::optional(next.front().time));
  }
  // The newest message of each channel is found, even ONCE at the start of the log.
  const Time late = from_utime(kStart_us + 20'500'000);
  EXPECT_EQ(offsets_of(log.newest_before(late)), newest(sorted, late));
  // At the end of the pass the index is complete, and the next opening of the log uses it.
  double share = log.surveyed_share();
  while (log.advance(kMib)) {
    EXPECT_GT(log.surveyed_share(), share);
    share = log.surveyed_share();
    EXPECT_EQ(log.range(), std::pair(sorted.front().time, sorted.back().time))
        << "valid during the first pass";
    ASSERT_EQ(offsets_of(log.newest_before(late)), newest(sorted, late)) << share;
  }
  EXPECT_TRUE(log.is_surveyed());
  EXPECT_FALSE(log.advance(kMib));
  expect_as_in_one_pass(log, 50);
  const SeekableLog again(log.path());
  EXPECT_TRUE(again.is_surveyed());
  expect_as_in_one_pass(again, 50);
}

TEST_F(LongLog, FindsItsEndDespiteForeignBytesAndATruncatedEvent) {
  bytes_.resize(bytes_.size() - 7);
  bytes_.insert(bytes_.end(), 300'000, std::uint8_t{0xED});
  SeekableLog log(write());
  EXPECT_FALSE(log.is_surveyed());
  const auto sorted = sorted_events(log.bytes());
  EXPECT_EQ(log.range().second, sorted.back().time);
}

TEST_F(LongLog, DetectsDecreasingTimesAfterItsFirstPass) {
  std::int64_t number = 1000 * kLength_s;
  append_second(kStart_us - 5'000'000, 1, number, bytes_);
  SeekableLog log(write());
  EXPECT_EQ(log.range().first, from_utime(kStart_us)) << "only the part that was read";
  while (log.advance(kMib)) {
  }
  EXPECT_EQ(log.range().first, from_utime(kStart_us - 5'000'000));
  expect_as_in_one_pass(log, 50);
}

TEST_F(LongLog, OpensAndSeeksWithFewReads) {
  const std::string path = write();
  const Time far = from_utime(kStart_us + 23'000'000);
  const auto bytes_of_seek = [&](const SeekableLog& log) {
    const std::size_t before = log.bytes_read();
    EXPECT_EQ(log.events(far, far + std::chrono::milliseconds(100)).size(), 100U);
    EXPECT_EQ(log.newest_before(far).size(), 3U);
    return log.bytes_read() - before;
  };
  {
    SeekableLog log(path);
    EXPECT_LT(log.bytes_read(), 8 * kMib + kMib / 8) << "its start and its end";
    EXPECT_LT(bytes_of_seek(log), 5 * kMib / 2) << "1 MiB back, a few positions and a few blocks";
    while (log.advance(kMib)) {
    }
    EXPECT_GT(log.bytes_read(), 30'000'000U);
  }
  const SeekableLog log(path);
  EXPECT_EQ(log.bytes_read(), 0U) << "known from the index";
  EXPECT_LT(bytes_of_seek(log), 3 * kMib / 2) << "a few blocks";
}

// Progress is measured in complete blocks, and the amount read in bytes.
TEST_F(LongLog, ReportsProgressAndCounts) {
  SeekableLog log(write());
  const auto size = static_cast<double>(log.bytes().size());
  const auto bytes_surveyed = [&] { return log.surveyed_share() * size; };
  EXPECT_LE(bytes_surveyed(), 8.0 * kMib);
  EXPECT_GT(bytes_surveyed(), 8.0 * kMib - 0.3 * kMib);
  EXPECT_GE(log.bytes_read(), 8 * kMib + 60 * 1024) << "including its end";
  EXPECT_LT(log.bytes_read(), 8 * kMib + 70 * 1024);
  std::size_t read = log.bytes_read();
  for (int i = 9; log.advance(kMib); ++i) {
    EXPECT_LE(bytes_surveyed(), i * (1.0 * kMib) + 30.0 * 1'100.0);
    EXPECT_GT(bytes_surveyed(), (i - 0.3) * kMib);
    EXPECT_NEAR(static_cast<double>(log.bytes_read() - read), 1.0 * kMib, 2'200.0);
    read = log.bytes_read();
  }
  EXPECT_EQ(log.surveyed_share(), 1.0);
  // A block that was read is not read again until 32 other blocks have been read.
  const Time early = from_utime(kStart_us);
  const auto read_for = [&](Time from) {
    const std::size_t before = log.bytes_read();
    static_cast<void>(log.events(from, from + Duration{1}));
    return log.bytes_read() - before;
  };
  EXPECT_GT(read_for(early), 200'000U);
  EXPECT_EQ(read_for(early), 0U);
  for (int block = 1; block <= 31; ++block) {
    EXPECT_GT(read_for(early + std::chrono::milliseconds(290 * block)), 200'000U) << block;
  }
  EXPECT_EQ(read_for(early), 0U);
  EXPECT_GT(read_for(early + std::chrono::milliseconds(290 * 32)), 200'000U);
  EXPECT_EQ(read_for(early), 0U) << "the block is still cached";
  EXPECT_GT(read_for(early + std::chrono::milliseconds(290)), 200'000U)
      << "this block is not cached";
}

TEST(SeekableLog, SkipsToTheNextEvent) {
  Bytes bytes(9 * kMib, 0);
  const Bytes events = log_of(first_numbers(10));
  bytes.insert(bytes.end(), events.begin(), events.end());
  bytes.insert(bytes.end(), 9 * kMib, 0);
  const TemporaryFolder folder;
  test::write_file(folder.file("a.lcmlog"), bytes);
  const SeekableLog log(folder.file("a.lcmlog"));
  // Reads 9 MiB up to the first event, then the last 1/16, 1/4, 1 and 4 MiB without an event, then
  // the last 16 MiB: 7 MiB up to the events and 9 MiB after them.
  constexpr std::size_t kInVain = kMib / 16 + kMib / 4 + kMib + 4 * kMib;
  EXPECT_NEAR(static_cast<double>(log.bytes_read()),
              static_cast<double>(9 * kMib + kInVain + 7 * kMib + 9 * kMib), 1'000.0);
  EXPECT_EQ(log.range(), std::pair(from_utime(0), from_utime(9'000)));
  EXPECT_EQ(log.events(from_utime(0), from_utime(10'000)).size(), 10U);
}

TEST(SeekableLog, ReportsALogWithoutEvents) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.txt");
  test::write_file(path, Bytes(200, 'x'));
  try {
    const SeekableLog log(path);
    FAIL() << "a log without events was accepted";
  } catch (const StartupError& error) {
    EXPECT_EQ(error.what(), path + ": contains no events; run `vantage log check` for details");
  }
}

}  // namespace
}  // namespace vantage::logs
