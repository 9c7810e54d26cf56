#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

// One value of a JSON file that knows where it stands, so that whoever refuses it can say so.

namespace vantage::tools {

/// Which numbers are allowed.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool is_min_excluded = false;

  [[nodiscard]] bool contains(double value) const;
  /// "> 0 and ≤ 360".
  [[nodiscard]] std::string words() const;
};

/// The text as JSON. @throws StartupError "name:line:column: …" when it is not JSON, is larger
/// than 64 MiB, nested deeper than 32, or has a key twice in one object.
nlohmann::json parse_json(const std::string& text, const std::string& name);

/// A value with its address. Every reading throws StartupError "file: path: rule, got what" unless
/// the value is what is asked for. Refers to the document, which must outlive it.
class JsonValue {
 public:
  JsonValue(const nlohmann::json& node, std::string file, std::string path = "")
      : node_(&node), file_(std::move(file)), path_(std::move(path)) {}

  /// "file: path: rule, got what".
  [[noreturn]] void refuse(const std::string& rule) const;
  /// "file: path: what", when what is wrong is not the value's own.
  [[noreturn]] void complain(const std::string& what) const;

  [[nodiscard]] double number(const Bounds& bounds) const;
  /// A whole number within [min, max]; 12.0 is one.
  [[nodiscard]] std::int64_t integer(std::int64_t min, std::int64_t max) const;
  [[nodiscard]] std::string text() const;
  /// Index in `words` of the text that this is.
  [[nodiscard]] std::size_t word(const std::vector<std::string_view>& words) const;
  /// The items of a list.
  [[nodiscard]] std::vector<JsonValue> items() const;
  /// `count` numbers, each within `bounds`; `shape` is how a refusal writes the list.
  [[nodiscard]] std::vector<double> numbers(std::size_t count, const Bounds& bounds,
                                            std::string_view shape) const;

 private:
  friend class JsonObject;
  const nlohmann::json* node_;
  std::string file_;
  std::string path_;
};

/// The keys of one object, read one by one; finish() refuses those that nobody asked for.
class JsonObject {
 public:
  explicit JsonObject(const JsonValue& value);

  /// nullopt when the key is absent.
  [[nodiscard]] std::optional<JsonValue> find(std::string_view key);
  /// @throws StartupError when the key is absent.
  [[nodiscard]] JsonValue get(std::string_view key);
  [[nodiscard]] double number(std::string_view key, const Bounds& bounds) {
    return get(key).number(bounds);
  }
  [[nodiscard]] double number_or(std::string_view key, double otherwise, const Bounds& bounds);
  void finish() const;

 private:
  JsonValue value_;
  std::vector<std::string_view> known_;
};

}  // namespace vantage::tools
