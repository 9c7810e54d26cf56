#include "logs/file/log_scan.hpp"

#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/logs/damage.hpp"

namespace vantage::logs {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<LocatedEvent> all_events(LogScan& scan) {
  std::vector<LocatedEvent> out;
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

TEST(EventAt, InvertsAppendEvent) {
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

TEST(EventAt, RefusesInvalidEvents) {
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
  EXPECT_TRUE(refuses(28, 0)) << "NUL in the name";
  EXPECT_FALSE(event_at(good, 1).has_value());
  EXPECT_FALSE(event_at(good, good.size()).has_value());
  EXPECT_FALSE(event_at(good, ~std::size_t{0}).has_value());
}

// LCM allows any bytes in a channel name, but the scan accepts no control characters: overwritten
// bytes are rarely text.
TEST(EventAt, AcceptsNamesWithoutControlCharacters) {
  for (const char* name : {"A\tB", "A\nB", "\x1B[31mRED", "PLAN_\xFC", "PLAN_ü", "../../evil"}) {
    Bytes bytes;
    append_event({1, from_utime(1), name, Bytes{5}}, bytes);
    const auto event = event_at(bytes, 0);
    ASSERT_TRUE(event) << name;
    EXPECT_EQ(event->channel, name);
  }
  Bytes bytes;
  append_event({1, from_utime(1), "A\x01\xFC", Bytes{5}}, bytes);
  EXPECT_FALSE(event_at(bytes, 0));
}

TEST(LogScan, ReadsALogWithSyncWordsInItsData) {
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

/// Checks the scan of a damaged log: every intact event is found whole, each event starts at a real
/// header, events do not overlap, and every byte is counted. Returns the number of intact events.
std::int64_t expect_recovery(const test::DamagedLog& damaged, std::uint64_t seed) {
  LogScan scan(damaged.bytes);
  std::map<std::size_t, std::size_t> found;
  std::size_t end = 0;
  std::uint64_t covered = 0;
  for (const LocatedEvent& event : all_events(scan)) {
    EXPECT_GE(event.offset, end) << "seed " << seed << ": events overlap";
    EXPECT_TRUE(damaged.headers.contains(event.offset))
        << "seed " << seed << ": invented an event at byte " << event.offset;
    end = event.offset + event.size_bytes();
    covered += event.size_bytes();
    found.emplace(event.offset, event.size_bytes());
  }
  EXPECT_EQ(covered + scan.counts().bytes_damaged, damaged.bytes.size()) << "seed " << seed;
  for (const auto& [offset, size] : damaged.intact) {
    const auto event = found.find(offset);
    EXPECT_TRUE(event != found.end() && event->second == size)
        << "seed " << seed << ", event at byte " << offset;
  }
  return std::ssize(damaged.intact);
}

TEST(LogScan, RecoversExactlyTheIntactEventsOfDamagedLogs) {
  std::int64_t intact = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    std::mt19937_64 rng(seed);
    const test::MadeLog log = test::random_log(rng, 40);
    intact += expect_recovery(test::damage(log, rng), seed);
  }
  EXPECT_GT(intact, 60'000);
}

TEST(LogScan, RecoversEventsAroundPagesOfZeros) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    std::mt19937_64 rng(seed);
    const test::MadeLog log = test::random_log(rng, 1000);
    expect_recovery(test::damage(log, rng), seed);
  }
}

// These seeds give the most difficult of 17 000 damaged logs. Intact events next to damage contain
// pieces of logs. Near the ends of the log, events in such pieces outnumber the log's own events,
// or are the only events after the damage. In other logs a length in one piece ends by chance at a
// header in another.
TEST(LogScan, IgnoresLogsInsideDataNearDamage) {
  for (const unsigned seed :
       {4316U, 5998U, 6592U, 10045U, 11019U, 13965U, 14089U, 15142U, 15699U, 16847U}) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const test::MadeLog log = test::random_log(rng, 40);
    expect_recovery(test::damage(log, rng), seed);
  }
}

// Each header claims all following bytes and has an unrelated number. The check of what each header
// encloses must not take quadratic time (the test's time limit is the bound).
TEST(LogScan, TerminatesOnAFileOfHeadersOnly) {
  std::mt19937_64 rng(5);
  constexpr std::size_t kEvents = 100'000;
  constexpr std::size_t kSize = kEventHeaderBytes + 1;
  Bytes bytes;
  for (std::size_t i = 0; i < kEvents; ++i) {
    const auto number = static_cast<std::int64_t>(rng() >> 1U);
    append_event({number, from_utime(1), "A", {}}, bytes);
    const std::size_t length = (kEvents - 1 - i) * kSize - i % 2;
    for (std::size_t byte = 0; byte < 4 && i + 1 < kEvents; ++byte) {
      bytes[i * kSize + 24 + byte] = static_cast<std::uint8_t>(length >> (8 * (3 - byte)));
    }
  }
  LogScan scan(bytes);
  EXPECT_GE(all_events(scan).size(), 1U);
}

TEST(LogScan, TerminatesOnNoiseAndTruncatedLogs) {
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

TEST(LogScan, ReportsDamagedRanges) {
  const Bytes data(20, 7);
  Bytes bytes = log_of({{0, data}, {1, data}, {2, data}});
  const std::size_t size = bytes.size() / 3;
  bytes[size] ^= 1U;           // damages the second event's sync word
  bytes.resize(3 * size - 5);  // cuts off the third event's end
  LogScan scan(bytes);
  EXPECT_EQ(all_events(scan).size(), 1U);
  ASSERT_EQ(scan.stretches().size(), 1U);
  EXPECT_EQ(scan.stretches()[0].offset, size);
  EXPECT_EQ(scan.stretches()[0].size_bytes, 2 * size - 5);
  EXPECT_TRUE(scan.stretches()[0].is_tail);
}

TEST(LogScan, ConfirmsALengthByTheNextEvent) {
  const Bytes data(50, 7);
  Bytes bytes = log_of({{0, data}, {1, data}, {2, data}});
  bytes[27] = 30;  // first event's length, now too short
  LogScan plain(bytes);
  const auto without = all_events(plain);
  ASSERT_EQ(without.size(), 3U);
  EXPECT_TRUE(without[0].is_doubtful);
  LogScan witnessed(bytes, [](const LogEvent& event) {
    return event.data.size() == 50 ? DataCheck::kComplete : DataCheck::kDamaged;
  });
  EXPECT_EQ(all_events(witnessed).size(), 2U);
  EXPECT_EQ(witnessed.stretches().size(), 1U);
}

TEST(LogScan, ReadsConcatenatedLogs) {
  const Bytes data(10, 7);
  Bytes bytes = log_of({{500, data}, {501, data}});
  const Bytes second = log_of({{0, data}, {1, data}, {7, data}});
  bytes.insert(bytes.end(), second.begin(), second.end());
  LogScan scan(bytes);
  EXPECT_EQ(all_events(scan).size(), 5U);
  EXPECT_EQ(scan.counts().bytes_damaged, 0U);
}

// Single events with foreign numbers do not change the number range of the log. A log inside the
// data of such an event is found by the log's own numbers, even at the end of the file.
TEST(LogScan, KeepsItsNumberingDespiteScatteredForeignEvents) {
  const Bytes data(10, 7);
  for (const int strangers : {1, 63, 64, 65, 128, 200}) {
    std::vector<std::pair<std::int64_t, Bytes>> events;
    std::int64_t number = 0;
    std::int64_t strange = 0;
    for (int i = 0; i < 20; ++i) {
      events.emplace_back(number++, data);
    }
    for (int i = 0; i < strangers; ++i) {
      events.emplace_back(number++, data);
      events.emplace_back(strange = 1'000'000'000 + 1'000'000 * i, data);
    }
    // An event with a foreign number has a wrong length, which spans two of the log's own events.
    Bytes bytes = log_of(events);
    append_event({strange + 1, from_utime(1), "A", log_of({{number, data}, {number + 1, data}})},
                 bytes);
    LogScan scan(bytes);
    const auto found = all_events(scan);
    ASSERT_EQ(found.size(), events.size() + 2) << strangers;
    EXPECT_EQ(found[events.size()].number, number) << strangers;
    EXPECT_EQ(found[events.size() + 1].number, number + 1) << strangers;
  }
}

// After 64 consecutive events with foreign numbers, these numbers belong to the log, which may have
// been merged from several logs. Further such sequences are accepted in the same way.
TEST(LogScan, AcceptsSixtyFourConsecutiveForeignEvents) {
  const Bytes data(10, 7);
  std::vector<std::pair<std::int64_t, Bytes>> events;
  std::int64_t number = 0;
  for (int part = 0; part < 3; ++part) {
    number = 1'000'000'000LL * (part + 1);
    for (int i = 0; i < 100; ++i) {
      events.emplace_back(number++, data);
    }
    Bytes bytes = log_of(events);
    append_event({7, from_utime(1), "A", log_of({{number, data}, {number + 1, data}})}, bytes);
    LogScan scan(bytes);
    const auto found = all_events(scan);
    ASSERT_EQ(found.size(), events.size() + 2) << part;
    EXPECT_EQ(found.back().number, number + 1) << part;
  }
}

// Every damaged stretch is counted; the first thousand are listed.
TEST(LogScan, CountsDamagedRangesAndDoubtfulEvents) {
  Bytes bytes;
  std::size_t damaged = 0;
  for (std::int64_t i = 0; i < 1'203; ++i) {
    append_event({i, from_utime(i), "A", Bytes(3, 7)}, bytes);
    if (i <= 1'200) {  // bytes that belong to no event
      bytes.insert(bytes.end(), static_cast<std::size_t>(1 + i % 3), std::uint8_t{0});
      damaged += static_cast<std::size_t>(1 + i % 3);
    }
  }
  LogScan scan(bytes);
  EXPECT_EQ(all_events(scan).size(), 1'203U);
  EXPECT_EQ(scan.counts().events, 1'203);
  EXPECT_EQ(scan.counts().doubtful, 1'201) << "no intact event follows";
  EXPECT_EQ(scan.counts().refused, 0);
  EXPECT_EQ(scan.counts().stretches, 1'201);
  EXPECT_EQ(scan.counts().bytes_damaged, damaged);
  ASSERT_EQ(scan.stretches().size(), 1'000U);
  for (std::size_t i = 0; i < 1'000; ++i) {
    EXPECT_EQ(scan.stretches()[i].size_bytes, 1 + i % 3);
    EXPECT_FALSE(scan.stretches()[i].is_tail);
  }
  EXPECT_EQ(scan.stretches()[1].offset, 2 * (kEventHeaderBytes + 4) + 1);
  EXPECT_EQ(scan.position(), bytes.size());
  EXPECT_FALSE(scan.next()) << "nothing else is counted";
  EXPECT_EQ(scan.counts().stretches, 1'201);
}

// Event numbers at most ten thousand apart, in either direction, belong to the same log.
TEST(LogScan, AcceptsAnInnerHeaderByItsNumber) {
  constexpr std::int64_t kNumber = 50'000;
  for (const std::int64_t apart : {-10'001, -10'000, -1, 1, 10'000, 10'001}) {
    Bytes inner;
    append_event({kNumber + apart, from_utime(1), "A", Bytes(3, 7)}, inner);
    Bytes bytes = log_of({{kNumber, inner}, {kNumber + 5, Bytes(3, 7)}});
    LogScan scan(bytes);
    const auto events = all_events(scan);
    ASSERT_EQ(events.size(), 2U);
    const bool is_near = std::abs(apart) <= 10'000;
    EXPECT_EQ(events[0].number, is_near ? kNumber + apart : kNumber) << apart;
    EXPECT_EQ(scan.counts().refused, is_near ? 1 : 0) << apart;
    EXPECT_EQ(scan.counts().bytes_damaged, is_near ? kEventHeaderBytes + 1 : 0U) << apart;
  }
}

// An event with a number between those of its neighbours is whole, even if it contains a piece of
// this log. Otherwise it would be treated as damage.
TEST(LogScan, KeepsIntactEventsWithAnyContent) {
  const Bytes data(3, 7);
  for (const std::int64_t inside : {1, 6, 7, 100}) {
    const Bytes piece = log_of({{inside, data}, {inside + 1, data}});
    for (const bool is_first : {false, true}) {
      std::vector<std::pair<std::int64_t, Bytes>> events{{5, piece}, {6, piece}, {7, data}};
      if (!is_first) {
        events.insert(events.begin(), {4, data});
      }
      const Bytes bytes = log_of(events);
      LogScan scan(bytes);
      const auto found = all_events(scan);
      ASSERT_EQ(found.size(), events.size()) << inside;
      for (std::size_t i = 0; i < events.size(); ++i) {
        EXPECT_EQ(found[i].number, events[i].first) << inside;
        EXPECT_FALSE(found[i].is_doubtful);
      }
      EXPECT_EQ(scan.counts().refused, 0) << inside;
      EXPECT_EQ(scan.counts().bytes_damaged, 0U) << inside;
    }
    const Bytes skipped = log_of({{4, data}, {6, piece}, {7, data}});
    LogScan scan(skipped);
    all_events(scan);
    EXPECT_EQ(scan.counts().refused, 1) << inside;
  }
}

// A scan that starts in the middle of a log counts skipped bytes from its start.
TEST(LogScan, CountsSkippedBytesFromItsStart) {
  const Bytes bytes = log_of({{0, Bytes(5, 7)}, {1, Bytes(5, 7)}, {2, Bytes(5, 7)}});
  const std::size_t size = bytes.size() / 3;
  LogScan scan(bytes, {}, size - 2);
  EXPECT_EQ(scan.position(), size - 2);
  const auto events = all_events(scan);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].offset, size);
  EXPECT_EQ(scan.counts().bytes_damaged, 2U);
  EXPECT_EQ(scan.counts().events, 2);
  LogScan beyond(bytes, {}, bytes.size());
  EXPECT_FALSE(beyond.next());
  EXPECT_EQ(beyond.counts().stretches, 0);
}

}  // namespace
}  // namespace vantage::logs
