#include "logs/file/log_index.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "bus/convert/convert.hpp"
#include "core/check.hpp"
#include "logs/file/seekable_log.hpp"
#include "logs/file/wire_check.hpp"
#include "test/logs/damage.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;
using test::TemporaryFolder;

/// Returns a log with events of 500 kB, so that it has several blocks. Times decrease a little now
/// and then.
Bytes large_log() {
  std::mt19937_64 rng(11);
  Bytes out;
  for (std::int64_t i = 0; i < 40; ++i) {
    const Bytes data(500'000, static_cast<std::uint8_t>(i));
    const std::int64_t utime = 1'000'000 + 10'000 * i - (i % 7 == 3 ? 15'000 : 0);
    append_event({i, from_utime(utime), i % 2 == 0 ? "EVEN" : "ODD", data}, out);
  }
  return out;
}

std::size_t seek_by_reading(std::span<const std::uint8_t> log, Time time) {
  LogScan scan(log);
  while (const auto event = scan.next()) {
    if (event->time >= time) {
      return event->offset;
    }
  }
  return log.size();
}

TEST(SeekOffset, EqualsASequentialRead) {
  const Bytes log = large_log();
  const LogSurvey survey = survey_log(log);
  EXPECT_GT(survey.blocks.size(), 5U);
  for (std::int64_t utime = 980'000; utime < 1'420'000; utime += 1'250) {
    EXPECT_EQ(seek_offset(log, survey, from_utime(utime)), seek_by_reading(log, from_utime(utime)))
        << utime;
  }
}

TEST(SurveyLog, CountsEventsAndBytes) {
  const Bytes log = large_log();
  const LogSurvey survey = survey_log(log);
  EXPECT_TRUE(survey.is_whole());
  EXPECT_EQ(survey.scan.events, 40);
  EXPECT_EQ(survey.channels.at("EVEN").events, 20);
  EXPECT_EQ(survey.channels.at("ODD").data_bytes, 10'000'000U);
  EXPECT_EQ(survey.times_backward, 6);
  EXPECT_EQ(survey.numbers_missing, 0);
  EXPECT_EQ(to_utime(survey.first), 1'000'000);
  EXPECT_EQ(to_utime(survey.last), 1'390'000);
  EXPECT_FALSE(survey.begins_with_scenario);
}

TEST(SurveyLog, FindsLostMessagesGapsAndOtherTypes) {
  Bytes log;
  std::int64_t number = 0;
  const auto attack = [&](std::int64_t utime, std::int64_t sequence) {
    vantage_lcm::attack_t wire{};
    wire.utime = utime;
    wire.run_id = 5;
    wire.sequence = sequence;
    test::append_message(wire, number++, utime, "ATTACK", log);
  };
  attack(1'000'000, 0);
  attack(1'500'000, 1);
  attack(4'000'000, 4);
  number += 2;
  append_event({number, from_utime(4'100'000), "ATTACK", Bytes{1, 2, 3}}, log);
  const LogSurvey survey = survey_log(log);
  const ChannelSurvey& channel = survey.channels.at("ATTACK");
  EXPECT_EQ(channel.type, "attack_t");
  EXPECT_EQ(channel.messages_lost, 2);
  EXPECT_EQ(channel.other_types, 1);
  EXPECT_EQ(channel.gap_max, Duration{2'500'000});
  EXPECT_EQ(to_utime(channel.gap_at), 1'500'000);
  EXPECT_EQ(survey.numbers_missing, 2);
}

