#include "core/write_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage {
namespace {

namespace fs = std::filesystem;

class WriteFile : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  static std::string text_of(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  static std::string complaint(const std::function<void()>& action) {
    try {
      action();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
  const test::TemporaryFolder folder_;
};

TEST_F(WriteFile, WritesExactlyTheText) {
  write_file(file("a"), "long ago");
  write_file(file("a"), "now");
  EXPECT_EQ(text_of(file("a")), "now");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(WriteFile, ReportsFileAndReason) {
  EXPECT_EQ(complaint([&] { write_file(file("no/where"), "x"); }),
            file("no/where") + ": cannot be written: No such file or directory");
  EXPECT_EQ(complaint([&] { require_writable(file("no/where")); }),
            file("no/where") + ": cannot be written: No such file or directory");
  EXPECT_EQ(complaint([&] { require_writable(folder_.path()); }),
            folder_.path() + ": cannot be written: Is a directory");
  write_file(file("a"), "x");
  EXPECT_EQ(complaint([&] { require_writable(file("a/b")); }),
            file("a/b") + ": cannot be written: Not a directory");
}

TEST_F(WriteFile, WritesDirectlyToNonRegularFile) {
  EXPECT_EQ(complaint([] { write_file("/dev/full", "x"); }),
            "/dev/full: cannot be written: No space left on device");
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_NO_THROW(write_file("/dev/null", "x"));
}

TEST_F(WriteFile, ReportsNoErrorOnSuccess) {
  EXPECT_NO_THROW(require_writable(file("new")));
  write_file(file("a"), "x");
  EXPECT_NO_THROW(require_writable(file("a")));
  EXPECT_EQ(text_of(file("a")), "x");
}

}  // namespace
}  // namespace vantage
