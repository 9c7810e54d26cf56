#include "tools/ros2/names.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <sodium.h>

#include "logs/export/ros2_definitions.hpp"

namespace vantage::tools::ros2 {
namespace {

// Numbers of the field types. Source: type_description_interfaces/msg/FieldType.
constexpr int kNested = 1;
struct BasicType {
  std::string_view name;
  int id;
};
constexpr BasicType kBasicTypes[] = {{"int8", 2},     {"uint8", 3},    {"int16", 4}, {"uint16", 5},
                                     {"int32", 6},    {"uint32", 7},   {"int64", 8}, {"uint64", 9},
                                     {"float32", 10}, {"float64", 11}, {"bool", 15}, {"byte", 16},
                                     {"string", 17}};
constexpr int kArray = 48;               // added to the number of the element's type
constexpr int kUnboundedSequence = 144;  // added to the number of the element's type

std::string_view definition_of(std::string_view name) {
  const auto found = std::find_if(logs::ros2::kDefinitions.begin(), logs::ros2::kDefinitions.end(),
                                  [&](const auto& each) { return each.type == name; });
  if (found == logs::ros2::kDefinitions.end()) {
    throw std::invalid_argument("no definition of the ROS 2 type " + std::string(name));
  }
  return found->fields;
}

/// Returns "package/msg/Name" for "package/Name".
std::string full_name(std::string_view name) {
  const std::size_t slash = name.find('/');
  return std::string(name.substr(0, slash)) + "/msg" + std::string(name.substr(slash));
}

struct Field {
  std::string_view name;
  std::string_view type;  ///< type without array brackets
  int type_id = 0;
  std::string capacity = "0";
};

Field field_of(std::string_view line) {
  Field out;
  out.type = line.substr(0, line.find(' '));
  const std::string_view rest = line.substr(out.type.size() + 1);
  out.name = rest.substr(0, rest.find(' '));
  int kind = 0;
  if (out.type.ends_with("[]")) {
    kind = kUnboundedSequence;
  } else if (out.type.ends_with(']')) {
    kind = kArray;
    const std::size_t bracket = out.type.find('[');
    out.capacity = out.type.substr(bracket + 1, out.type.size() - bracket - 2);
  }
  out.type = out.type.substr(0, out.type.find('['));
  const auto* const basic =
      std::ranges::find_if(kBasicTypes, [&](const auto& each) { return each.name == out.type; });
  out.type_id = kind + (basic == std::end(kBasicTypes) ? kNested : basic->id);
  return out;
}

template <class Use>
void for_each_field(std::string_view type, const Use& use) {
  std::string_view lines = definition_of(type);
  while (!lines.empty()) {
    const std::string_view line = lines.substr(0, lines.find('\n'));
    lines.remove_prefix(line.size() + 1);
    if (line.find('=') == std::string_view::npos) {  // a constant is not part of the message
      use(field_of(line));
    }
  }
}

bool is_nested(const Field& field) { return field.type.find('/') != std::string_view::npos; }

void collect(std::string_view type, std::set<std::string_view>& types) {
  for_each_field(type, [&](const Field& field) {
    if (is_nested(field) && types.insert(field.type).second) {
      collect(field.type, types);
    }
  });
}

/// Returns the description of one type in the exact JSON of which ROS 2 computes the hash.
std::string description(std::string_view type) {
  std::string fields;
  for_each_field(type, [&](const Field& field) {
    fields += fmt::format(
        R"({}{{"name": "{}", "type": {{"type_id": {}, "capacity": {}, "string_capacity": 0, )"
        R"("nested_type_name": "{}"}}}})",
        fields.empty() ? "" : ", ", field.name, field.type_id, field.capacity,
        is_nested(field) ? full_name(field.type) : "");
  });
  return fmt::format(R"({{"type_name": "{}", "fields": [{}]}})", full_name(type), fields);
}

}  // namespace

std::string dds_topic(std::string_view topic) { return "rt" + std::string(topic); }

std::string dds_type(std::string_view type) {
  const std::size_t package = type.find('/');
  const std::size_t name = type.rfind('/');
  return fmt::format("{}::msg::dds_::{}_", type.substr(0, package), type.substr(name + 1));
}

std::string type_hash(std::string_view type) {
  const std::string name =
      std::string(type.substr(0, type.find('/'))) + std::string(type.substr(type.rfind('/')));
  std::set<std::string_view> nested;
  collect(name, nested);
  std::string parts;
  for (const std::string_view each : nested) {
    parts += (parts.empty() ? "" : ", ") + description(each);
  }
  const std::string json =
      fmt::format(R"({{"type_description": {}, "referenced_type_descriptions": [{}]}})",
                  description(name), parts);
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  crypto_hash_sha256(digest.data(), reinterpret_cast<const unsigned char*>(json.data()),  // NOLINT
                     json.size());
  return fmt::format("RIHS01_{:02x}", fmt::join(digest, ""));
}

std::string type_hash_user_data(std::string_view type) {
  return "typehash=" + type_hash(type) + ";";
}

}  // namespace vantage::tools::ros2
