#include "logs/record/log_tail.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/file/log_event.hpp"

namespace vantage::logs {
namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes kPayload(200, 0x11);

Bytes log_of(int events, std::int64_t first_number = 0) {
  Bytes out;
  for (int i = 0; i < events; ++i) {
    append_event({first_number + i, from_utime(1'000'000 + i), "FOREIGN", kPayload}, out);
  }
  return out;
}

class LogFile : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  void write(const Bytes& bytes) const {
    std::ofstream file(path_, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),  // NOLINT: writes bytes
               static_cast<std::streamsize>(bytes.size()));
  }
  const std::string path_ = ::testing::TempDir() + "vantage_log_tail_" +
                            ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                            ".lcmlog";
};

TEST(FindTail, FindsTheEndOfTheLastWholeEvent) {
  const Bytes whole = log_of(5);
  const std::size_t four = log_of(4).size();
  for (std::size_t size = four; size < whole.size(); ++size) {
    const LogTail tail = find_tail(std::span(whole).first(size));
    EXPECT_EQ(tail.whole_bytes, four) << "cut at " << size;
    EXPECT_EQ(tail.last, from_utime(1'000'003));
  }
  EXPECT_EQ(find_tail(whole).whole_bytes, whole.size());
}

TEST(FindTail, AcceptsBytesThatStartInsideAnEvent) {
  const Bytes whole = log_of(5);
  for (std::size_t from = 1; from < log_of(1).size(); from += 7) {
    EXPECT_EQ(find_tail(std::span(whole).subspan(from)).whole_bytes, whole.size() - from);
  }
}

TEST(FindTail, FindsNothingWithoutEvents) {
  EXPECT_FALSE(find_tail({}).last);
  EXPECT_FALSE(find_tail(kPayload).last);
}

TEST_F(LogFile, LosesOnlyItsTruncatedEvent) {
  Bytes bytes = log_of(3);
  const std::size_t three = bytes.size();
  bytes.resize(log_of(4).size() - 50);
  const Bytes fourth = log_of(4);
  std::copy(fourth.begin() + static_cast<std::ptrdiff_t>(three),
            fourth.begin() + static_cast<std::ptrdiff_t>(bytes.size()),
            bytes.begin() + static_cast<std::ptrdiff_t>(three));
  write(bytes);
  const TrimmedLog trimmed = trim_log(path_);
  EXPECT_EQ(trimmed.size_bytes, three);
  EXPECT_EQ(trimmed.dropped_bytes, bytes.size() - three);
  EXPECT_EQ(trimmed.last, from_utime(1'000'002));
  EXPECT_EQ(std::filesystem::file_size(path_), three);
  EXPECT_EQ(trim_log(path_).dropped_bytes, 0U) << "a second call removes nothing";
  EXPECT_FALSE(event_time_at(path_, three));
}

TEST_F(LogFile, IsUnchangedWithoutAWholeEvent) {
  write(kPayload);
  EXPECT_EQ(trim_log(path_).dropped_bytes, 0U);
  EXPECT_EQ(std::filesystem::file_size(path_), kPayload.size());
  EXPECT_EQ(trim_log(path_ + ".absent").size_bytes, 0U);
}

TEST_F(LogFile, ReturnsTheTimeOfAnEvent) {
  write(log_of(3));
  EXPECT_EQ(event_time_at(path_, log_of(2).size()), from_utime(1'000'002));
  EXPECT_FALSE(event_time_at(path_, log_of(2).size() + 1));
  EXPECT_FALSE(event_time_at(path_, log_of(3).size()));
}

TEST_F(LogFile, MissingFileCausesNoException) {
  const std::string absent = path_ + ".absent";
  EXPECT_FALSE(event_time_at(absent, 0));
  EXPECT_FALSE(ends_with(absent, Bytes{1}));
}

TEST_F(LogFile, ReturnsTheLastPublishedMessage) {
  Bytes bytes = log_of(2);
  append_event({2, from_utime(5), "LAST", Bytes{7, 8, 9, 10}}, bytes);
  write(bytes);
  EXPECT_TRUE(ends_with(path_, Bytes{7, 8, 9, 10}));
  EXPECT_FALSE(ends_with(path_, Bytes{7, 8, 9, 11}));
}

}  // namespace
}  // namespace vantage::logs
