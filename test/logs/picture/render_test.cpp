#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "core/write_file.hpp"
#include "logs/picture/picture.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::logs {
namespace {

namespace fs = std::filesystem;

/// Fixture in which programs are searched for in the test's own folder only.
class RenderPngCommand : public ::testing::Test {
 protected:
  RenderPngCommand() { ::setenv("PATH", folder_.path().c_str(), 1); }
  ~RenderPngCommand() override { ::setenv("PATH", before_.c_str(), 1); }
  RenderPngCommand(const RenderPngCommand&) = delete;
  RenderPngCommand& operator=(const RenderPngCommand&) = delete;

  /// Replaces rsvg-convert by a shell script with these lines.
  void draws_by(const std::string& lines) {
    const std::string path = folder_.file("rsvg-convert");
    write_file(path, "#!/bin/sh\n" + lines);
    fs::permissions(path, fs::perms::owner_all);
  }
  [[nodiscard]] std::string outcome() const {
    try {
      const Result<std::string> png = render_png(folder_.file("a.svg"), folder_.file("a.png"));
      return png.ok() ? "drawn: " + png.value() : png.error().message;
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  }

  test::TemporaryFolder folder_;
  std::string before_ = std::getenv("PATH");
};

TEST_F(RenderPngCommand, NamesThePackageToInstall) {
  EXPECT_EQ(outcome(), "no PNG: rsvg-convert is not installed (apt install librsvg2-bin)");
}

TEST_F(RenderPngCommand, PassesBothPathsToTheProgram) {
  draws_by("[ \"$1\" = --format=png ] && [ \"$3\" = \"" + folder_.file("a.svg") +
           "\" ] && echo drawn > \"${2#--output=}\"\n");
  const std::string png_path = folder_.file("a.png");
  EXPECT_EQ(outcome(), "drawn: " + png_path);
  std::ifstream file(png_path);
  std::string word;
  EXPECT_TRUE(file >> word);
  EXPECT_EQ(word, "drawn");
  EXPECT_FALSE(fs::exists(png_path + ".part")) << "a complete file is renamed";
}

TEST_F(RenderPngCommand, RemovesTheFileOfAFailedProgram) {
  const std::string png_path = folder_.file("a.png");
  draws_by("echo half > \"${2#--output=}\"\nexit 3\n");
  EXPECT_EQ(outcome(),
            png_path + ": cannot be written: rsvg-convert failed on " + folder_.file("a.svg"));
  EXPECT_FALSE(fs::exists(png_path));
  EXPECT_FALSE(fs::exists(png_path + ".part"));
  draws_by("exit 0\n");  // succeeds without writing a file
  EXPECT_EQ(outcome(), png_path + ": cannot be written: No such file or directory");
}

}  // namespace
}  // namespace vantage::logs
