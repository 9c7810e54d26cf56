#include "tools/live/screen.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace vantage::tools {

void Screen::redraw(const std::vector<std::string>& lines) {
  std::string out;
  if (lines_drawn_ > 0) {
    out += fmt::format("\x1b[{}A", lines_drawn_);  // cursor up
  }
  for (const std::string& line : lines) {
    out += "\r" + line + "\x1b[K\n";  // clear what is left of the old line
  }
  out += "\x1b[J";
  lines_drawn_ = lines.size();
  std::fwrite(out.data(), 1, out.size(), stdout);
  std::fflush(stdout);
}

bool is_terminal() { return ::isatty(STDOUT_FILENO) == 1; }

void print_line(const std::string& line) {
  std::fwrite(line.data(), 1, line.size(), stdout);
  std::fputc('\n', stdout);
  std::fflush(stdout);
}

}  // namespace vantage::tools