TEST(SurveyLog, TreatsAnUndecodableMessageAsDamage) {
  vantage_lcm::attack_t wire{};
  wire.num_jammed = 1;
  wire.jammed = {"Q1"};
  Bytes log;
  for (std::int64_t i = 0; i < 3; ++i) {
    test::append_message(wire, i, 1'000 + i, "ATTACK", log);
  }
  const std::size_t size = log.size() / 3;
  const std::size_t name_length = size + size - 3 - 1;  // length of "Q1" in the second event
  log[name_length] = 200;
  const LogSurvey survey = survey_log(log);
  EXPECT_EQ(survey.scan.events, 2);
  EXPECT_EQ(survey.scan.bytes_damaged, size);
}

TEST(IndexedLog, StoresItsSurveyNextToTheLog) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  std::mt19937_64 rng(5);
  const test::DamagedLog damaged = test::damage(test::random_log(rng, 500), rng);
  test::write_file(path, damaged.bytes);
  const IndexedLog first(path);
  EXPECT_FALSE(first.was_indexed());
  const IndexedLog second(path);
  EXPECT_TRUE(second.was_indexed());
  EXPECT_EQ(second.survey().scan.events, first.survey().scan.events);
  EXPECT_EQ(second.survey().scan.bytes_damaged, first.survey().scan.bytes_damaged);
  EXPECT_EQ(second.survey().stretches.size(), first.survey().stretches.size());
  ASSERT_EQ(second.survey().channels.size(), first.survey().channels.size());
  for (const auto& [name, channel] : first.survey().channels) {
    const ChannelSurvey& again = second.survey().channels.at(name);
    EXPECT_EQ(again.events, channel.events);
    EXPECT_EQ(again.gap_max, channel.gap_max);
    EXPECT_EQ(again.last, channel.last);
  }
  ASSERT_EQ(second.survey().blocks.size(), first.survey().blocks.size());
  EXPECT_EQ(second.survey().blocks.back().offset, first.survey().blocks.back().offset);
  EXPECT_EQ(second.survey().first, first.survey().first);
  EXPECT_EQ(second.survey().backward_max, first.survey().backward_max);
}

TEST(IndexedLog, RefusesTheIndexOfAnotherLog) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  Bytes log = large_log();
  test::write_file(path, log);
  EXPECT_EQ(IndexedLog(path).survey().scan.events, 40);
  const auto changed = std::filesystem::last_write_time(path);
  log.resize(log.size() / 2);
  test::write_file(path, log);  // half the log, with a valid size
  std::filesystem::last_write_time(path, changed);
  EXPECT_FALSE(IndexedLog(path).was_indexed());
  log[40] ^= 1U;  // same size and time, other bytes
  test::write_file(path, log);
  std::filesystem::last_write_time(path, changed);
  EXPECT_FALSE(IndexedLog(path).was_indexed());
}

TEST(IndexedLog, RefusesADamagedIndex) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  std::mt19937_64 rng(5);
  test::write_file(path, test::random_log(rng, 50).bytes);
  static_cast<void>(IndexedLog(path));
  const Bytes index = test::read_file(path + ".index");
  ASSERT_FALSE(index.empty());
  for (int i = 0; i < 300; ++i) {
    Bytes bad = index;
    bad[rng() % bad.size()] ^= static_cast<std::uint8_t>(1U << (rng() % 8));
    bad.resize(i % 3 == 0 ? rng() % bad.size() : bad.size());
    test::write_file(path + ".index", bad);
    const MappedFile file(path);
    EXPECT_FALSE(load_index(path, file.bytes()).has_value());
  }
}

TEST(IndexedLog, OpensAnEmptyLogAndRefusesOtherFiles) {
  const TemporaryFolder folder;
  test::write_file(folder.file("empty"), {});
  const IndexedLog empty(folder.file("empty"));
  EXPECT_EQ(empty.survey().scan.events, 0);
  LogScan scan = empty.scan_from(from_utime(5));
  EXPECT_FALSE(scan.next().has_value());
  EXPECT_THROW(IndexedLog(folder.file("missing")), StartupError);
  EXPECT_THROW(IndexedLog(folder.path()), StartupError);
}

/// Returns a log with many features: a scenario first, vantage messages of which some are missing,
/// data of other types, times that decrease, event numbers that skip and restart, and damage.
Bytes eventful_log() {
  std::mt19937_64 rng(3);
  Bytes out;
  test::append_message(vantage_lcm::scenario_t{}, 7, 5'000'000, "SCENARIO", out);
  std::int64_t number = 8;
  std::int64_t utime = 5'000'000;
  std::vector<std::size_t> begins;
  for (std::int64_t i = 0; i < 400; ++i) {
    begins.push_back(out.size());
    utime += i % 40 == 20 ? -25'000 - 100 * i : 1'000 * (1 + i % 7);
    vantage_lcm::attack_t attack{};
    attack.utime = utime;
    attack.run_id = 3;
    attack.sequence = i + (i > 100 ? 2 : 0) + (i > 200 ? 5 : 0);
    const std::string channel = i % 3 == 0 ? "EVERY_THIRD" : "ATTACK";
    if (i % 3 == 0 && i % 2 == 0) {
      const Bytes data(static_cast<std::size_t>(10'000 + rng() % 9'000), 7);
      append_event({number, from_utime(utime), channel, data}, out);
    } else {
      test::append_message(attack, number, utime, channel, out);
    }
    number += i % 50 == 49 ? 3 : i % 90 == 89 ? -20 : i % 90 == 44 ? 0 : 1;
  }
  for (const std::size_t event : {130U, 260U}) {  // damages two headers
    std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(begins[event]), 30, std::uint8_t{0});
  }
  out.resize(out.size() - 2);
  return out;
}

