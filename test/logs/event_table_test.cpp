#include "logs/file/event_table.hpp"

#include <random>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;
using test::TemporaryFolder;

/// Event i is of µs 1000 i, on channel RARE or OFTEN; `order` says how they lie in the file.
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

TEST(EventTable, FindsEveryEventByTimeInWhateverOrderTheyLie) {
  std::vector<std::int64_t> order = first_numbers(100);
  std::mt19937 rng(5);
  for (std::size_t i = 0; i + 5 <= order.size(); i += 5) {  // as of several hosts' logs merged
    std::shuffle(order.begin() + std::ptrdiff_t(i), order.begin() + std::ptrdiff_t(i) + 5, rng);
  }
  const TemporaryFolder folder;
  test::write_file(folder.file("a.lcmlog"), log_of(order));
  const IndexedLog log(folder.file("a.lcmlog"));
  const EventTable table(log);
  ASSERT_EQ(table.size(), 100U);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const LogEvent event = table.read(i);
    EXPECT_EQ(table.time(i), event.time);
    EXPECT_EQ(table.first_at(event.time), i);
    EXPECT_EQ(event.number, static_cast<std::int64_t>(i));
    EXPECT_EQ(event.channel, i % 3 == 0 ? "RARE" : "OFTEN");
    EXPECT_EQ(Bytes(event.data.begin(), event.data.end()), Bytes(i % 7, std::uint8_t(i)));
  }
  EXPECT_EQ(table.start(), from_utime(0));
  EXPECT_EQ(table.end(), from_utime(99'000));
  EXPECT_EQ(table.newest_before(50), (std::vector<std::size_t>{48, 49}));
  EXPECT_EQ(table.newest_before(1), (std::vector<std::size_t>{0}));
  EXPECT_TRUE(table.newest_before(0).empty());
  EXPECT_EQ(table.first_at(from_utime(1'000'000'000)), table.size());
}

TEST(EventTable, HoldsWhatIsIntactOfADamagedLog) {
  Bytes bytes = log_of(first_numbers(100));
  bytes.resize(bytes.size() - 3);
  std::fill_n(bytes.begin(), 7, std::uint8_t{0x55});
  const TemporaryFolder folder;
  test::write_file(folder.file("a.lcmlog"), bytes);
  const IndexedLog log(folder.file("a.lcmlog"));
  const EventTable table(log);
  EXPECT_EQ(table.size(), 98U);
  EXPECT_EQ(table.read(0).number, 1);
  EXPECT_GT(log.survey().scan.bytes_damaged, 0U);
}

TEST(EventTable, RefusesWhatIsNoLog) {
  const TemporaryFolder folder;
  test::write_file(folder.file("a.txt"), Bytes(200, 'x'));
  const IndexedLog log(folder.file("a.txt"));
  EXPECT_THROW(EventTable{log}, StartupError);
}

}  // namespace
}  // namespace vantage::logs
