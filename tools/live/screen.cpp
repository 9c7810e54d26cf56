#include "tools/live/screen.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace vantage::tools {

std::string inked(const std::string& text, Ink ink) {
  constexpr const char* kCodes[] = {"32", "33", "1;31", "2"};
  return fmt::format("\x1b[{}m{}\x1b[0m", kCodes[static_cast<int>(ink)], text);
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
  // The cursor needs a row of its own.
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

void Screen::redraw(const std::vector<std::string>& all_lines) {
  winsize size{};
  ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);  // leaves zeros when it is no terminal
  const std::vector<std::string> lines = fit(all_lines, size.ws_row, size.ws_col);
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

bool has_colour() {
  const char* unwanted = std::getenv("NO_COLOR");
  const char* kind = std::getenv("TERM");
  return is_terminal() && (unwanted == nullptr || *unwanted == '\0') && kind != nullptr &&
         std::string(kind) != "dumb";
}

void clear_echo() {
  std::FILE* terminal = is_terminal() ? stdout : ::isatty(STDERR_FILENO) == 1 ? stderr : nullptr;
  if (terminal != nullptr) {
    fmt::print(terminal, "\r\x1b[K");
    std::fflush(terminal);
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

void print_line(const std::string& line, std::FILE* to) {
  std::fwrite(line.data(), 1, line.size(), to);
  std::fputc('\n', to);
  std::fflush(to);
}

}  // namespace vantage::tools
