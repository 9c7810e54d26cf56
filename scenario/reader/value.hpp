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

#include "scenario/reader/node.hpp"

// One value of a YAML or JSON file that knows where it stands, so that whoever refuses it can say
// so.

namespace vantage::scenario {

/// Which numbers are allowed. Its words are the ones that a refusal prints.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool is_min_excluded = false;
  bool is_max_excluded = false;

  [[nodiscard]] bool contains(double value) const;
  /// "above 0 and at most 360".
  [[nodiscard]] std::string words() const;
  [[nodiscard]] Range scaled(double factor) const;
};

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr Range any_number() { return {}; }
constexpr Range at_least(double min) { return {min, kNoLimit, false, false}; }
constexpr Range above(double min) { return {min, kNoLimit, true, false}; }
constexpr Range from_to(double min, double max) { return {min, max, false, false}; }
constexpr Range above_to(double min, double max) { return {min, max, true, false}; }
constexpr Range from_below(double min, double max) { return {min, max, false, true}; }

/// A node of the file with its address in it. Every reading of it throws StartupError
/// "file:line: path: what was expected, what was found" unless the node is what is asked for.
struct Value {
  std::shared_ptr<const Node> node;
  std::string file;
  std::string path;  ///< "robots[1].sensor.range_max_m"; empty for the whole file
  int line = 1;      ///< of the key, or of the item in a list

  /// In one line, whatever the file has brought into `what` or the path.
  [[noreturn]] void refuse(const std::string& what) const;

  /// A finite number in `range`; quoted numbers are text, not numbers.
  [[nodiscard]] double number(const Range& range) const;
  /// A whole number within [min, max], written without point or exponent.
  [[nodiscard]] std::int64_t integer(std::int64_t min, std::int64_t max) const;
  [[nodiscard]] std::uint64_t unsigned_integer() const;
  /// `true` or `false`, no other spelling.
  [[nodiscard]] bool flag() const;
  /// A text that is not empty; a number of JSON is none.
  [[nodiscard]] std::string text() const;
  /// A text, or nothing in quotes.
  [[nodiscard]] std::string text_or_empty() const;
  /// [x, y], each in `range`.
  [[nodiscard]] Eigen::Vector2d point(const Range& range) const;
  /// The items of a list.
  [[nodiscard]] std::vector<Value> items() const;
  /// The items of a list of `count`; `shape` is what they are: "two numbers [x, y]".
  [[nodiscard]] std::vector<Value> items(std::size_t count, std::string_view shape) const;
  /// As items(), each a number in `range`.
  [[nodiscard]] std::vector<double> numbers(std::size_t count, std::string_view shape,
                                            const Range& range) const;

  /// The enumerator that the word stands for.
  template <class Enum>
  [[nodiscard]] Enum word(
      std::initializer_list<std::pair<std::string_view, Enum>> vocabulary) const {
    return word(std::vector<std::pair<std::string_view, Enum>>(vocabulary));
  }
  template <class Enum>
  [[nodiscard]] Enum word(const std::vector<std::pair<std::string_view, Enum>>& vocabulary) const {
    std::vector<std::string_view> words;
    for (const auto& [name, enumerator] : vocabulary) {
      words.push_back(name);
    }
    return (vocabulary.begin() + index_of_word(words))->second;
  }

 private:
  [[nodiscard]] std::ptrdiff_t index_of_word(const std::vector<std::string_view>& words) const;
  [[nodiscard]] std::string plain_number() const;
};

/// What stands under `key`, or in a list, within `parent`; both of the tree that holds `parent`.
Value child_of(const Value& parent, std::string path, const Node& place, const Node& node);

/// The text, or its first characters and "…".
std::string shortened(std::string_view text, std::size_t bytes_max = 40);

/// "a, b, c".
std::string comma_separated(const std::vector<std::string_view>& words);

/// The one of `known` that `word` was probably meant to be: the same name with another unit, else
/// the nearest by edit distance when that is near; "" when nothing is.
std::string nearest_word(std::string_view word, const std::vector<std::string_view>& known);

/// True when both names differ only in their unit, or in one having none.
bool differs_in_unit(std::string_view a, std::string_view b);

}  // namespace vantage::scenario
