#include "scenario/reader/mapping.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/angle.hpp"

namespace vantage::scenario {
namespace {

Value child(const Value& parent, std::size_t entry) {
  const Node& key = parent.node->key(entry);
  const std::string name = shortened(key.text);
  return child_of(parent, parent.path.empty() ? name : parent.path + "." + name, key,
                  parent.node->value(entry));
}

/// Refuses keys that are not words, and duplicate keys, because parsers silently use one or both of
/// two equal keys.
void check_keys(const Value& mapping) {
  const Node& node = *mapping.node;
  if (node.kind != Node::Kind::kMapping) {
    mapping.refuse(node.kind == Node::Kind::kNothing
                       ? "has no value; expected a mapping of keys to values"
                       : "must be a mapping of keys to values");
  }
  std::map<std::string_view, int> first_line;
  for (std::size_t entry = 0; entry < node.entry_count(); ++entry) {
    const Value value = child(mapping, entry);
    if (!node.key(entry).is_scalar()) {
      Value key = mapping;
      key.line = value.line;
      key.refuse("keys must be plain words");
    }
    const auto [first, is_new] = first_line.emplace(node.key(entry).text, value.line);
    if (!is_new) {
      value.refuse(fmt::format("duplicate key, first given on line {}", first->second));
    }
  }
}

}  // namespace

Mapping::Mapping(std::vector<Value> layers) : layers_(std::move(layers)) {
  for (const Value& layer : layers_) {
    check_keys(layer);
  }
}

void Mapping::mark_known(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
    known_.emplace_back(key);
  }
}

std::optional<Value> Mapping::find_in(const Value& layer, std::string_view key) {
  mark_known(key);
  for (std::size_t entry = 0; entry < layer.node->entry_count(); ++entry) {
    if (layer.node->key(entry).text == key) {
      Value value = child(layer, entry);
      if (value.node->kind == Node::Kind::kNothing) {
        value.refuse("has no value");
      }
      return value;
    }
  }
  return std::nullopt;
}

void Mapping::note(std::string_view key, std::string values, std::string initial,
                   bool is_required) const {
  const Value& first = layers_.front();
  if (first.keys != nullptr) {
    const std::string path = first.path.empty() ? "" : first.path + ".";
    first.keys->note(
        {path + std::string(key), std::move(values), std::move(initial), is_required, 0});
  }
}

std::optional<Value> Mapping::find(std::string_view key) {
  for (const Value& layer : layers_) {
    if (std::optional<Value> value = find_in(layer, key)) {
      return value;
    }
  }
  return std::nullopt;
}

std::optional<Value> Mapping::find_required(std::string_view key) {
  note(key, "", "", true);
  std::optional<Value> value = find(key);
  if (!value) {
    missing_.emplace_back(key);
  }
  return value;
}

void Mapping::declare(std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    mark_known(key);
  }
}

void Mapping::require(std::string_view key) { static_cast<void>(find_required(key)); }

void Mapping::number(std::string_view key, double& value, const Range& range) {
  note(key, range.description(), fmt::format("{}", value));
  tolerate([&] {
    if (const std::optional<Value> found = find(key)) {
      value = found->number(range);
    }
  });
}

void Mapping::angle(std::string_view stem, double& value_rad, const Range& range_deg) {
  const std::string in_rad = std::string(stem) + "_rad";
  const std::string in_deg = std::string(stem) + "_deg";
  mark_known(in_rad);
  mark_known(in_deg);
  note(in_deg, range_deg.description() + "; or " + in_rad,
       fmt::format("{:.6g}", value_rad * 180.0 / kPi));
  tolerate([&] { read_angle(in_rad, in_deg, value_rad, range_deg); });
}

void Mapping::read_angle(const std::string& in_rad, const std::string& in_deg, double& value_rad,
                         const Range& range_deg) {
  for (const Value& layer : layers_) {
    const std::optional<Value> rad = find_in(layer, in_rad);
    const std::optional<Value> deg = find_in(layer, in_deg);
    if (rad && deg) {
      (rad->line > deg->line ? *rad : *deg)
          .refuse(fmt::format("given twice, as {} and as {}; keep one", in_rad, in_deg));
    }
    if (rad) {
      value_rad = rad->number(range_deg.scaled(kPi / 180.0));
      return;
    }
    if (deg) {
      value_rad = radians(deg->number(range_deg));
      return;
    }
  }
}

void Mapping::integer(std::string_view key, int& value, int min, int max) {
  note(key, whole_words(min, max), std::to_string(value));
  tolerate([&] {
    if (const std::optional<Value> found = find(key)) {
      value = static_cast<int>(found->integer(min, max));
    }
  });
}

void Mapping::flag(std::string_view key, bool& value) {
  note(key, "true or false", value ? "true" : "false");
  tolerate([&] {
    if (const std::optional<Value> found = find(key)) {
      value = found->flag();
    }
  });
}

void Mapping::text(std::string_view key, std::string& value) {
  note(key, "text", value);
  tolerate([&] {
    if (const std::optional<Value> found = find(key)) {
      value = found->text();
    }
  });
}

bool Mapping::section(std::string_view key, const std::function<void(Mapping&)>& read) {
  note(key, "section");
  std::vector<Value> sections;
  for (const Value& layer : layers_) {
    if (std::optional<Value> value = find_in(layer, key)) {
      sections.push_back(std::move(*value));
    }
  }
  if (sections.empty()) {
    return false;
  }
  read_mapping(std::move(sections), read);
  return true;
}

void Mapping::refuse(std::string_view key, const std::string& what) {
  if (const std::optional<Value> value = find(key)) {
    value->refuse(what);
  }
  layers_.front().refuse(fmt::format("{}: {}", key, what));
}

void Mapping::finish() {
  const std::vector<std::string_view> known(known_.begin(), known_.end());
  for (const Value& layer : layers_) {
    for (std::size_t entry = 0; entry < layer.node->entry_count(); ++entry) {
      const std::string& key = layer.node->key(entry).text;
      if (std::find(known_.begin(), known_.end(), key) != known_.end()) {
        continue;
      }
      const Value value = child(layer, entry);
      const std::string nearest = nearest_word(key, known);
      tolerate([&] {
        if (nearest.empty()) {
          value.refuse("unknown key; valid keys are " + comma_separated(known));
        }
        value.refuse(fmt::format("unknown key{}; did you mean {}?",
                                 differs_in_unit(key, nearest) ? ", wrong unit" : "", nearest));
      });
    }
  }
  for (const std::string& key : missing_) {
    tolerate([&] { layers_.front().refuse("missing required key " + key); });
  }
}

void read_mapping(std::vector<Value> layers, const std::function<void(Mapping&)>& read) {
  tolerate([&] {
    Mapping mapping(std::move(layers));
    tolerate([&] { read(mapping); });
    mapping.finish();
  });
}

}  // namespace vantage::scenario