/// Computes a survey event by event from the definitions.
LogSurvey survey_by_hand(const Bytes& log) {
  LogSurvey out;
  out.size_bytes = log.size();
  LogScan scan(log, check_wire_data);
  std::vector<LocatedEvent> events;
  while (const auto event = scan.next()) {
    events.push_back(*event);
  }
  out.first = Time::max();
  out.last = Time::min();
  std::map<std::string, std::vector<LocatedEvent>> by_channel;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const LocatedEvent& event = events[i];
    out.first = std::min(out.first, event.time);
    out.last = std::max(out.last, event.time);
    by_channel[std::string(event.channel)].push_back(event);
    if (i > 0) {
      const std::int64_t step = event.number - events[i - 1].number;
      out.numbers_missing += std::max<std::int64_t>(0, step - 1);
      out.number_restarts += step <= 0 ? 1 : 0;
      const Duration back = events[i - 1].time - event.time;
      out.times_backward += back > Duration{0} ? 1 : 0;
      out.backward_max = std::max(out.backward_max, back);
    }
  }
  for (const auto& [name, own] : by_channel) {
    ChannelSurvey& channel = out.channels[name];
    channel.events = std::ssize(own);
    channel.first = own.front().time;
    channel.last = own.back().time;
    for (std::size_t i = 0; i < own.size(); ++i) {
      channel.data_bytes += own[i].data.size();
      if (i > 0 && own[i].time - own[i - 1].time > channel.gap_max) {
        channel.gap_max = own[i].time - own[i - 1].time;
        channel.gap_at = own[i - 1].time;
      }
    }
  }
  return out;
}

TEST(SurveyLog, MatchesAManualCount) {
  const Bytes log = eventful_log();
  const LogSurvey survey = survey_log(log);
  const LogSurvey wanted = survey_by_hand(log);
  EXPECT_TRUE(survey.begins_with_scenario);
  EXPECT_FALSE(survey.is_whole());
  EXPECT_EQ(survey.size_bytes, log.size());
  EXPECT_EQ(survey.first, wanted.first);
  EXPECT_EQ(survey.last, wanted.last);
  EXPECT_DOUBLE_EQ(survey.duration_s(),
                   1e-6 * static_cast<double>((wanted.last - wanted.first).count()));
  EXPECT_GT(survey.numbers_missing, 10);
  EXPECT_EQ(survey.numbers_missing, wanted.numbers_missing);
  EXPECT_GE(survey.number_restarts, 3);
  EXPECT_EQ(survey.number_restarts, wanted.number_restarts);
  EXPECT_GE(survey.times_backward, 8);
  EXPECT_EQ(survey.times_backward, wanted.times_backward);
  EXPECT_EQ(survey.backward_max, wanted.backward_max);
  EXPECT_EQ(survey.scan.stretches, 3);
  EXPECT_EQ(survey.stretches.size(), 3U);
  ASSERT_EQ(survey.channels.size(), 3U);
  for (const auto& [name, channel] : survey.channels) {
    const ChannelSurvey& own = wanted.channels.at(name);
    EXPECT_EQ(channel.events, own.events) << name;
    EXPECT_EQ(channel.data_bytes, own.data_bytes) << name;
    EXPECT_EQ(channel.first, own.first) << name;
    EXPECT_EQ(channel.last, own.last) << name;
    EXPECT_EQ(channel.gap_max, own.gap_max) << name;
    EXPECT_EQ(channel.gap_at, own.gap_at) << name;
  }
  EXPECT_EQ(survey.channels.at("SCENARIO").type, "scenario_t");
  EXPECT_EQ(survey.channels.at("ATTACK").type, "attack_t");
  EXPECT_EQ(survey.channels.at("ATTACK").other_types, 0);
  EXPECT_GE(survey.channels.at("ATTACK").messages_lost, 7);
  EXPECT_EQ(survey.channels.at("EVERY_THIRD").type, "") << "type of its first message";
  EXPECT_GT(survey.channels.at("EVERY_THIRD").other_types, 50);
}

