#include "scenario/reader/value.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <system_error>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/utf8.hpp"

namespace vantage::scenario {
namespace {

/// Returns the part of an error message that describes the node that was found.
std::string found(const Node& node) {
  switch (node.kind) {
    case Node::Kind::kList:
      return "a list";
    case Node::Kind::kMapping:
      return "a mapping";
    case Node::Kind::kNothing:
      return "nothing";
    default:
      return "'" + shortened(node.text) + "'";
  }
}

/// Parses all of `text` as a T; returns std::errc() on success.
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

/// Returns `name` without the unit at its end.
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

std::string Range::description() const {
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
  const std::string where = path.empty() ? "" : path + ": ";
  throw StartupError(fmt::format("{}:{}: {}", file, line, readable(where + what)));
}

std::string Value::plain_number() const {
  if (!node->is_scalar()) {
    refuse("must be a number, is " + found(*node));
  }
  if (node->kind == Node::Kind::kText) {
    refuse("must be a plain number, is the text " + found(*node));
  }
  const std::string& text = node->text;
  return text.size() > 1 && text.front() == '+' && text[1] != '-' ? text.substr(1) : text;
}

void Value::note(std::string values) const {
  if (keys != nullptr) {
    keys->note({path, std::move(values), "", false, line});
  }
}

double Value::number(const Range& range) const {
  if (keys != nullptr) {
    note(range.description());
  }
  const std::string text = plain_number();
  double value = 0.0;
  const std::errc error = read_whole(text, value);
  const bool is_yaml_infinity = text == ".inf" || text == "-.inf" || text == ".nan";
  if (is_yaml_infinity || (error == std::errc() && !std::isfinite(value))) {
    refuse("must be a finite number, is " + found(*node));
  }
  if (error == std::errc::result_out_of_range) {
    refuse("must be a finite number that a double can hold, is " + found(*node));
  }
  if (error != std::errc()) {
    refuse("must be a number, is " + found(*node));
  }
  if (!range.contains(value)) {
    refuse(fmt::format("must be {}, is {}", range.description(), value));
  }
  return value;
}

std::int64_t Value::integer(std::int64_t min, std::int64_t max) const {
  if (keys != nullptr) {
    note(whole_words(min, max));
  }
  std::int64_t value = 0;
  const std::errc error = read_whole(plain_number(), value);
  if (error == std::errc::invalid_argument) {
    refuse("must be a whole number, is " + found(*node));
  }
  if (error != std::errc() || value < min || value > max) {
    refuse(fmt::format("must be at least {} and at most {}, is {}", min, max, found(*node)));
  }
  return value;
}

std::uint64_t Value::unsigned_integer() const {
  note("a whole number, at least 0");
  std::uint64_t value = 0;
  if (read_whole(plain_number(), value) != std::errc()) {
    refuse(fmt::format("must be a whole number of at least 0 and at most {}, is {}",
                       std::numeric_limits<std::uint64_t>::max(), found(*node)));
  }
  return value;
}

bool Value::flag() const {
  note("true or false");
  const bool is_bare = node->kind == Node::Kind::kLiteral || node->kind == Node::Kind::kWord;
  if (!is_bare || (node->text != "true" && node->text != "false")) {
    refuse("must be true or false, is " + found(*node));
  }
  return node->text == "true";
}

std::string Value::text() const {
  std::string text = text_or_empty();
  if (text.empty()) {
    refuse("must not be empty");
  }
  return text;
}

std::string Value::text_or_empty() const {
  note("text");
  if (node->kind == Node::Kind::kLiteral) {
    refuse("must be text in quotes, is " + shortened(node->text));
  }
  if (!node->is_scalar()) {
    refuse("must be text, is " + found(*node));
  }
  return node->text;
}

Eigen::Vector2d Value::point(const Range& range) const {
  const std::vector<double> coordinates = numbers(2, "two numbers [x, y]", range);
  return {coordinates[0], coordinates[1]};
}

std::vector<Value> Value::items() const {
  note("list");
  if (node->kind != Node::Kind::kList) {
    refuse("must be a list, is " + found(*node));
  }
  std::vector<Value> values;
  values.reserve(node->items.size());
  for (const Node* item : node->items) {
    values.push_back(child_of(*this, fmt::format("{}[{}]", path, values.size()), *item, *item));
  }
  return values;
}

std::vector<Value> Value::items(std::size_t count, std::string_view shape) const {
  const bool is_list = node->kind == Node::Kind::kList;
  if (!is_list || node->items.size() != count) {
    refuse(fmt::format("must be a list of {}, is {}{}", shape, found(*node),
                       is_list ? fmt::format(" of {}", node->items.size()) : ""));
  }
  std::vector<Value> out = items();
  note(std::string(shape));
  return out;
}

std::vector<double> Value::numbers(std::size_t count, std::string_view shape,
                                   const Range& range) const {
  std::vector<double> values;
  for (const Value& item : items(count, shape)) {
    values.push_back(item.number(range));
  }
  return values;
}

std::ptrdiff_t Value::index_of_word(const std::vector<std::string_view>& words) const {
  const bool is_text = node->kind == Node::Kind::kText || node->kind == Node::Kind::kWord;
  const auto word = is_text ? std::find(words.begin(), words.end(), node->text) : words.end();
  if (word == words.end()) {
    refuse(fmt::format("must be one of {}; is {}", comma_separated(words), found(*node)));
  }
  return word - words.begin();
}

Value child_of(const Value& parent, std::string path, const Node& place, const Node& node) {
  return {std::shared_ptr<const Node>(parent.node, &node), parent.file, std::move(path),
          place.line > 0 ? place.line : parent.line, parent.keys};
}

std::string shortened(std::string_view text, std::size_t bytes_max) {
  std::size_t end = 0;
  while (end < text.size() && end < bytes_max) {
    end += std::max<std::size_t>(utf8_bytes(text, end), 1);
  }
  return std::string(text.substr(0, end)) + (end < text.size() ? "…" : "");
}

std::string one_of(const std::vector<std::string_view>& words) {
  return "one of " + comma_separated(words);
}

std::string whole_words(std::int64_t min, std::int64_t max) {
  return fmt::format("a whole number, at least {} and at most {}", min, max);
}

std::string comma_separated(const std::vector<std::string_view>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

bool differs_in_unit(std::string_view a, std::string_view b) {
  return a != b && without_unit(a) == without_unit(b);
}

std::string nearest_word(std::string_view word, const std::vector<std::string_view>& known) {
  constexpr std::size_t kNear = 2;
  std::string_view best;
  std::size_t best_distance = std::max(kNear, word.size() / 3) + 1;
  for (const std::string_view candidate : known) {
    const bool is_same = differs_in_unit(word, candidate);
    if (!is_same && word.size() > candidate.size() + best_distance) {
      continue;  // too different; also limits the time for long words
    }
    const std::size_t distance = is_same ? 0 : edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return std::string(best);
}

}  // namespace vantage::scenario
