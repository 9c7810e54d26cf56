#include "logs/file/log_index.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <unistd.h>

#include "bus/convert/convert.hpp"
#include "core/check.hpp"
#include "test/logs/damage.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;
using test::TemporaryFolder;

/// Events of 500 kB: several blocks. Times go back a little now and then.
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

TEST(SeekOffset, IsWhereReadingFromTheBeginningArrives) {
  const Bytes log = large_log();
  const LogSurvey survey = survey_log(log);
  EXPECT_GT(survey.blocks.size(), 5U);
  for (std::int64_t utime = 980'000; utime < 1'420'000; utime += 1'250) {
    EXPECT_EQ(seek_offset(log, survey, from_utime(utime)), seek_by_reading(log, from_utime(utime)))
        << utime;
  }
}

TEST(SurveyLog, CountsWhatIsThere) {
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

TEST(SurveyLog, TakesAMessageThatDoesNotDecodeForDamage) {
  vantage_lcm::attack_t wire{};
  wire.num_jammed = 1;
  wire.jammed = {"Q1"};
  Bytes log;
  for (std::int64_t i = 0; i < 3; ++i) {
    test::append_message(wire, i, 1'000 + i, "ATTACK", log);
  }
  const std::size_t size = log.size() / 3;
  const std::size_t name_length = size + size - 3 - 1;  // of the second event's "Q1"
  log[name_length] = 200;
  const LogSurvey survey = survey_log(log);
  EXPECT_EQ(survey.scan.events, 2);
  EXPECT_EQ(survey.scan.bytes_damaged, size);
}

TEST(IndexedLog, RemembersItsSurveyBesideTheLog) {
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

TEST(IndexedLog, DoesNotTrustTheIndexOfAnotherLog) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  Bytes log = large_log();
  test::write_file(path, log);
  EXPECT_EQ(IndexedLog(path).survey().scan.events, 40);
  const auto changed = std::filesystem::last_write_time(path);
  log.resize(log.size() / 2);
  test::write_file(path, log);  // as long as half of it
  std::filesystem::last_write_time(path, changed);
  EXPECT_FALSE(IndexedLog(path).was_indexed());
  log[40] ^= 1U;  // as long and as old, other bytes
  test::write_file(path, log);
  std::filesystem::last_write_time(path, changed);
  EXPECT_FALSE(IndexedLog(path).was_indexed());
}

TEST(IndexedLog, DoesNotTrustADamagedIndex) {
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

TEST(IndexedLog, OpensAnEmptyLogAndRefusesWhatIsNone) {
  const TemporaryFolder folder;
  test::write_file(folder.file("empty"), {});
  const IndexedLog empty(folder.file("empty"));
  EXPECT_EQ(empty.survey().scan.events, 0);
  LogScan scan = empty.scan_from(from_utime(5));
  EXPECT_FALSE(scan.next().has_value());
  EXPECT_THROW(IndexedLog(folder.file("missing")), StartupError);
  EXPECT_THROW(IndexedLog(folder.path()), StartupError);
}

}  // namespace
}  // namespace vantage::logs
