#include "logs/record/log_spool.hpp"

#include <atomic>
#include <memory>

#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "core/check.hpp"
#include "core/deadline.hpp"
#include "logs/file/log_event.hpp"
#include "test/logs/fake_disk.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;
using test::FakeDisk;

constexpr std::size_t kDataBytes = 100;
constexpr std::size_t kEventBytes = kEventHeaderBytes + 4 + kDataBytes;
constexpr std::int64_t kStart = 1'700'000'000'000'000;
const std::string kPath = "/nowhere/flight.lcmlog";

Bytes data_of(int i) { return Bytes(kDataBytes, static_cast<std::uint8_t>(i)); }

/// Writes event `i`, whose data and time contain the number.
bool write(LogSpool& spool, int i, std::string_view channel = "TICK") {
  return spool.write(from_utime(kStart + i), channel, data_of(i));
}

std::vector<LogEvent> events_of(const Bytes& bytes) {
  std::vector<LogEvent> out;
  for (std::size_t at = 0; at < bytes.size();) {
    const auto event = event_at(bytes, at);
    if (!event) {
      ADD_FAILURE() << "torn at " << at << " of " << bytes.size();
      return out;
    }
    out.push_back(*event);
    at += event->size_bytes();
  }
  return out;
}

void expect_events(const Bytes& bytes, int first, int end) {
  const auto events = events_of(bytes);
  ASSERT_EQ(std::ssize(events), end - first);
  for (int i = first; i < end; ++i) {
    const LogEvent& event = events[static_cast<std::size_t>(i - first)];
    EXPECT_EQ(event.number, i - first);
    EXPECT_EQ(event.time, from_utime(kStart + i));
    EXPECT_EQ(event.data[0], static_cast<std::uint8_t>(i));
  }
}

SpoolOptions quick(const std::string& path = kPath) {
  SpoolOptions out;
  out.path = path;
  out.write_period = out.sync_period = out.retry_period = std::chrono::milliseconds(1);
  return out;
}

/// Waits up to 20 s for a notice that contains `words`; returns all notices up to that one.
std::string wait_for_notice(LogSpool& spool, const std::string& words) {
  std::string notices;
  const std::int64_t give_up_ns = monotonic_ns() + 20'000'000'000;
  while (notices.find(words) == std::string::npos && monotonic_ns() < give_up_ns) {
    for (const std::string& notice : spool.take_notices()) {
      notices += notice + "\n";
    }
    std::this_thread::yield();
  }
  EXPECT_NE(notices.find(words), std::string::npos) << notices;
  return notices;
}

TEST(LogSpool, WritesLogsThatLcmReads) {
  const test::TemporaryFolder folder;
  {
    LogSpool spool(quick(folder.file("a.lcmlog")));
    for (int i = 0; i < 300; ++i) {
      EXPECT_TRUE(write(spool, i));
    }
    spool.close();
    EXPECT_FALSE(write(spool, 300)) << "the spool is closed";
    EXPECT_EQ(spool.report().events, 300);
    EXPECT_EQ(spool.report().bytes, 300 * kEventBytes);
  }
  expect_events(test::read_file(folder.file("a.lcmlog")), 0, 300);
  lcm::LogFile log(folder.file("a.lcmlog"), "r");
  ASSERT_TRUE(log.good());
  int found = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    EXPECT_EQ(event->eventnum, found);
    EXPECT_EQ(event->timestamp, kStart + found);
    EXPECT_EQ(event->channel, "TICK");
    ++found;
  }
  EXPECT_EQ(found, 300);
}

TEST(LogSpool, WritesAndSyncsPeriodically) {
  FakeDisk disk;
  LogSpool spool(quick(), disk.opener());
  for (int i = 0; i < 3; ++i) {
    write(spool, i);
    EXPECT_TRUE(disk.wait_for(kPath, [&](const Bytes&, std::size_t synced) {
      return synced == static_cast<std::size_t>(i + 1) * kEventBytes;
    })) << "no further event arrives, so the data must be synced";
  }
  EXPECT_TRUE(spool.report().is_good());
}

