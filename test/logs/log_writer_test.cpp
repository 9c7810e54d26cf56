#include "logs/record/log_writer.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "core/check.hpp"
#include "test/logs/fake_disk.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

TEST(LogWriter, WritesWhatLcmReadsWithTheTimesItWasGiven) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  const std::vector<std::uint8_t> first = {1, 2, 3};
  {
    LogWriter writer(path);
    EXPECT_TRUE(writer.write(from_utime(1'700'000'000'000'000), "SCENARIO", first));
    EXPECT_TRUE(writer.write(from_utime(1'700'000'000'500'000), "TRUTH", {}));
    EXPECT_EQ(writer.events(), 2);
    EXPECT_FALSE(writer.close().has_value());
  }
  lcm::LogFile log(path, "r");
  ASSERT_TRUE(log.good());
  const lcm::LogEvent* event = log.readNextEvent();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->timestamp, 1'700'000'000'000'000);
  EXPECT_EQ(event->channel, "SCENARIO");
  const auto* bytes = static_cast<const std::uint8_t*>(event->data);
  EXPECT_EQ(std::vector<std::uint8_t>(bytes, bytes + event->datalen), first);
  event = log.readNextEvent();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->timestamp, 1'700'000'000'500'000);
  EXPECT_EQ(event->datalen, 0);
  EXPECT_EQ(log.readNextEvent(), nullptr);
}

TEST(LogWriter, RefusesAPathThatCannotBeWritten) {
  EXPECT_THROW(LogWriter("/nonexistent/folder/x.lcmlog"), StartupError);
}

TEST(LogWriter, WritesOverALogOnlyWhenToldTo) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  test::write_file(path, {1, 2, 3});
  EXPECT_THROW(LogWriter{path}, StartupError);
  EXPECT_EQ(test::read_file(path).size(), 3U);
  LogWriter(path, Existing::kReplace).write(from_utime(1), "X", {});
  EXPECT_EQ(test::read_file(path).size(), 29U);
}

// Red before: what the disk had refused was found missing by nobody.
TEST(LogWriter, SaysWhyALogLacksSomethingAndEndsItWhole) {
  test::FakeDisk disk;
  const std::vector<std::uint8_t> data(1000);
  disk.set_room(5'500);
  LogWriter writer("full.lcmlog", Existing::kRefuse, disk.opener());
  for (int i = 0; i < 10; ++i) {
    writer.write(from_utime(i), "X", data);
  }
  const auto error = writer.close();
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->message, "full.lcmlog: cannot be written: No space left on device");
  EXPECT_EQ(disk.bytes("full.lcmlog").size(), 5 * 1029U);
  EXPECT_EQ(writer.events(), 5);
  EXPECT_EQ(writer.events_lost(), 5);
}

}  // namespace
}  // namespace vantage::logs
