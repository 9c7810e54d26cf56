#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace vantage::tools {

/// Meaning of a colour.
enum class Emphasis { kGood, kWarning, kBad, kQuiet };
/// Returns `text` between the terminal's sequences (SGR) that set and reset its colour.
std::string coloured(const std::string& text, Emphasis emphasis);

/// Returns the first `columns` characters (code points) of UTF-8 text. Colours of coloured() are
/// not counted, and are ended at the cut.
std::string cut_to(const std::string& line, std::size_t columns);

/// Returns the lines that fit on a screen, each cut to the screen's width. If lines are missing,
/// the last line states their number. (Lines that wrap or scroll could not be replaced.) `rows` 0:
/// any number of lines; `columns` 0: lines of any length.
std::vector<std::string> fit(const std::vector<std::string>& lines, std::size_t rows,
                             std::size_t columns);

/// Block of lines on standard output, cut to the terminal's size. The next block replaces it
/// without scrolling.
class Screen {
 public:
  /// Writes `lines` through printable(), with the colours of coloured(). If a NonBlockingOutput
  /// exists and the terminal has not accepted the previous lines, `lines` are dropped and counted.
  void redraw(const std::vector<std::string>& lines);

 private:
  std::size_t lines_drawn_ = 0;
};

/// True if standard output is a terminal.
bool is_terminal();
/// True if standard output is a terminal with colours: TERM is not "dumb" and NO_COLOR is not set.
bool has_colour();
/// Removes echoed keys (^C) from the current line of the terminal. Does nothing if neither standard
/// output nor standard error is a terminal.
void clear_echo();
/// Returns `word` quoted for a shell, if it needs quotes.
std::string shell_quoted(const std::string& word);
/// Writes one line through printable() and flushes it. Write errors are ignored.
void print_line(const std::string& line, std::FILE* to = stdout);
/// Writes JSON on one line. Bytes that are not UTF-8 (in a file's name) are replaced.
void print_json(const nlohmann::ordered_json& json);

}  // namespace vantage::tools
