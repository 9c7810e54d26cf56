#include "logs/file/mapped_file.hpp"

#include <filesystem>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;

TEST(MappedFile, HasTheBytesOfItsFileAndHandsThemOn) {
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

TEST(MappedFile, SaysWhyItCannotBeRead) {
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
  EXPECT_EQ(why_not(folder.path()), folder.path() + ": not a file");
  EXPECT_EQ(why_not("/dev/null"), "/dev/null: not a file");
}

}  // namespace
}  // namespace vantage::logs
