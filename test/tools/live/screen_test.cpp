#include "tools/live/screen.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tools/live/output.hpp"

namespace vantage::tools {
namespace {

using Lines = std::vector<std::string>;

TEST(CutTo, CountsCharactersNotBytes) {
  EXPECT_EQ(cut_to("abcdef", 3), "abc");
  EXPECT_EQ(cut_to("a → b", 3), "a →");
  EXPECT_EQ(cut_to("a → b", 5), "a → b");
  EXPECT_EQ(cut_to("a → b", 9), "a → b");
  EXPECT_EQ(cut_to("a", 0), "");
}

TEST(CutTo, IgnoresColourCodesAndResetsThem) {
  const std::string line = "ab" + coloured("cd", Emphasis::kBad) + "ef";
  EXPECT_EQ(cut_to(line, 6), line);
  EXPECT_EQ(cut_to(line, 3), "ab\x1b[1;31mc\x1b[0m");
  EXPECT_EQ(cut_to(line, 5), "ab\x1b[1;31mcd\x1b[0me\x1b[0m");
}

/// A pipe that is never read and holds at most `bytes`.
class FullPipe {
 public:
  FullPipe() {
    EXPECT_EQ(::pipe2(ends_.data(), O_NONBLOCK), 0);
    ::fcntl(ends_[1], F_SETPIPE_SZ, 4096);
  }
  ~FullPipe() {
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  FullPipe(const FullPipe&) = delete;
  FullPipe& operator=(const FullPipe&) = delete;
  FullPipe(FullPipe&&) = delete;
  FullPipe& operator=(FullPipe&&) = delete;

  [[nodiscard]] int writer() const { return ends_[1]; }
  [[nodiscard]] std::string read() const {
    std::string out(100'000, '\0');
    const ssize_t count = ::read(ends_[0], out.data(), out.size());
    out.resize(static_cast<std::size_t>(std::max<ssize_t>(0, count)));
    return out;
  }

 private:
  std::array<int, 2> ends_{};
};

TEST(OutputQueue, DropsAndCountsWholeTexts) {
  const FullPipe pipe;
  OutputQueue queue(pipe.writer());
  std::string expected;
  const std::string text(1'000, 'x');
  for (int i = 0; i < 200; ++i) {
    queue.write(std::to_string(i) + text + "\n");
  }
  EXPECT_FALSE(queue.flush());
  EXPECT_GT(queue.dropped(), 100);
  const std::int64_t kept = 200 - queue.dropped();
  for (std::int64_t i = 0; i < kept; ++i) {
    expected += std::to_string(i) + text + "\n";
  }
  std::string read;
  while (!queue.flush()) {
    read += pipe.read();
  }
  read += pipe.read();
  EXPECT_EQ(read, expected);
  queue.write("last\n");
  EXPECT_EQ(pipe.read(), "last\n");
}

TEST(PrintLine, WritesNoEscapeSequence) {
  for (const auto& [line, shown] :
       std::vector<std::pair<std::string, std::string>>{{"host \x1b[2J\x07\xc2\x9b"
                                                         "1m",
                                                         "host \\x1B[2J\\x07\\xC2\\x9B1m\n"},
                                                        {"ü\ttwo\nlines", "ü\ttwo\nlines\n"}}) {
    std::FILE* const file = std::tmpfile();
    ASSERT_NE(file, nullptr);
    print_line(line, file);
    std::rewind(file);
    std::string read(200, '\0');
    read.resize(std::fread(read.data(), 1, read.size(), file));
    EXPECT_EQ(read, shown);
    std::fclose(file);
  }
}

TEST(FitToScreen, LeavesSpaceForTheCursorAndReportsOmissions) {
  const Lines five{"1", "2", "3", "4", "5"};
  EXPECT_EQ(fit(five, 6, 80), five);
  EXPECT_EQ(fit(five, 5, 80), (Lines{"1", "2", "3", "... 2 more lines"}));
  EXPECT_EQ(fit(five, 3, 80), (Lines{"1", "... 4 more lines"}));
}

TEST(FitToScreen, DoesNotLimitWithoutTerminal) {
  const Lines lines(100, std::string(500, 'x'));
  EXPECT_EQ(fit(lines, 0, 0), lines);
}

}  // namespace
}  // namespace vantage::tools
