#include "tools/live/screen.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "core/utf8.hpp"
#include "tools/live/output.hpp"

namespace vantage::tools {
namespace {

constexpr std::string_view kPlain = "\x1b[0m";
/// SGR sequences by Emphasis, and the sequence that resets the colour.
constexpr std::array<std::string_view, 5> kColours{"\x1b[32m", "\x1b[33m", "\x1b[1;31m", "\x1b[2m",
                                                   kPlain};

}  // namespace

std::string coloured(const std::string& text, Emphasis emphasis) {
  return fmt::format("{}{}{}", kColours[static_cast<std::size_t>(emphasis)], text, kPlain);
}

std::string cut_to(const std::string& line, std::size_t columns) {
  std::size_t characters = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\x1b') {
      i = std::min(line.find('m', i), line.size());
      continue;
    }
    const bool begins_one = (static_cast<unsigned char>(line[i]) & 0xC0U) != 0x80U;
    if (begins_one && characters++ == columns) {
      const std::string kept = line.substr(0, i);
      return kept.find('\x1b') == std::string::npos ? kept : kept + "\x1b[0m";
    }
  }
  return line;
}

std::vector<std::string> fit(const std::vector<std::string>& lines, std::size_t rows,
                             std::size_t columns) {
  std::vector<std::string> out = lines;
  // Leave one row for the cursor.
  if (rows > 2 && lines.size() > rows - 1) {
    out.resize(rows - 2);
    out.push_back(fmt::format("... {} more lines", lines.size() - (rows - 2)));
  }
  if (columns > 0) {
    for (std::string& line : out) {
      line = cut_to(line, columns);
    }
  }
  return out;
}

namespace {

/// Applies printable() but keeps the colours of coloured().
std::string shown(const std::string& line) {
  std::string out;
  std::size_t begin = 0;
  for (std::size_t at = line.find('\x1b'); at != std::string::npos;
       at = line.find('\x1b', at + 1)) {
    const auto colour = std::find_if(kColours.begin(), kColours.end(), [&](std::string_view each) {
      return line.compare(at, each.size(), each) == 0;
    });
    if (colour != kColours.end()) {
      out += printable(std::string_view(line).substr(begin, at - begin));
      out += *colour;
      begin = at + colour->size();
    }
  }
  return out + printable(std::string_view(line).substr(begin));
}

void put(std::string_view text, std::FILE* to) {
  if (OutputQueue* const queue = NonBlockingOutput::queue_of(to)) {
    queue->write(text);
    return;
  }
  std::fwrite(text.data(), 1, text.size(), to);
  std::fflush(to);
}

}  // namespace

void Screen::redraw(const std::vector<std::string>& all_lines) {
  if (OutputQueue* const queue = NonBlockingOutput::queue_of(stdout);
      queue != nullptr && !queue->flush()) {
    queue->count_dropped();
    return;
  }
  winsize size{};
  ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);  // size stays zero without a terminal
  std::vector<std::string> lines;
  for (const std::string& line : all_lines) {
    lines.push_back(shown(line));
  }
  lines = fit(lines, size.ws_row, size.ws_col);
  std::string out;
  if (lines_drawn_ > 0) {
    out += fmt::format("\x1b[{}A", lines_drawn_);  // moves the cursor up
  }
  for (const std::string& line : lines) {
    out += "\r" + line + "\x1b[K\n";  // clear the rest of the old line
  }
  out += "\x1b[J";
  lines_drawn_ = lines.size();
  put(out, stdout);
}

bool is_terminal() { return ::isatty(STDOUT_FILENO) == 1; }

bool has_colour() {
  const char* unwanted = std::getenv("NO_COLOR");
  const char* kind = std::getenv("TERM");
  return is_terminal() && (unwanted == nullptr || *unwanted == '\0') && kind != nullptr &&
         std::string(kind) != "dumb";
}

void clear_echo() {
  std::FILE* terminal = is_terminal() ? stdout : ::isatty(STDERR_FILENO) == 1 ? stderr : nullptr;
  if (terminal != nullptr) {
    put("\r\x1b[K", terminal);
  }
}

std::string shell_quoted(const std::string& word) {
  const bool is_plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
    constexpr std::string_view kPlain = "_-./:=@%+,";
    const auto byte = static_cast<unsigned char>(c);
    return std::isalnum(byte) != 0 || byte >= 0x80U || kPlain.find(c) != std::string_view::npos;
  });
  if (is_plain) {
    return word;
  }
  std::string out = "'";
  for (const char c : word) {
    out += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return out + "'";
}

void print_json(const nlohmann::ordered_json& json) {
  print_line(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void print_line(const std::string& line, std::FILE* to) { put(printable(line) + "\n", to); }

}  // namespace vantage::tools
