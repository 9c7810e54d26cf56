#include "logs/file/mapped_file.hpp"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "logs/file/log_index.hpp"
#include "logs/file/seekable_log.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;

TEST(MappedFile, ContainsTheBytesOfItsFileAndIsMovable) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a");
  test::write_file(path, {1, 2, 3});
  MappedFile first(path);
  EXPECT_EQ(first.path(), path);
  EXPECT_EQ(Bytes(first.bytes().begin(), first.bytes().end()), (Bytes{1, 2, 3}));
  {
    const MappedFile second(std::move(first));
    EXPECT_EQ(second.path(), path);
    EXPECT_EQ(Bytes(second.bytes().begin(), second.bytes().end()), (Bytes{1, 2, 3}));
    EXPECT_TRUE(first.bytes().empty());  // NOLINT(bugprone-use-after-move): that is what is tested
  }
  test::write_file(folder.file("empty"), {});
  EXPECT_TRUE(MappedFile(folder.file("empty")).bytes().empty());
}

TEST(MappedFile, ReportsWhyItCannotBeRead) {
  const test::TemporaryFolder folder;
  const auto why_not = [](const std::string& path) {
    try {
      const MappedFile file(path);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(why_not(folder.file("a")),
            folder.file("a") + ": cannot be read: No such file or directory");
  EXPECT_EQ(why_not(folder.path()), folder.path() + ": is not a regular file");
  EXPECT_EQ(why_not("/dev/null"), "/dev/null: is not a regular file");
}

/// Returns a log of about `bytes` bytes, with events of about 10 kB.
Bytes long_log(std::size_t bytes) {
  Bytes out;
  for (std::int64_t i = 0; out.size() < bytes; ++i) {
    append_event({i, from_utime(1'000'000 + 1'000 * i), "A", Bytes(10'000, 7)}, out);
  }
  return out;
}

// A log file may become shorter while it is read: it is truncated or overwritten, or its disk
// fails.
TEST(MappedFile, ReportsATruncationDuringAScan) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  for (const std::uintmax_t left : {0U, 1U, 4'096U, 100'000U, 999'000U}) {
    test::write_file(path, long_log(1'000'000));
    const IndexedLog log(path);
    LogScan scan = log.scan();
    ASSERT_TRUE(scan.next());
    std::filesystem::resize_file(path, left);
    std::string why;
    try {
      while (scan.next()) {
      }
    } catch (const std::runtime_error& error) {
      why = error.what();
    }
    EXPECT_TRUE(why.starts_with(path + ": became shorter while it was read")) << left << why;
    std::filesystem::remove(path + ".index");
  }
}

TEST(MappedFile, KeepsOtherFilesReadableAfterATruncation) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  test::write_file(path, long_log(1'000'000));
  test::write_file(folder.file("b.lcmlog"), long_log(1'000'000));
  {
    const SeekableLog log(path);
    std::filesystem::resize_file(path, 0);
    EXPECT_THROW(log.events(from_utime(0), from_utime(2'000'000)), std::runtime_error);
  }
  const IndexedLog other(folder.file("b.lcmlog"));
  EXPECT_TRUE(other.survey().is_whole());
}

}  // namespace
}  // namespace vantage::logs