// A block is a range at whose start reading can begin. It has at least 256 KiB and ends at the next
// event.
TEST(SurveyLog, DividesALogIntoBlocksAndDescribesEach) {
  for (const Bytes& log : {eventful_log(), large_log()}) {
    const LogSurvey survey = survey_log(log);
    std::vector<LocatedEvent> events;
    LogScan scan(log, check_wire_data);
    while (const auto event = scan.next()) {
      events.push_back(*event);
    }
    std::vector<LogBlock> wanted;
    std::map<std::string, std::set<std::size_t>> blocks_of;
    for (std::size_t i = 0; i < events.size(); ++i) {
      if (wanted.empty() || events[i].offset >= wanted.back().offset + 256U * 1024U) {
        wanted.push_back(
            {events[i].offset, static_cast<std::int64_t>(i), Time::max(), Time::min()});
      }
      wanted.back().time_min = std::min(wanted.back().time_min, events[i].time);
      wanted.back().time_max = std::max(wanted.back().time_max, events[i].time);
      blocks_of[std::string(events[i].channel)].insert(wanted.size() - 1);
    }
    ASSERT_GE(wanted.size(), 2U);
    ASSERT_EQ(survey.blocks.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_EQ(survey.blocks[i].offset, wanted[i].offset);
      EXPECT_EQ(survey.blocks[i].first_event, wanted[i].first_event);
      EXPECT_EQ(survey.blocks[i].time_min, wanted[i].time_min);
      EXPECT_EQ(survey.blocks[i].time_max, wanted[i].time_max);
    }
    for (const auto& [name, channel] : survey.channels) {
      for (std::size_t i = 0; i < 8 * channel.in_block.size(); ++i) {
        const unsigned bits = channel.in_block[i / 8];
        EXPECT_EQ((bits >> (i % 8) & 1U) != 0, blocks_of[name].contains(i)) << i;
      }
      EXPECT_EQ(channel.in_block.size(), *blocks_of[name].rbegin() / 8 + 1);
    }
  }
}

TEST(SurveyLog, ReportsProgressAboutAHundredTimes) {
  Bytes log;
  for (std::int64_t i = 0; i < 5'000; ++i) {
    append_event({i, from_utime(i), "A", Bytes(71, 1)}, log);
  }
  std::vector<double> shares;
  survey_log(log, [&](double share) { shares.push_back(share); });
  EXPECT_NEAR(static_cast<double>(shares.size()), 100.0, 2.0);
  for (std::size_t i = 1; i < shares.size(); ++i) {
    EXPECT_LT(shares[i - 1], shares[i]);
    EXPECT_LT(shares[i] - shares[i - 1], 0.0105) << "one hundredth plus the rest of an event";
  }
  EXPECT_NEAR(shares.front(), 0.01, 0.0005);
  EXPECT_EQ(shares.back(), 1.0);
}

