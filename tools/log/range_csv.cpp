#include "tools/log/range_csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/check.hpp"
#include "core/utf8.hpp"

namespace vantage::tools {
namespace {

constexpr std::string_view kBlank = " \t\r\f\v";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

std::string small_letters(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return out;
}

struct Unit {
  std::string_view word;
  double factor;  ///< factor that converts to seconds or metres
};
constexpr std::array kTimes = {Unit{"s", 1.0},   Unit{"sec", 1.0},  Unit{"seconds", 1.0},
                               Unit{"ms", 1e-3}, Unit{"us", 1e-6},  Unit{"µs", 1e-6},
                               Unit{"ns", 1e-9}, Unit{"min", 60.0}, Unit{"utime", 1e-6}};
constexpr std::array kLengths = {Unit{"m", 1.0},     Unit{"meters", 1.0}, Unit{"metres", 1.0},
                                 Unit{"cm", 1e-2},   Unit{"mm", 1e-3},    Unit{"km", 1e3},
                                 Unit{"ft", 0.3048}, Unit{"in", 0.0254}};

std::span<const Unit> units_of(Quantity quantity) {
  return quantity == Quantity::kTime     ? std::span<const Unit>(kTimes)
         : quantity == Quantity::kLength ? std::span<const Unit>(kLengths)
                                         : std::span<const Unit>();
}

/// Normalises a heading to lower case with underscores: "Range [cm]" becomes "range_cm".
std::string plain(std::string_view heading) {
  std::string out;
  for (const char c : small_letters(heading)) {
    const bool between = std::string_view(" _-./()[]{}:").find(c) != std::string_view::npos;
    if (!between) {
      out += c;
    } else if (!out.empty() && out.back() != '_') {
      out += '_';
    }
  }
  while (!out.empty() && out.back() == '_') {
    out.pop_back();
  }
  return out;
}

/// Returns the factor that converts numbers under `heading` to s or m; nullopt if `heading` is not
/// a name of `column`.
std::optional<double> factor_of(const std::string& heading, const ColumnSpec& column) {
  for (const std::string_view name : column.names) {
    if (heading == name) {
      return name == "utime" && column.quantity == Quantity::kTime ? 1e-6 : 1.0;
    }
    for (const Unit& unit : units_of(column.quantity)) {
      if (heading == fmt::format("{}_{}", name, unit.word)) {
        return unit.factor;
      }
    }
  }
  return std::nullopt;
}

/// Parses a number. Returns NaN for words that mean a missing number; nullopt for other text.
std::optional<double> number_in(std::string_view cell) {
  const std::string word = small_letters(cell);
  for (const std::string_view none : {"", "nan", "-nan", "+nan", "na", "n/a", "null", "none"}) {
    if (word == none) {
      return std::numeric_limits<double>::quiet_NaN();
    }
  }
  const bool has_plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  const char* begin = word.data() + (has_plus ? 1 : 0);
  const char* end = word.data() + word.size();
  double number = 0.0;
  const auto [stop, error] = std::from_chars(begin, end, number);
  if (stop != end || error == std::errc::invalid_argument) {
    return std::nullopt;
  }
  return error == std::errc() ? number : std::numeric_limits<double>::quiet_NaN();
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& name, std::span<const ColumnSpec> columns)
      : text_(text), name_(name), columns_(columns) {}

  Table read() {
    if (text_.starts_with("\xef\xbb\xbf")) {
      text_.remove_prefix(3);
    }
    Table table;
    bool has_begun = false;
    while (!text_.empty()) {
      line_ += 1 + ends_in_record_;
      const std::string_view record = take_record();
      const bool is_whole = has_end_;
      const std::string_view content = trimmed(record);
      if (content.empty() || content.front() == '#' || content.front() == '%') {
        continue;
      }
      if (!has_begun) {
        has_begun = true;
        choose_separator(content);
        if (is_header(content)) {
          take_header(content);
          continue;
        }
        take_order(content);
      }
      if (content == header_) {
        continue;  // repeated header: the file was concatenated
      }
      take_row(content, is_whole, table);
    }
    if (!has_begun) {
      throw StartupError(fmt::format("{}: is empty; expected columns {}", name_, expected()));
    }
    return table;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw StartupError(fmt::format("{}:{}: {}", name_, line_, what));
  }