// If write() waited for the disk, it would never return, and the test would time out.
TEST(LogSpool, DoesNotBlockOnAHangingDisk) {
  FakeDisk disk;
  disk.hang_append(true);
  SpoolOptions options = quick();
  options.queue_bytes_max = 50 * kEventBytes;
  LogSpool spool(options, disk.opener());
  int taken = 1;
  EXPECT_TRUE(write(spool, 0));
  EXPECT_TRUE(disk.wait_for_hanging_append());  // the event in progress counts, too
  while (write(spool, taken)) {
    ++taken;
  }
  EXPECT_EQ(taken, 50);
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(write(spool, taken + i));
  }
  EXPECT_EQ(spool.report().events_lost, 11);
  EXPECT_EQ(spool.report().queue_bytes, 50 * kEventBytes);
  EXPECT_NE(wait_for_notice(spool, "events are lost").find(kPath), std::string::npos);
  disk.hang_append(false);
  spool.close();
  expect_events(disk.bytes(kPath), 0, 50);
  EXPECT_FALSE(spool.report().is_good());
}

// Written data survives a kill -9, even during a long sync.
TEST(LogSpool, ContinuesWritingDuringAHangingSync) {
  FakeDisk disk;
  disk.hang_sync(true);
  LogSpool spool(quick(), disk.opener());
  const auto writes = [&](int i) {
    write(spool, i);
    return disk.wait_for(kPath, [&](const Bytes& bytes, std::size_t synced) {
      return synced == 0 && bytes.size() == static_cast<std::size_t>(i + 1) * kEventBytes;
    });
  };
  EXPECT_TRUE(writes(0));
  const std::int64_t give_up_ns = monotonic_ns() + 20'000'000'000;
  while (spool.report().at_risk_worst_us <= 100'000 && monotonic_ns() < give_up_ns) {
    std::this_thread::yield();
  }
  EXPECT_GT(spool.report().at_risk_worst_us, 100'000) << "reported while the disk hangs";
  for (int i = 1; i < 5; ++i) {
    EXPECT_TRUE(writes(i));
  }
  EXPECT_GT(spool.report().at_risk_worst_us, 100'000) << "the age of the oldest unsynced data";
  disk.hang_sync(false);
  const std::string words = "a power cut would have lost the last ";
  const std::string notices = wait_for_notice(spool, words);
  const std::int64_t reported_ms = std::stoll(notices.substr(notices.find(words) + words.size()));
  EXPECT_GE(reported_ms, 100);
  EXPECT_LE(reported_ms, spool.report().at_risk_worst_us / 1'000) << "at most the worst value";
  EXPECT_GE(spool.report().syncs_late, 1);
  spool.close();
  EXPECT_GT(spool.report().at_risk_worst_us, 100'000) << "kept after everything is synced";
}

TEST(LogSpool, KeepsItsLogIntactWhenTheDiskFillsUp) {
  FakeDisk disk;
  disk.set_room(2 * kEventBytes + 77);  // full within the third event
  LogSpool spool(quick(), disk.opener());
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(write(spool, i));
  }
  const std::string notices = wait_for_notice(spool, "LOG NOT WRITTEN");
  EXPECT_NE(notices.find(kPath + ": cannot be written: No space left on device"), std::string::npos)
      << notices;
  EXPECT_FALSE(spool.report().is_written);
  EXPECT_EQ(spool.report().write_errors, 1) << "one error, although it is retried";
  EXPECT_TRUE(write(spool, 5));
  disk.set_room(std::size_t{1} << 20U);
  wait_for_notice(spool, "the log is written again; number of lost events: 0");
  EXPECT_TRUE(spool.report().is_written);
  spool.close();
  expect_events(disk.bytes(kPath), 0, 6);
  EXPECT_FALSE(spool.report().is_good()) << "data was refused";
}

TEST(LogSpool, EndsWithItsLastWholeEventWhenTheDiskStaysFull) {
  for (std::size_t room = 0; room < 2 * kEventBytes + 2; room += 29) {
    FakeDisk disk;
    disk.set_room(room);
    LogSpool spool(quick(), disk.opener());
    for (int i = 0; i < 4; ++i) {
      write(spool, i);
    }
    spool.close();
    const auto whole = static_cast<int>(room / kEventBytes);
    expect_events(disk.bytes(kPath), 0, whole);
    const SpoolReport report = spool.report();
    EXPECT_EQ(report.events, whole);
    EXPECT_EQ(report.events_lost, 4 - whole) << room;
    EXPECT_FALSE(report.is_good());
    EXPECT_EQ(disk.synced_bytes(kPath), disk.bytes(kPath).size());
  }
}

TEST(LogSpool, ReportsUnsyncedData) {
  FakeDisk disk;
  disk.fail_sync(true);
  LogSpool spool(quick(), disk.opener());
  write(spool, 0);
  const std::string notices = wait_for_notice(spool, "LOG NOT SAFE");
  EXPECT_NE(
      notices.find(kPath +
                   ": the last data may not have been written to the disk: Input/output error"),
      std::string::npos);
  EXPECT_FALSE(spool.report().is_good());
}

TEST(LogSpool, StartsEachFileWithTheNewestScenario) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  const Bytes other = {1, 2, 3};
  test::write_file(folder.file("a-3.lcmlog"), other);
  SpoolOptions options = quick(path);
  options.rotate_bytes = 5 * (kEventBytes + 4);
  LogSpool spool(options);
  write(spool, 0, "SCENARIO");
  for (int i = 1; i < 12; ++i) {
    write(spool, i);
  }
  spool.close();
  EXPECT_TRUE(test::read_file(folder.file("a-3.lcmlog")) == other);
  EXPECT_EQ(spool.report().files, 3);
  EXPECT_EQ(spool.report().path, folder.file("a-4.lcmlog"));
  int next = 0;
  for (const char* name : {"a.lcmlog", "a-2.lcmlog", "a-4.lcmlog"}) {
    const Bytes bytes = test::read_file(folder.file(name));
    EXPECT_LE(bytes.size(), options.rotate_bytes);
    const auto events = events_of(bytes);
    ASSERT_FALSE(events.empty());
    EXPECT_EQ(events[0].channel, "SCENARIO");
    EXPECT_EQ(events[0].number, 0);
    EXPECT_EQ(events[0].time, events[next == 0 ? 0 : 1].time);
    for (std::size_t i = next == 0 ? 0 : 1; i < events.size(); ++i) {
      EXPECT_EQ(events[i].number, static_cast<std::int64_t>(i));
      EXPECT_EQ(events[i].data[0], next++);
    }
  }
  EXPECT_EQ(next, 12);
}

TEST(LogSpool, AppendsToItsLastFile) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  SpoolOptions options = quick(path);
  options.existing = Existing::kAppend;
  for (int run = 0; run < 3; ++run) {
    LogSpool spool(options);
    write(spool, run);
  }
  EXPECT_EQ(events_of(test::read_file(path)).size(), 3U);
  test::write_file(folder.file("a-2.lcmlog"), {});
  {
    LogSpool spool(options);
    write(spool, 3);
  }
  EXPECT_EQ(events_of(test::read_file(path)).size(), 3U);
  EXPECT_EQ(events_of(test::read_file(folder.file("a-2.lcmlog"))).size(), 1U);
}

TEST(LogSpool, StopsAtItsLimit) {
  FakeDisk disk;
  SpoolOptions options = quick();
  options.limit_bytes = 3 * kEventBytes + 5;
  LogSpool spool(options, disk.opener());
  for (int i = 0; i < 5; ++i) {
    write(spool, i);
  }
  wait_for_notice(spool, "the limit of ");
  EXPECT_TRUE(spool.report().is_full);
  spool.close();
  expect_events(disk.bytes(kPath), 0, 3);
  EXPECT_EQ(spool.report().events_lost, 2);
}

// Free space is reported at the start, after a refused write, and after a sync.
TEST(LogSpool, ReportsFreeSpace) {
  FakeDisk disk;
  const std::size_t room = 2 * kEventBytes + 77;
  disk.set_room(room);
  disk.hang_sync(true);
  LogSpool spool(quick(), disk.opener());
  EXPECT_EQ(spool.report().free_bytes, room);
  for (int i = 0; i < 5; ++i) {
    write(spool, i);
  }
  wait_for_notice(spool, "LOG NOT WRITTEN");
  EXPECT_EQ(spool.report().free_bytes, 0U);
  disk.set_room(10 * kEventBytes);
  wait_for_notice(spool, "written again");
  disk.hang_sync(false);
  spool.close();
  EXPECT_EQ(spool.report().free_bytes, room + 10 * kEventBytes - 5 * kEventBytes);
}

TEST(LogSpool, OverwritesNothing) {
  const test::TemporaryFolder folder;
  const Bytes old = {7, 7, 7};
  test::write_file(folder.file("a.lcmlog"), old);
  try {
    const LogSpool spool(quick(folder.file("a.lcmlog")));
    FAIL() << "the file exists";
  } catch (const StartupError& error) {
    EXPECT_NE(std::string(error.what()).find("a.lcmlog: exists already"), std::string::npos)
        << error.what();
  }
  EXPECT_TRUE(test::read_file(folder.file("a.lcmlog")) == old);
  EXPECT_EQ(unused_path(folder.file("a.lcmlog")), folder.file("a-2.lcmlog"));
  test::write_file(folder.file("a-2.lcmlog"), old);
  EXPECT_EQ(unused_path(folder.file("a.lcmlog")), folder.file("a-3.lcmlog"));
  EXPECT_EQ(unused_path(folder.file("b.lcmlog")), folder.file("b.lcmlog"));
  EXPECT_THROW(LogSpool(quick("/no/such/folder/x.lcmlog")), StartupError);
}

TEST(FreeBytesFor, EqualsTheFileSystemsFigure) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(free_bytes_for(folder.file("not_there.lcmlog")).has_value());
  EXPECT_TRUE(free_bytes_for("here.lcmlog").has_value());
  EXPECT_FALSE(free_bytes_for("/no/such/folder/x.lcmlog").has_value());
}

