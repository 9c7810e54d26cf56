#include "scenario/reader/yaml_value.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <system_error>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::scenario {
namespace {

std::string quoted(const std::string& text) {
  constexpr std::size_t kShown = 40;
  return text.size() <= kShown ? "'" + text + "'" : "'" + text.substr(0, kShown) + "…'";
}

/// What the node is, for the second half of a refusal.
std::string found(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      return quoted(node.Scalar());
    case YAML::NodeType::Sequence:
      return "a list";
    case YAML::NodeType::Map:
      return "a mapping";
    default:
      return "nothing";
  }
}

/// Reads all of `text` as a T; std::errc() on success.
template <class T>
std::errc read_whole(const std::string& text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc()) {
    return error;
  }
  return stop == end ? std::errc() : std::errc::invalid_argument;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// `name` without the unit at its end.
std::string_view without_unit(std::string_view name) {
  static constexpr std::array<std::string_view, 28> kUnits = {
      "m",  "mm", "cm",  "km",  "ft",  "s",    "ms",    "us",   "ns",  "min",
      "h",  "hz", "khz", "rad", "deg", "mrad", "mps",   "kmh",  "kph", "mph",
      "m2", "m3", "ms2", "rps", "rpm", "mps2", "degps", "radps"};
  const std::size_t underscore = name.rfind('_');
  if (underscore == std::string_view::npos) {
    return name;
  }
  const bool has_unit =
      std::find(kUnits.begin(), kUnits.end(), name.substr(underscore + 1)) != kUnits.end();
  return has_unit ? name.substr(0, underscore) : name;
}

}  // namespace

bool Range::contains(double value) const {
  const bool over_min = is_min_excluded ? value > min : value >= min;
  const bool under_max = is_max_excluded ? value < max : value <= max;
  return over_min && under_max;
}

std::string Range::words() const {
  const std::string low = fmt::format("{} {}", is_min_excluded ? "above" : "at least", min);
  const std::string high = fmt::format("{} {}", is_max_excluded ? "below" : "at most", max);
  if (std::isinf(max)) {
    return std::isinf(min) ? "a number" : low;
  }
  return std::isinf(min) ? high : low + " and " + high;
}

Range Range::scaled(double factor) const {
  return {min * factor, max * factor, is_min_excluded, is_max_excluded};
}

void Value::refuse(const std::string& what) const {
  throw StartupError(path.empty() ? fmt::format("{}:{}: {}", file, line, what)
                                  : fmt::format("{}:{}: {}: {}", file, line, path, what));
}

std::string Value::plain_number() const {
  if (!node.IsScalar()) {
    refuse("must be a number, is " + found(node));
  }
  if (node.Tag() != "?") {
    refuse(fmt::format("must be a plain number, is the text {}", found(node)));
  }
  const std::string& text = node.Scalar();
  return text.size() > 1 && text.front() == '+' && text[1] != '-' ? text.substr(1) : text;
}

double Value::number(const Range& range) const {
  const std::string text = plain_number();
  double value = 0.0;
  const std::errc error = read_whole(text, value);
  const bool is_yaml_infinity = text == ".inf" || text == "-.inf" || text == ".nan";
  if (is_yaml_infinity || error == std::errc::result_out_of_range ||
      (error == std::errc() && !std::isfinite(value))) {
    refuse("must be a finite number, is " + found(node));
  }
  if (error != std::errc()) {
    refuse("must be a number, is " + found(node));
  }
  if (!range.contains(value)) {
    refuse(fmt::format("must be {}, is {}", range.words(), value));
  }
  return value;
}

std::int64_t Value::integer(std::int64_t min, std::int64_t max) const {
  std::int64_t value = 0;
  const std::errc error = read_whole(plain_number(), value);
  if (error == std::errc::invalid_argument) {
    refuse("must be a whole number, is " + found(node));
  }
  if (error != std::errc() || value < min || value > max) {
    refuse(fmt::format("must be at least {} and at most {}, is {}", min, max, found(node)));
  }
  return value;
}

std::uint64_t Value::unsigned_integer() const {
  std::uint64_t value = 0;
  if (read_whole(plain_number(), value) != std::errc()) {
    refuse(fmt::format("must be a whole number of at least 0 and at most {}, is {}",
                       std::numeric_limits<std::uint64_t>::max(), found(node)));
  }
  return value;
}

bool Value::flag() const {
  if (!node.IsScalar() || node.Tag() != "?" ||
      (node.Scalar() != "true" && node.Scalar() != "false")) {
    refuse("must be true or false, is " + found(node));
  }
  return node.Scalar() == "true";
}

std::string Value::text() const {
  if (!node.IsScalar()) {
    refuse("must be a text, is " + found(node));
  }
  if (node.Scalar().empty()) {
    refuse("must not be empty");
  }
  return node.Scalar();
}

Eigen::Vector2d Value::point(const Range& range) const {
  if (!node.IsSequence() || node.size() != 2) {
    refuse(fmt::format("must be a list of two numbers [x, y], is {}{}", found(node),
                       node.IsSequence() ? fmt::format(" of {}", node.size()) : ""));
  }
  const std::vector<Value> coordinates = items();
  return {coordinates[0].number(range), coordinates[1].number(range)};
}

std::vector<Value> Value::items() const {
  if (!node.IsSequence()) {
    refuse("must be a list, is " + found(node));
  }
  std::vector<Value> values;
  for (const YAML::Node& item : node) {
    values.push_back({item, file, fmt::format("{}[{}]", path, values.size()), line_of(item, line)});
  }
  return values;
}

std::ptrdiff_t Value::index_of_word(const std::vector<std::string_view>& words) const {
  const auto word =
      std::find(words.begin(), words.end(), node.IsScalar() ? node.Scalar() : std::string());
  if (word == words.end()) {
    refuse(fmt::format("must be one of {}; is {}", comma_separated(words), found(node)));
  }
  return word - words.begin();
}

std::string comma_separated(const std::vector<std::string_view>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

int line_of(const YAML::Node& node, int fallback) {
  const int line = node.Mark().line;
  // A null in a list carries no place of its own.
  return line < 0 || node.IsNull() ? fallback : line + 1;
}

bool differs_in_unit(std::string_view a, std::string_view b) {
  return a != b && without_unit(a) == without_unit(b);
}

std::string nearest_word(std::string_view word, const std::vector<std::string_view>& known) {
  constexpr std::size_t kNear = 2;
  std::string_view best;
  std::size_t best_distance = std::max(kNear, word.size() / 3) + 1;
  for (const std::string_view candidate : known) {
    const std::size_t distance =
        differs_in_unit(word, candidate) ? 0 : edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return std::string(best);
}

}  // namespace vantage::scenario