  [[nodiscard]] std::string expected() const {
    std::vector<std::string_view> words;
    for (const ColumnSpec& column : columns_) {
      words.push_back(column.names.front());
    }
    return fmt::format("{}", fmt::join(words, ", "));
  }

  static bool is_comment(std::string_view line) {
    const std::string_view content = trimmed(line);
    return !content.empty() && (content.front() == '#' || content.front() == '%');
  }

  [[nodiscard]] bool separates(char c) const {
    return is_chosen_ ? c == separator_
                      : std::string_view(";,\t").find(c) != std::string_view::npos;
  }

  /// Removes the next record from the text and returns it. A record has several lines if a quoted
  /// cell contains ends of lines. Sets has_end_ and ends_in_record_.
  std::string_view take_record() {
    std::size_t end = std::min(text_.find('\n'), text_.size());
    ends_in_record_ = 0;
    has_end_ = end < text_.size();
    const std::string_view line = text_.substr(0, end);
    if (line.find('"') != std::string_view::npos && !is_comment(line)) {
      const std::size_t closed = end_of_quoted_record();
      const bool is_last_line = end + 1 >= text_.size();
      if (closed == std::string_view::npos && !is_last_line) {
        refuse("a quotation mark is not closed; expected a second one");
      }
      has_end_ = closed < text_.size();
      end = std::min(closed, text_.size());
      const std::string_view record = text_.substr(0, end);
      ends_in_record_ = static_cast<std::size_t>(std::count(record.begin(), record.end(), '\n'));
    }
    const std::string_view record = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    return record;
  }

  /// Returns the end of the record at the beginning of the text; npos if the text ends within
  /// quotes. A quote opens a cell only at the cell's beginning; two quotes in a quoted cell mean
  /// one.
  [[nodiscard]] std::size_t end_of_quoted_record() const {
    bool is_quoted = false;
    bool may_open = true;
    for (std::size_t at = 0; at < text_.size(); ++at) {
      const char c = text_[at];
      if (is_quoted) {
        is_quoted = c != '"';
        may_open = !is_quoted;
      } else if (c == '\n') {
        return at;
      } else if (c == '"' && may_open) {
        is_quoted = true;
      } else {
        const bool is_blank = kBlank.find(c) != std::string_view::npos;
        may_open = separates(c) || (is_blank && may_open);
      }
    }
    return is_quoted ? std::string_view::npos : text_.size();
  }

  static std::string without_quoted(std::string_view line) {
    std::string out;
    bool is_quoted = false;
    for (const char c : line) {
      is_quoted = is_quoted != (c == '"');
      out += is_quoted ? '"' : c;
    }
    return out;
  }

  void choose_separator(std::string_view record) {
    const std::string line = without_quoted(record);
    is_chosen_ = true;
    for (const char separator : {';', ',', '\t'}) {
      if (line.find(separator) != std::string::npos) {
        separator_ = separator;
        return;
      }
    }
    separator_ = ' ';
  }

  /// Returns the text of the quoted cell at the beginning of `line`. Sets `end` to the position of
  /// the separator after it.
  std::string unquoted(std::string_view line, std::size_t& end) const {
    std::string text;
    std::size_t at = 1;
    for (; at < line.size(); ++at) {
      const bool is_doubled = line.substr(at, 2) == "\"\"";
      if (line[at] == '"' && !is_doubled) {
        break;
      }
      text += line[at];
      at += is_doubled ? 1 : 0;
    }
    const std::size_t behind = std::min(at + 1, line.size());
    end = line.find(separator_, behind);
    text += trimmed(line.substr(behind, end - behind));
    return text;
  }

  /// Splits a line into cells. The result is valid until the next call.
  std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    unquoted_.clear();
    while (true) {
      std::size_t end = line.find(separator_);
      std::string_view cell = trimmed(line.substr(0, end));
      if (!cell.empty() && cell.front() == '"') {
        unquoted_.push_back(unquoted(line.substr(line.find('"')), end));
        end += end == std::string_view::npos ? 0 : line.find('"');
        cell = trimmed(unquoted_.back());
      }
      cells.push_back(cell);
      if (end == std::string_view::npos) {
        return cells;
      }
      line.remove_prefix(end + 1);
      if (separator_ == ' ') {
        line = trimmed(line);
      }
    }
  }

