#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "logs/file/log_index.hpp"
#include "test/logs/damage.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;
using test::TemporaryFolder;

// Sequence numbers start at 0. Messages without a number (-1, older logs) are not counted as
// losses.
TEST(SurveyLog, CountsFromTheFirstSequenceNumber) {
  const auto lost = [](const std::vector<std::int64_t>& sequences) {
    Bytes log;
    vantage_lcm::attack_t wire{};
    for (std::size_t i = 0; i < sequences.size(); ++i) {
      wire.sequence = sequences[i];
      test::append_message(wire, std::ssize(log), 1'000, "ATTACK", log);
    }
    return survey_log(log).channels.at("ATTACK").messages_lost;
  };
  EXPECT_EQ(lost({0, 2}), 1);
  EXPECT_EQ(lost({-1, 0, 1}), 0);
  EXPECT_EQ(lost({-5, 1, 2}), 0);
}

// All numbers differ, so a swapped field is detected.
TEST(IndexedLog, RestoresEveryNumber) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  const Bytes log(9'000, 7);
  test::write_file(path, log);
  std::int64_t next = 1'000;
  const auto time = [&next] { return from_utime(++next); };
  LogSurvey made;
  made.size_bytes = log.size();
  made.scan = {11, 12, 13, 14, 15};
  made.first = time();
  made.last = time();
  made.begin = time();
  made.end = time();
  made.times_outlying = 16;
  made.numbers_missing = 21;
  made.number_restarts = 22;
  made.times_backward = 23;
  made.backward_max = Duration{24};
  made.stretches = {{31, 32, false}, {33, 34, true}};
  made.channels["A"] = {"a_t", 41, 42, time(), time(), Duration{45}, time(), 47, 48, true, {1, 2}};
  made.channels["B"] = {"b_t", 51, 52, time(), time(), Duration{55}, time(), 57, 58, false, {3}};
  made.blocks = {{61, 62, time(), time()}, {63, 64, time(), time()}};
  ASSERT_TRUE(save_index(path, log, made));
  const auto read = load_index(path, log);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->size_bytes, made.size_bytes);
  const auto counts = [](const ScanCounts& scan) {
    return std::tuple(scan.events, scan.doubtful, scan.refused, scan.stretches, scan.bytes_damaged);
  };
  EXPECT_EQ(counts(read->scan), counts(made.scan));
  EXPECT_EQ(std::tuple(read->first, read->last, read->begin, read->end, read->times_outlying),
            std::tuple(made.first, made.last, made.begin, made.end, made.times_outlying));
  const auto order = [](const LogSurvey& of) {
    return std::tuple(of.numbers_missing, of.number_restarts, of.times_backward, of.backward_max,
                      of.begins_with_scenario);
  };
  EXPECT_EQ(order(*read), order(made));
  ASSERT_EQ(read->channels.size(), 2U);
  for (const auto& [name, a] : made.channels) {
    const ChannelSurvey& b = read->channels.at(name);
    const auto all = [](const ChannelSurvey& of) {
      return std::tuple(of.type, of.events, of.data_bytes, of.first, of.last, of.gap_max, of.gap_at,
                        of.messages_lost, of.other_types, of.has_two_publishers, of.in_block);
    };
    EXPECT_EQ(all(b), all(a)) << name;
  }
  ASSERT_EQ(read->blocks.size(), 2U);
  ASSERT_EQ(read->stretches.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto block = [](const LogBlock& of) {
      return std::tuple(of.offset, of.first_event, of.time_min, of.time_max);
    };
    EXPECT_EQ(block(read->blocks[i]), block(made.blocks[i]));
    const auto stretch = [](const DamagedStretch& of) {
      return std::tuple(of.offset, of.size_bytes, of.is_tail);
    };
    EXPECT_EQ(stretch(read->stretches[i]), stretch(made.stretches[i]));
  }
}

}  // namespace
}  // namespace vantage::logs
