#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "scenario/reader/key_table.hpp"
#include "scenario/reader/node.hpp"

// Values of a YAML or JSON file with their positions in the file, for error messages.

namespace vantage::scenario {

/// Range of allowed numbers.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool is_min_excluded = false;
  bool is_max_excluded = false;

  [[nodiscard]] bool contains(double value) const;
  /// Returns the range in words for error messages: "above 0 and at most 360".
  [[nodiscard]] std::string description() const;
  [[nodiscard]] Range scaled(double factor) const;
};

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr Range any_number() { return {}; }
constexpr Range at_least(double min) { return {min, kNoLimit, false, false}; }
constexpr Range above(double min) { return {min, kNoLimit, true, false}; }
constexpr Range from_to(double min, double max) { return {min, max, false, false}; }
constexpr Range above_to(double min, double max) { return {min, max, true, false}; }
constexpr Range from_below(double min, double max) { return {min, max, false, true}; }

/// Returns "one of a, b, c".
std::string one_of(const std::vector<std::string_view>& words);

/// Returns "a whole number, at least 1 and at most 5".
std::string whole_words(std::int64_t min, std::int64_t max);

/// Node of a file with its position. Each read function throws StartupError "file:line: path: what
/// was expected, what was found" if the node does not match.
struct Value {
  std::shared_ptr<const Node> node;
  std::string file;
  std::string path;          ///< "robots[1].sensor.range_max_m"; empty for the whole file
  int line = 1;              ///< line of the key, or of the item in a list
  KeyTable* keys = nullptr;  ///< records the rule of each key that is read; may be null

  /// Throws StartupError as one line; control characters in `what` and the path are escaped.
  [[noreturn]] void refuse(const std::string& what) const;

  /// Adds the rule of this value to `keys`; `values` describes the allowed values in words.
  void note(std::string values) const;

  /// Returns a finite number in `range`. Quoted numbers are refused: they are text.
  [[nodiscard]] double number(const Range& range) const;
  /// Returns a whole number within [min, max], written without point or exponent.
  [[nodiscard]] std::int64_t integer(std::int64_t min, std::int64_t max) const;
  [[nodiscard]] std::uint64_t unsigned_integer() const;
  /// Returns true or false; refuses other spellings than `true` and `false`.
  [[nodiscard]] bool flag() const;
  /// Returns a text that is not empty; refuses a JSON number.
  [[nodiscard]] std::string text() const;
  /// Returns a text, which may be empty.
  [[nodiscard]] std::string text_or_empty() const;
  /// Returns a point [x, y] with both coordinates in `range`.
  [[nodiscard]] Eigen::Vector2d point(const Range& range) const;
  /// Returns the items of a list.
  [[nodiscard]] std::vector<Value> items() const;
  /// Returns the items of a list of length `count`; `shape` describes them in errors: "two numbers
  /// [x, y]".
  [[nodiscard]] std::vector<Value> items(std::size_t count, std::string_view shape) const;
  /// As items(), converted to numbers in `range`.
  [[nodiscard]] std::vector<double> numbers(std::size_t count, std::string_view shape,
                                            const Range& range) const;

  /// Returns the enumerator that the word names.
  template <class Enum>
  [[nodiscard]] Enum choice(
      std::initializer_list<std::pair<std::string_view, Enum>> vocabulary) const {
    return choice(std::vector<std::pair<std::string_view, Enum>>(vocabulary));
  }
  template <class Enum>
  [[nodiscard]] Enum choice(
      const std::vector<std::pair<std::string_view, Enum>>& vocabulary) const {
    std::vector<std::string_view> words;
    for (const auto& [name, enumerator] : vocabulary) {
      words.push_back(name);
    }
    note(one_of(words));
    return (vocabulary.begin() + index_of_word(words))->second;
  }

 private:
  [[nodiscard]] std::ptrdiff_t index_of_word(const std::vector<std::string_view>& words) const;
  [[nodiscard]] std::string plain_number() const;
};

/// Returns the value of `node`, a child of `parent` in the same tree, with path `path` and the line
/// of `place` (the key or the list item).
Value child_of(const Value& parent, std::string path, const Node& place, const Node& node);

/// Returns the text; if it is longer than `bytes_max`, its first characters and "…".
std::string shortened(std::string_view text, std::size_t bytes_max = 40);

/// Returns "a, b, c".
std::string comma_separated(const std::vector<std::string_view>& words);

/// Returns the most similar word of `known`: the same name with another unit, otherwise the nearest
/// by edit distance. Returns "" if none is similar enough.
std::string nearest_word(std::string_view word, const std::vector<std::string_view>& known);

/// True if the two names differ only in their unit; one name may have no unit.
bool differs_in_unit(std::string_view a, std::string_view b);

}  // namespace vantage::scenario
