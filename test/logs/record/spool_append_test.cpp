// Tests a recorder that appends to an existing log.

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/file/log_scan.hpp"
#include "logs/record/log_spool.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;

constexpr std::size_t kDataBytes = 100;
constexpr std::size_t kEventBytes = kEventHeaderBytes + 4 + kDataBytes;

SpoolOptions append_to(const std::string& path) {
  SpoolOptions out;
  out.path = path;
  out.existing = Existing::kAppend;
  out.write_period = out.sync_period = out.retry_period = std::chrono::milliseconds(1);
  return out;
}

/// Returns `count` events without the last `torn` bytes.
Bytes file_of(int count, std::size_t torn) {
  Bytes out;
  for (int i = 0; i < count; ++i) {
    append_event({i, from_utime(1'000 + i), "TICK", Bytes(kDataBytes, 7)}, out);
  }
  out.resize(out.size() - torn);
  return out;
}

void write(LogSpool& spool, int count) {
  for (int i = 0; i < count; ++i) {
    spool.write(from_utime(2'000 + i), "TICK", Bytes(kDataBytes, 8));
  }
}

TEST(LogSpool, RemovesAnIncompleteEventBeforeAppending) {
  const test::TemporaryFolder folder;
  for (const std::size_t torn :
       {std::size_t{0}, std::size_t{1}, kEventBytes - 1, kEventBytes - 3}) {
    const std::string path = folder.file(std::to_string(torn));
    test::write_file(path, file_of(5, torn));
    {
      LogSpool spool(append_to(path));
      write(spool, 3);
    }
    const Bytes bytes = test::read_file(path);
    LogScan scan(bytes);
    int events = 0;
    while (scan.next()) {
      ++events;
    }
    EXPECT_EQ(events, torn == 0 ? 8 : 7) << torn;
    EXPECT_EQ(scan.counts().bytes_damaged, 0U) << torn;
  }
}

// The limit applies to the sum of all files, including existing ones.
TEST(LogSpool, IncludesExistingFilesInItsLimit) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  for (const int there : {1, 3, 4}) {
    test::write_file(path, file_of(1, 0));
    test::write_file(folder.file("a-2.lcmlog"), file_of(there - 1, 0));
    SpoolOptions options = append_to(path);
    options.limit_bytes = 3 * kEventBytes;
    LogSpool spool(options);
    write(spool, 4);
    spool.close();
    const std::size_t bytes =
        test::read_file(path).size() + test::read_file(folder.file("a-2.lcmlog")).size();
    EXPECT_EQ(bytes, std::max<std::size_t>(static_cast<std::size_t>(there), 3) * kEventBytes);
    EXPECT_TRUE(spool.report().is_full);
  }
}

}  // namespace
}  // namespace vantage::logs