TEST(LogSpool, HasTheStatedDefaults) {
  const SpoolOptions options;
  EXPECT_EQ(options.rotate_bytes, 0U);
  EXPECT_EQ(options.limit_bytes, 0U);
  EXPECT_EQ(options.queue_bytes_max, 64U * 1024U * 1024U);
  EXPECT_EQ(options.write_period, std::chrono::milliseconds(10));
  EXPECT_EQ(options.sync_period, std::chrono::milliseconds(40));
  EXPECT_EQ(options.retry_period, std::chrono::milliseconds(200));
  // New data is safe within the limit: written, then synced after the sync in progress.
  EXPECT_LE(options.write_period + 2 * options.sync_period, LogSpool::kAtRiskMax);
  EXPECT_EQ(LogSpool::kAtRiskMax, std::chrono::milliseconds(100));
  EXPECT_EQ(LogSpool::at_risk_max(options), LogSpool::kAtRiskMax);
  SpoolOptions rare = options;
  rare.sync_period = std::chrono::seconds(2);
  EXPECT_EQ(LogSpool::at_risk_max(rare), std::chrono::milliseconds(4'010));
  FakeDisk disk;
  LogSpool spool(quick(), disk.opener());
  const SpoolReport report = spool.report();
  EXPECT_EQ(report.path, kPath);
  EXPECT_EQ(report.files, 1);
  EXPECT_EQ(report.events + report.events_lost + report.write_errors + report.sync_errors, 0);
  EXPECT_TRUE(report.is_written);
  EXPECT_FALSE(report.is_full);
  EXPECT_TRUE(report.is_good());
  EXPECT_EQ(report.at_risk_worst_us, 0) << "no data is at risk";
}

// An event that exactly fills the limit is written; one byte more, and it is lost.
TEST(LogSpool, FillsItsLimitExactly) {
  for (const std::size_t less : {0U, 1U}) {
    FakeDisk disk;
    SpoolOptions options = quick();
    options.limit_bytes = 3 * kEventBytes - less;
    LogSpool spool(options, disk.opener());
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(write(spool, i));
    }
    spool.close();
    expect_events(disk.bytes(kPath), 0, less == 0 ? 3 : 2);
    EXPECT_EQ(spool.report().is_full, less > 0);
    EXPECT_EQ(spool.report().events_lost, static_cast<std::int64_t>(less));
    EXPECT_EQ(spool.report().bytes, (3 - less) * kEventBytes);
    const auto notice = spool.take_notices();
    ASSERT_EQ(notice.size(), less);
    if (less > 0) {
      EXPECT_EQ(notice[0], kPath + ": the limit of " + std::to_string(3 * kEventBytes - 1) +
                               " bytes is reached");
    }
    EXPECT_TRUE(spool.take_notices().empty()) << "reported only once";
  }
}

// The limit applies to the sum of all files; each file is filled before the next begins.
TEST(LogSpool, CountsAllItsFilesTogether) {
  FakeDisk disk;
  SpoolOptions options = quick();
  options.rotate_bytes = 2 * kEventBytes;
  options.limit_bytes = 5 * kEventBytes;
  LogSpool spool(options, disk.opener());
  for (int i = 0; i < 7; ++i) {
    EXPECT_TRUE(write(spool, i));
  }
  spool.close();
  expect_events(disk.bytes(kPath), 0, 2);
  expect_events(disk.bytes("/nowhere/flight-2.lcmlog"), 2, 4);
  expect_events(disk.bytes("/nowhere/flight-3.lcmlog"), 4, 5);
  const SpoolReport report = spool.report();
  EXPECT_EQ(report.files, 3);
  EXPECT_EQ(report.path, "/nowhere/flight-3.lcmlog");
  EXPECT_EQ(report.events, 5);
  EXPECT_EQ(report.events_lost, 2);
  EXPECT_EQ(report.bytes, 5 * kEventBytes);
  EXPECT_EQ(report.queue_bytes, 0U);
}

TEST(LogSpool, RetriesCreatingTheNextFile) {
  FakeDisk disk;
  std::atomic<int> refused = 0;
  const OpenFile open = [&, opener = disk.opener()](
                            const std::string& path,
                            Existing existing) -> Result<std::unique_ptr<AppendFile>> {
    if (path == "/nowhere/flight-2.lcmlog" && refused < 3) {
      ++refused;
      return Error{path + ": not yet"};
    }
    return opener(path, existing);
  };
  SpoolOptions options = quick();
  options.rotate_bytes = kEventBytes;
  LogSpool spool(options, open);
  write(spool, 0);
  write(spool, 1);
  const std::string notices =
      wait_for_notice(spool, "the log is written again; number of lost events: 0");
  EXPECT_NE(notices.find("LOG NOT WRITTEN: /nowhere/flight-2.lcmlog: not yet"), std::string::npos)
      << notices;
  spool.close();
  EXPECT_EQ(refused, 3);
  EXPECT_EQ(spool.report().write_errors, 1);
  EXPECT_EQ(spool.report().files, 2);
  expect_events(disk.bytes("/nowhere/flight-2.lcmlog"), 1, 2);
}

TEST(LogSpool, CountsEventsWithoutAFileAsLost) {
  FakeDisk disk;
  const OpenFile open = [&, opener = disk.opener()](
                            const std::string& path,
                            Existing existing) -> Result<std::unique_ptr<AppendFile>> {
    return path == kPath ? opener(path, existing)
                         : Result<std::unique_ptr<AppendFile>>(Error{path + ": never"});
  };
  SpoolOptions options = quick();
  options.rotate_bytes = 2 * kEventBytes;
  LogSpool spool(options, open);
  for (int i = 0; i < 5; ++i) {
    write(spool, i);
  }
  spool.close();
  expect_events(disk.bytes(kPath), 0, 2);
  EXPECT_EQ(spool.report().events, 2);
  EXPECT_EQ(spool.report().events_lost, 3);
}

}  // namespace
}  // namespace vantage::logs
