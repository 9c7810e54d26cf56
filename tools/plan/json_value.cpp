#include "tools/plan/json_value.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "core/check.hpp"
#include "scenario/reader/value.hpp"

namespace vantage::tools {
namespace {

constexpr std::size_t kTextMaxBytes = std::size_t{64} << 20;
constexpr int kDepthMax = 32;

struct Place {
  std::size_t line = 1;
  std::size_t column = 1;
};

Place place_of(const std::string& text, std::size_t byte) {
  Place place;
  for (std::size_t i = 0; i < std::min(byte, text.size()); ++i) {
    if (text[i] == '\n') {
      ++place.line;
      place.column = 1;
    } else {
      ++place.column;
    }
  }
  return place;
}

// "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error …": the last
// part.
std::string reason_of(const nlohmann::json::exception& error) {
  const std::string what = error.what();
  const std::size_t place = what.find("parse error at ");
  const std::size_t start = place == std::string::npos ? what.find("] ") : what.find(": ", place);
  return start == std::string::npos ? what : what.substr(start + 2);
}

std::string shown(const nlohmann::json& node) {
  constexpr std::size_t kShown = 60;
  if (node.is_number_float()) {
    return fmt::format("{}", node.get<double>());
  }
  const std::string text = node.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return text.size() <= kShown ? text : text.substr(0, kShown) + "…";
}

}  // namespace

bool Bounds::contains(double value) const {
  return std::isfinite(value) && (is_min_excluded ? value > min : value >= min) && value <= max;
}

std::string Bounds::words() const {
  const std::string low = fmt::format("{} {}", is_min_excluded ? ">" : "≥", min);
  const std::string high = fmt::format("≤ {}", max);
  if (std::isinf(max)) {
    return std::isinf(min) ? "a number" : low;
  }
  return std::isinf(min) ? high : low + " and " + high;
}

nlohmann::json parse_json(const std::string& text, const std::string& name) {
  if (text.size() > kTextMaxBytes) {
    throw StartupError(fmt::format("{}: must be at most {} bytes", name, kTextMaxBytes));
  }
  // The library keeps the last of two equal keys; nobody means that.
  std::vector<std::set<std::string>> keys;
  const auto watch = [&](int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (depth > kDepthMax) {
      throw StartupError(fmt::format("{}: nested deeper than {}", name, kDepthMax));
    }
    if (event == Event::object_start) {
      keys.emplace_back();
    } else if (event == Event::object_end) {
      keys.pop_back();
    } else if (event == Event::key && !keys.back().insert(parsed.get<std::string>()).second) {
      throw StartupError(fmt::format("{}: duplicate key {}", name, shown(parsed)));
    }
    return true;
  };
  try {
    return nlohmann::json::parse(text, watch);
  } catch (const nlohmann::json::parse_error& error) {
    const Place place = place_of(text, error.byte == 0 ? 0 : error.byte - 1);
    throw StartupError(
        fmt::format("{}:{}:{}: not JSON: {}", name, place.line, place.column, reason_of(error)));
  } catch (const nlohmann::json::exception& error) {
    throw StartupError(fmt::format("{}: not JSON: {}", name, reason_of(error)));
  }
}

void JsonValue::complain(const std::string& what) const {
  throw StartupError(path_.empty() ? fmt::format("{}: {}", file_, what)
                                   : fmt::format("{}: {}: {}", file_, path_, what));
}

void JsonValue::refuse(const std::string& rule) const {
  complain(fmt::format("{}, got {}", rule, shown(*node_)));
}

double JsonValue::number(const Bounds& bounds) const {
  if (!node_->is_number()) {
    refuse("must be a number");
  }
  const auto value = node_->get<double>();
  if (!bounds.contains(value)) {
    refuse("must be " + bounds.words());
  }
  return value;
}

std::int64_t JsonValue::integer(std::int64_t min, std::int64_t max) const {
  const double value = number({});
  if (value != std::floor(value)) {
    refuse("must be a whole number");
  }
  if (value < static_cast<double>(min) || value > static_cast<double>(max)) {
    refuse(fmt::format("must be ≥ {} and ≤ {}", min, max));
  }
  return static_cast<std::int64_t>(value);
}

std::string JsonValue::text() const {
  if (!node_->is_string()) {
    refuse("must be a text");
  }
  return node_->get<std::string>();
}

std::size_t JsonValue::word(const std::vector<std::string_view>& words) const {
  const auto found = node_->is_string()
                         ? std::find(words.begin(), words.end(), node_->get<std::string>())
                         : words.end();
  if (found == words.end()) {
    refuse("must be one of " + scenario::comma_separated(words));
  }
  return static_cast<std::size_t>(found - words.begin());
}

std::vector<JsonValue> JsonValue::items() const {
  if (!node_->is_array()) {
    refuse("must be a list");
  }
  std::vector<JsonValue> values;
  for (const nlohmann::json& item : *node_) {
    values.emplace_back(item, file_, fmt::format("{}[{}]", path_, values.size()));
  }
  return values;
}

std::vector<double> JsonValue::numbers(std::size_t count, const Bounds& bounds,
                                       std::string_view shape) const {
  if (!node_->is_array() || node_->size() != count) {
    refuse(fmt::format("must be {}", shape));
  }
  std::vector<double> values;
  for (const JsonValue& item : items()) {
    values.push_back(item.number(bounds));
  }
  return values;
}

JsonObject::JsonObject(const JsonValue& value) : value_(value) {
  if (!value_.node_->is_object()) {
    value_.refuse("must be an object");
  }
}

std::optional<JsonValue> JsonObject::find(std::string_view key) {
  known_.push_back(key);
  const auto found = value_.node_->find(std::string(key));
  if (found == value_.node_->end()) {
    return std::nullopt;
  }
  const std::string path =
      value_.path_.empty() ? std::string(key) : fmt::format("{}.{}", value_.path_, key);
  return JsonValue(*found, value_.file_, path);
}

JsonValue JsonObject::get(std::string_view key) {
  const std::optional<JsonValue> value = find(key);
  if (!value) {
    value_.complain(fmt::format("missing required key {}", key));
  }
  return *value;
}

double JsonObject::number_or(std::string_view key, double otherwise, const Bounds& bounds) {
  const std::optional<JsonValue> value = find(key);
  return value ? value->number(bounds) : otherwise;
}

void JsonObject::finish() const {
  for (const auto& [key, unused] : value_.node_->items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) {
      continue;
    }
    const std::string nearest = scenario::nearest_word(key, known_);
    value_.complain(fmt::format("unknown key {}; {}", shown(nlohmann::json(key)),
                                nearest.empty()
                                    ? "known here are " + scenario::comma_separated(known_)
                                    : "did you mean " + nearest + "?"));
  }
}

}  // namespace vantage::tools
