#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace vantage::tools {

/// What a word says beside its letters.
enum class Ink { kGood, kWarning, kBad, kQuiet };
/// `text` in a terminal's colour (SGR), and plain after it.
std::string inked(const std::string& text, Ink ink);

/// The first `columns` characters (code points) of UTF-8 text. Colours of inked() take no room, and
/// what they begin is ended.
std::string cut_to(const std::string& line, std::size_t columns);

/// As many lines as fit on a screen, the last saying how many are missing; each cut to the width:
/// a line that wraps or scrolls could not be replaced. 0 rows or columns: no limit is known.
std::vector<std::string> fit(const std::vector<std::string>& lines, std::size_t rows,
                             std::size_t columns);

/// Lines on standard output that are replaced by the next ones, without scrolling; cut to the
/// terminal's size.
class Screen {
 public:
  /// Writes `lines` as printable(), with the colours of inked(). While NonBlockingOutput lives and
  /// the terminal has not accepted the screen before, this one is dropped and counted.
  void redraw(const std::vector<std::string>& lines);

 private:
  std::size_t lines_drawn_ = 0;
};

/// True when standard output is a terminal.
bool is_terminal();
/// True when it is one that shows colours: not a dumb one, nor one whose user wants none
/// (NO_COLOR).
bool has_colour();
/// Takes away what the terminal shows of keys pressed (^C) where the next line begins. Nothing
/// where neither standard output nor standard error is a terminal.
void clear_echo();
/// `word` as a shell reads it as one: between quotes where it has to be.
std::string shell_quoted(const std::string& word);
/// Writes one line as printable() and flushes it. Where nothing reads it, it is lost, and nothing
/// is thrown.
void print_line(const std::string& line, std::FILE* to = stdout);
/// The same of JSON, on one line; what is no UTF-8 in it (a file's name) is replaced.
void print_json(const nlohmann::ordered_json& json);

}  // namespace vantage::tools
