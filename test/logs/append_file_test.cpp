#include "logs/record/append_file.hpp"

#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;

std::unique_ptr<AppendFile> opened(const std::string& path, Existing existing) {
  auto file = open_append_file(path, existing);
  if (!file.ok()) {
    ADD_FAILURE() << file.error().message;
    return nullptr;
  }
  return std::move(file).value();
}

TEST(OpenAppendFile, AppendsOverwritesOrRefuses) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  for (const Existing existing : {Existing::kRefuse, Existing::kAppend, Existing::kReplace}) {
    std::filesystem::remove(path);
    const auto fresh = opened(path, existing);
    EXPECT_EQ(fresh->size_bytes(), 0U) << "each mode creates a missing file";
  }
  test::write_file(path, {1, 2, 3});
  const auto refused = open_append_file(path, Existing::kRefuse);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().message, path + ": exists already, and no log is overwritten");
  {
    const auto file = opened(path, Existing::kAppend);
    EXPECT_EQ(file->size_bytes(), 3U);
    EXPECT_EQ(file->append(Bytes{4, 5}).value(), 2U);
    EXPECT_EQ(file->size_bytes(), 5U);
    EXPECT_EQ(test::read_file(path), (Bytes{1, 2, 3, 4, 5})) << "data is not buffered";
    EXPECT_FALSE(file->sync());
    EXPECT_FALSE(file->sync()) << "a second error is reported, too";
    EXPECT_FALSE(file->cut(4));
    EXPECT_EQ(file->size_bytes(), 4U);
    EXPECT_EQ(file->append(Bytes{6}).value(), 1U);
    EXPECT_TRUE(file->free_bytes().has_value());
  }
  EXPECT_EQ(test::read_file(path), (Bytes{1, 2, 3, 4, 6}));
  EXPECT_EQ(opened(path, Existing::kReplace)->size_bytes(), 0U);
  EXPECT_TRUE(test::read_file(path).empty());
  const auto status = std::filesystem::status(path).permissions();
  EXPECT_EQ(status & std::filesystem::perms::owner_all,
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST(OpenAppendFile, ReportsWhyItFailed) {
  const test::TemporaryFolder folder;
  const std::string missing = folder.file("missing/a.lcmlog");
  EXPECT_EQ(open_append_file(missing, Existing::kRefuse).error().message,
            missing + ": cannot be written: No such file or directory");
  EXPECT_EQ(open_append_file(folder.path(), Existing::kAppend).error().message,
            folder.path() + ": cannot be written: Is a directory");
}

TEST(AppendFile, ReportsWriteErrors) {
  const auto full = opened("/dev/full", Existing::kAppend);
  const auto taken = full->append(Bytes{1, 2});
  ASSERT_FALSE(taken.ok());
  EXPECT_EQ(taken.error().message, "/dev/full: cannot be written: No space left on device");
  EXPECT_EQ(full->size_bytes(), 0U);
  const auto unsynced = full->sync();
  ASSERT_TRUE(unsynced);
  EXPECT_EQ(unsynced->message,
            "/dev/full: the last data may not have been written to the disk: Invalid argument");
  const auto uncut = full->cut(0);
  ASSERT_TRUE(uncut);
  EXPECT_EQ(uncut->message, "/dev/full: its unfinished end cannot be cut off: Invalid argument");
}

// A limit on the file size emulates a disk that fills up during a write.
TEST(AppendFile, WritesUpToTheFreeSpace) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  const auto file = opened(path, Existing::kRefuse);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1'000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto some = file->append(Bytes(1'500, 7));
  const auto none = file->append(Bytes(500, 7));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ASSERT_TRUE(some.ok());
  EXPECT_EQ(some.value(), 1'000U);
  EXPECT_EQ(file->size_bytes(), 1'000U);
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().message, path + ": cannot be written: File too large");
}

TEST(NumberedPath, InsertsTheNumberBeforeTheLastDot) {
  EXPECT_EQ(numbered_path("lab.lcmlog", 3), "lab-3.lcmlog");
  EXPECT_EQ(numbered_path("/a.b/lab", 12), "/a.b/lab-12");
  EXPECT_EQ(numbered_path("logs/a.b.c", 2), "logs/a.b-2.c");
}

TEST(UnusedPath, TreatsADanglingLinkAsUsed) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.lcmlog");
  EXPECT_EQ(unused_path(path), path);
  std::filesystem::create_symlink(folder.file("nowhere"), path);
  test::write_file(folder.file("a-3.lcmlog"), {});
  EXPECT_EQ(unused_path(path), folder.file("a-2.lcmlog"));
  test::write_file(folder.file("a-2.lcmlog"), {});
  EXPECT_EQ(unused_path(path), folder.file("a-4.lcmlog"));
}

TEST(FreeBytesFor, AgreesWithTheFreeBytesOfAnOpenFile) {
  const test::TemporaryFolder folder;
  const auto file = opened(folder.file("a.lcmlog"), Existing::kRefuse);
  const auto of_path = free_bytes_for(folder.file("b.lcmlog"));
  const auto of_file = file->free_bytes();
  ASSERT_TRUE(of_path && of_file);
  // The tolerance covers writes of other processes between the two queries.
  EXPECT_NEAR(static_cast<double>(*of_path), static_cast<double>(*of_file),
              0.1 * static_cast<double>(*of_file) + 1e9);
}

}  // namespace
}  // namespace vantage::logs
