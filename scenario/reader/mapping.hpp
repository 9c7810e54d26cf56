#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenario/reader/mistakes.hpp"
#include "scenario/reader/value.hpp"

namespace vantage::scenario {

/// Reader of the keys of one mapping of the file. The mapping consists of layers: each key is read
/// from the first layer that has it, recursively for nested mappings. So robot_defaults is the
/// second layer of every robot, and each value has its own line number for errors.
///
/// An absent key leaves the variable unchanged. read_mapping() creates the objects of this class.
class Mapping {
 public:
  void number(std::string_view key, double& value, const Range& range);
  /// Reads `<stem>_rad` or `<stem>_deg`; a layer may have only one of them.
  void angle(std::string_view stem, double& value_rad, const Range& range_deg);
  void integer(std::string_view key, int& value, int min, int max);
  void flag(std::string_view key, bool& value);
  void text(std::string_view key, std::string& value);
  template <class Enum>
  void choice(std::string_view key, Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> vocabulary) {
    choice(key, value, std::vector<std::pair<std::string_view, Enum>>(vocabulary));
  }
  template <class Enum>
  void choice(std::string_view key, Enum& value,
              const std::vector<std::pair<std::string_view, Enum>>& vocabulary) {
    std::vector<std::string_view> words;
    std::string initial;
    for (const auto& [name, enumerator] : vocabulary) {
      words.push_back(name);
      initial = enumerator == value ? name : initial;
    }
    note(key, one_of(words), std::move(initial));
    tolerate([&] {
      if (const std::optional<Value> found = find(key)) {
        value = found->choice(vocabulary);
      }
    });
  }
  /// Reads a word, and sets the value to the one of `kinds` that has this name().
  template <class Kind>
  void choice(std::string_view key, Kind& value, std::span<const Kind> kinds) {
    std::vector<std::pair<std::string_view, Kind>> vocabulary;
    for (const Kind kind : kinds) {
      vocabulary.emplace_back(kind.name(), kind);
    }
    choice(key, value, vocabulary);
  }
  /// If there is a mapping under `key`, calls `read` with it and returns true.
  bool section(std::string_view key, const std::function<void(Mapping&)>& read);

  /// Returns the value under `key` in the first layer that has it.
  [[nodiscard]] std::optional<Value> find(std::string_view key);
  /// As find(). If the key is absent, returns nullopt, and finish() reports the absent key.
  [[nodiscard]] std::optional<Value> find_required(std::string_view key);
  /// Declares `key` as required: finish() refuses the mapping when it is absent.
  void require(std::string_view key);

  /// Declares keys that are read later, so that finish() may be called first.
  void declare(std::initializer_list<std::string_view> keys);

  /// Throws StartupError at the line of `key`, or of the mapping if no layer has `key`.
  [[noreturn]] void refuse(std::string_view key, const std::string& what);

  /// Refuses any key that was neither read nor declared, then any required key that is absent.
  void finish();

 private:
  friend void read_mapping(std::vector<Value> layers, const std::function<void(Mapping&)>& read);
  explicit Mapping(std::vector<Value> layers);
  [[nodiscard]] std::optional<Value> find_in(const Value& layer, std::string_view key);
  void mark_known(std::string_view key);
  void read_angle(const std::string& in_rad, const std::string& in_deg, double& value_rad,
                  const Range& range_deg);
  /// Adds the rule of `key` to the table of keys, if a table exists.
  void note(std::string_view key, std::string values, std::string initial = "",
            bool is_required = false) const;

  std::vector<Value> layers_;
  std::vector<std::string> known_;
  std::vector<std::string> missing_;
};

/// Calls `read` with the combined mapping of `layers`, then finish().
/// @throws StartupError when a layer is not a mapping, or has a duplicate key or a key that is not
///         a word
void read_mapping(std::vector<Value> layers, const std::function<void(Mapping&)>& read);

}  // namespace vantage::scenario
