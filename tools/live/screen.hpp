#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace vantage::tools {

/// Lines on standard output that are replaced by the next ones, without scrolling.
class Screen {
 public:
  void redraw(const std::vector<std::string>& lines);

 private:
  std::size_t lines_drawn_ = 0;
};

/// True when standard output is a terminal.
bool is_terminal();
/// Writes one line to standard output and flushes it.
void print_line(const std::string& line);

}  // namespace vantage::tools