// The index contains the complete survey, each value under its own name.
TEST(IndexedLog, RestoresItsSurvey) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  const Bytes log = eventful_log();
  test::write_file(path, log);
  const LogSurvey first = IndexedLog(path).survey();
  const IndexedLog again(path);
  ASSERT_TRUE(again.was_indexed());
  const LogSurvey& second = again.survey();
  EXPECT_EQ(second.size_bytes, first.size_bytes);
  EXPECT_EQ(second.first, first.first);
  EXPECT_EQ(second.last, first.last);
  EXPECT_EQ(second.numbers_missing, first.numbers_missing);
  EXPECT_EQ(second.number_restarts, first.number_restarts);
  EXPECT_EQ(second.times_backward, first.times_backward);
  EXPECT_EQ(second.backward_max, first.backward_max);
  EXPECT_EQ(second.begins_with_scenario, first.begins_with_scenario);
  EXPECT_EQ(second.scan.events, first.scan.events);
  EXPECT_EQ(second.scan.doubtful, first.scan.doubtful);
  EXPECT_EQ(second.scan.refused, first.scan.refused);
  EXPECT_EQ(second.scan.stretches, first.scan.stretches);
  EXPECT_EQ(second.scan.bytes_damaged, first.scan.bytes_damaged);
  ASSERT_EQ(second.stretches.size(), first.stretches.size());
  for (std::size_t i = 0; i < first.stretches.size(); ++i) {
    EXPECT_EQ(second.stretches[i].offset, first.stretches[i].offset);
    EXPECT_EQ(second.stretches[i].size_bytes, first.stretches[i].size_bytes);
    EXPECT_EQ(second.stretches[i].is_tail, first.stretches[i].is_tail);
  }
  ASSERT_EQ(second.channels.size(), first.channels.size());
  for (const auto& [name, channel] : first.channels) {
    const ChannelSurvey& read = second.channels.at(name);
    EXPECT_EQ(read.type, channel.type);
    EXPECT_EQ(read.events, channel.events);
    EXPECT_EQ(read.data_bytes, channel.data_bytes);
    EXPECT_EQ(read.first, channel.first);
    EXPECT_EQ(read.last, channel.last);
    EXPECT_EQ(read.gap_max, channel.gap_max);
    EXPECT_EQ(read.gap_at, channel.gap_at);
    EXPECT_EQ(read.messages_lost, channel.messages_lost);
    EXPECT_EQ(read.other_types, channel.other_types);
    EXPECT_EQ(read.has_two_publishers, channel.has_two_publishers);
    EXPECT_EQ(read.in_block, channel.in_block);
  }
  ASSERT_EQ(second.blocks.size(), first.blocks.size());
  for (std::size_t i = 0; i < first.blocks.size(); ++i) {
    EXPECT_EQ(second.blocks[i].offset, first.blocks[i].offset);
    EXPECT_EQ(second.blocks[i].first_event, first.blocks[i].first_event);
    EXPECT_EQ(second.blocks[i].time_min, first.blocks[i].time_min);
    EXPECT_EQ(second.blocks[i].time_max, first.blocks[i].time_max);
  }
}

// An index is valid only for a log with the same first and last 4 KiB.
TEST(IndexedLog, RefusesAnIndexIfTheBeginningOrEndOfTheLogHasChanged) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  const Bytes log = eventful_log();
  for (const std::size_t at :
       {std::size_t{0}, std::size_t{4095}, log.size() - 4096, log.size() - 1}) {
    test::write_file(path, log);
    const auto changed = std::filesystem::last_write_time(path);
    static_cast<void>(IndexedLog(path));
    ASSERT_TRUE(IndexedLog(path).was_indexed());
    Bytes other = log;
    other[at] ^= 1U;
    test::write_file(path, other);
    std::filesystem::last_write_time(path, changed);
    EXPECT_FALSE(IndexedLog(path).was_indexed()) << at;
    std::filesystem::remove(path + ".index");
  }
}

TEST(IndexedLog, CreatesNoFileExceptItsIndex) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  test::write_file(path, eventful_log());
  const IndexedLog log(path);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
  EXPECT_TRUE(std::filesystem::exists(path + ".index"));
  EXPECT_FALSE(save_index(folder.file("missing/b.lcmlog"), log.bytes(), log.survey()));
}

/// Appends to `content` the hash with which the index of a log ends.
Bytes with_hash(Bytes content) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const std::uint8_t byte : content) {
    hash = (hash ^ byte) * 0x100000001b3ULL;
  }
  append_big_endian(hash, sizeof hash, content);
  return content;
}

// An index is a cache: the log can be read with any content of its index.
TEST(IndexedLog, SurvivesACorruptIndexWithAValidHash) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  test::write_file(path, eventful_log());
  const LogSurvey survey = IndexedLog(path).survey();
  Bytes index = test::read_file(path + ".index");
  index.resize(index.size() - 8);

  std::vector<Bytes> crafted;
  for (const auto nested :
       std::initializer_list<std::uint8_t>{0x81, 0x9f, 0xa1, 0xc1}) {  // CBOR: lists, maps and tags
    crafted.emplace_back(2'000'000, nested);
  }
  std::mt19937_64 rng(8);
  for (int i = 0; i < 3'000; ++i) {
    Bytes bad = index;
    bad[rng() % bad.size()] = static_cast<std::uint8_t>(rng());
    if (i % 3 == 0) {
      bad.resize(bad.size() - 1 - rng() % std::min<std::size_t>(bad.size() / 2, 40));
    }
    crafted.push_back(bad);
  }
  for (const Bytes& each : crafted) {
    test::write_file(path + ".index", with_hash(each));
    const SeekableLog log(path);
    static_cast<void>(log.events(survey.first, survey.last));
    static_cast<void>(log.newest_before(survey.last));
  }
}

}  // namespace
}  // namespace vantage::logs