  bool is_header(std::string_view line) {
    const auto cells = cells_of(line);
    return std::none_of(cells.begin(), cells.end(), [](std::string_view cell) {
      const auto number = number_in(cell);
      return number && !std::isnan(*number);
    });
  }

  void take_header(std::string_view line) {
    header_ = line;
    const auto headings = cells_of(line);
    cells_ = headings.size();
    for (const ColumnSpec& column : columns_) {
      std::optional<Place> place;
      for (std::size_t i = 0; i < headings.size(); ++i) {
        if (const auto factor = factor_of(plain(headings[i]), column)) {
          if (place) {
            refuse(fmt::format("two columns contain the {}: '{}' and '{}'; expected one",
                               column.names.front(), readable(headings[place->cell]),
                               readable(headings[i])));
          }
          place = Place{i, *factor};
        }
      }
      if (!place) {
        constexpr std::size_t kShown = 80;
        refuse(fmt::format("no column '{}' with a known unit in '{}'; expected {}",
                           column.names.front(), readable(line.substr(0, kShown)), expected()));
      }
      places_.push_back(*place);
    }
  }

  void take_order(std::string_view line) {
    cells_ = cells_of(line).size();
    if (cells_ != columns_.size()) {
      refuse(fmt::format("{} cells and no header; expected a header with {}", cells_, expected()));
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      places_.push_back({i, 1.0});
    }
  }

  void take_row(std::string_view line, bool is_whole, Table& table) {
    const auto cells = cells_of(line);
    if (cells.size() < cells_ && !is_whole) {
      table.is_torn = true;
      return;
    }
    const bool has_more =
        std::any_of(cells.begin() + static_cast<std::ptrdiff_t>(std::min(cells_, cells.size())),
                    cells.end(), [](auto cell) { return !cell.empty(); });
    if (cells.size() < cells_ || has_more) {
      refuse(fmt::format("{} cells; expected {}, as in the first line", cells.size(), cells_));
    }
    TableRow row;
    bool is_finite = true;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const std::string_view cell = cells[places_[i].cell];
      if (columns_[i].quantity == Quantity::kName) {
        row.name = readable(cell);
        is_finite = is_finite && !cell.empty();
        continue;
      }
      const std::optional<double> number = number_in(cell);
      if (!number) {
        refuse(
            fmt::format("{} '{}'; expected a number", columns_[i].names.front(), readable(cell)));
      }
      is_finite = is_finite && std::isfinite(*number);
      row.numbers.push_back(*number * places_[i].factor);
    }
    if (is_finite) {
      table.rows.push_back(std::move(row));
    } else {
      ++table.not_finite;
    }
  }

  struct Place {
    std::size_t cell = 0;
    double factor = 1.0;
  };

  std::string_view text_;
  const std::string& name_;
  std::span<const ColumnSpec> columns_;
  char separator_ = ',';
  bool is_chosen_ = false;          ///< true once separator_ is determined
  std::size_t line_ = 0;            ///< line in which the record begins
  std::size_t ends_in_record_ = 0;  ///< number of ends of lines within the record
  bool has_end_ = true;             ///< an end of line follows the record
  std::deque<std::string> unquoted_;
  std::string_view header_;
  std::size_t cells_ = 0;      ///< expected number of cells per line
  std::vector<Place> places_;  ///< cell of each column of columns_
};

}  // namespace

Table parse_table(std::string_view text, const std::string& name,
                  std::span<const ColumnSpec> columns) {
  return Reader(text, name, columns).read();
}

Table read_table(const std::string& path, std::span<const ColumnSpec> columns) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw StartupError(path + ": no such file");
  }
  std::ifstream file(path, std::ios::binary);
  if (std::filesystem::is_directory(path, error) || !file) {
    throw StartupError(path + ": cannot be read; expected a table (CSV)");
  }
  constexpr std::uintmax_t kBytesMax = std::uintmax_t{256} << 20U;
  if (const auto size = std::filesystem::file_size(path, error); !error && size > kBytesMax) {
    throw StartupError(path + ": must be at most 256 MiB; expected a table (CSV)");
  }
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return parse_table(text, path, columns);
}

}  // namespace vantage::tools
