#include "logs/record/log_writer.hpp"

#include <csignal>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>
#include <sys/resource.h>

#include "core/check.hpp"
#include "logs/file/log_scan.hpp"
#include "test/logs/fake_disk.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

TEST(LogWriter, WritesLogsThatLcmReads) {
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

TEST(LogWriter, RefusesAnUnwritablePath) {
  EXPECT_THROW(LogWriter("/nonexistent/folder/x.lcmlog"), StartupError);
}

TEST(LogWriter, OverwritesOnlyOnRequest) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  test::write_file(path, {1, 2, 3});
  EXPECT_THROW(LogWriter{path}, StartupError);
  EXPECT_EQ(test::read_file(path).size(), 3U);
  LogWriter(path, Existing::kReplace).write(from_utime(1), "X", {});
  EXPECT_EQ(test::read_file(path).size(), 29U);
}

// A failed write must be reported.
TEST(LogWriter, ReportsWriteErrorAndEndsAtWholeEvent) {
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

// A limit on the file size emulates a disk that fills up within an event.
TEST(LogWriter, EndsWithItsLastWholeEventWhenTheDiskIsFull) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("full.lcmlog");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, SIG_IGN);
  const std::vector<std::uint8_t> data(1'000, 7);
  constexpr std::size_t kEventBytes = kEventHeaderBytes + 1 + 1'000;
  std::int64_t events = 0;
  {
    LogWriter writer(path);
    const rlimit small{100'000, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    for (int i = 0; i < 200; ++i) {
      writer.write(from_utime(i), "A", data);
    }
    EXPECT_TRUE(writer.close());
    events = writer.events();
    EXPECT_EQ(events + writer.events_lost(), 200);
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(events, static_cast<std::int64_t>(100'000 / kEventBytes));
  const std::vector<std::uint8_t> bytes = test::read_file(path);
  EXPECT_EQ(bytes.size(), static_cast<std::size_t>(events) * kEventBytes);
  LogScan scan(bytes, {});
  while (scan.next()) {
  }
  EXPECT_EQ(scan.counts().events, events);
  EXPECT_EQ(scan.counts().stretches, 0);
}

TEST(LogWriter, Buffers64Kibibytes) {
  test::FakeDisk disk;
  LogWriter writer("a.lcmlog", Existing::kRefuse, disk.opener());
  constexpr std::size_t kEventBytes = kEventHeaderBytes + 1 + 1'000;
  const std::vector<std::uint8_t> data(1'000);
  for (std::size_t i = 1; i <= 130; ++i) {
    EXPECT_TRUE(writer.write(from_utime(1), "X", data));
    const std::size_t together = (65'536 + kEventBytes - 1) / kEventBytes;
    EXPECT_EQ(disk.bytes("a.lcmlog").size(), i / together * together * kEventBytes) << i;
  }
  writer.flush();
  EXPECT_EQ(disk.bytes("a.lcmlog").size(), 130 * kEventBytes);
  EXPECT_TRUE(writer.write(from_utime(1), "X", data));
  EXPECT_FALSE(writer.error());
  EXPECT_FALSE(writer.close());
  EXPECT_FALSE(writer.close()) << "a second close fails as well";
  EXPECT_EQ(disk.bytes("a.lcmlog").size(), 131 * kEventBytes);
  EXPECT_EQ(writer.events(), 131);
  EXPECT_EQ(writer.events_lost(), 0);
}

// 1024 events of 64 bytes fill the buffer of 64 KiB exactly.
TEST(LogWriter, FlushesAnExactlyFullBuffer) {
  test::FakeDisk disk;
  LogWriter writer("a.lcmlog", Existing::kRefuse, disk.opener());
  const std::vector<std::uint8_t> data(64 - kEventHeaderBytes - 1);
  for (int i = 1; i <= 1'024; ++i) {
    EXPECT_TRUE(disk.bytes("a.lcmlog").empty()) << i;
    EXPECT_TRUE(writer.write(from_utime(1), "X", data));
  }
  EXPECT_EQ(disk.bytes("a.lcmlog").size(), 65'536U);
}

TEST(LogWriter, WritesNothingAfterAnError) {
  test::FakeDisk disk;
  disk.set_room(29);
  LogWriter writer("a.lcmlog", Existing::kRefuse, disk.opener());
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(writer.write(from_utime(i), "X", {}));
  }
  writer.flush();
  ASSERT_TRUE(writer.error());
  disk.set_room(1'000);
  EXPECT_FALSE(writer.write(from_utime(2), "X", {}));
  EXPECT_EQ(writer.events(), 1);
  EXPECT_EQ(writer.events_lost(), 2);
  EXPECT_TRUE(writer.close());
  EXPECT_EQ(disk.bytes("a.lcmlog").size(), 29U);
}

}  // namespace
}  // namespace vantage::logs
