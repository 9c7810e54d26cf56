#include "logs/json/wire_json.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "bus/auth/trailer.hpp"
#include "core/index.hpp"
#include "logs/file/log_event.hpp"
#include "logs/file/wire_check.hpp"

namespace vantage::logs {
namespace {

using Json = nlohmann::ordered_json;
using bus::WireField;
using bus::WireNumber;
using bus::WireSchema;

constexpr std::size_t kFingerprintBytes = 8;

/// Reader of a message body that is_well_formed() has accepted.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> left) : left_(left) {}

  Json read_struct(const WireSchema& schema) {
    Json out = Json::object();
    // values of integer members, which may be array sizes
    std::vector<std::size_t> integers(schema.fields.size(), 0);
    for (std::size_t i = 0; i < schema.fields.size(); ++i) {
      const WireField& field = schema.fields[i];
      std::array<std::size_t, bus::kWireDims> counts{};
      for (std::size_t d = 0; d < counts.size(); ++d) {
        const bus::WireDim& dim = field.dims[d];
        counts[d] =
            dim.field < 0 ? static_cast<std::size_t>(dim.constant) : integers[index(dim.field)];
      }
      Json value = read_field(field, counts, 0);
      if (field.rank == 0 && value.is_number_integer() && value.get<std::int64_t>() >= 0) {
        integers[i] = value.get<std::size_t>();
      }
      out[std::string(field.name)] = std::move(value);
    }
    return out;
  }

 private:
  Json read_field(const WireField& field, const std::array<std::size_t, bus::kWireDims>& counts,
                  std::size_t dim) {
    if (dim == static_cast<std::size_t>(field.rank)) {
      return read_element(field);
    }
    Json elements = Json::array();
    for (std::size_t i = 0; i < counts[dim]; ++i) {
      elements.push_back(read_field(field, counts, dim + 1));
    }
    return elements;
  }

  Json read_element(const WireField& field) {
    if (field.kind == bus::WireKind::kStruct) {
      return read_struct(*field.nested);
    }
    if (field.kind == bus::WireKind::kString) {
      const std::size_t length = take(4);
      const auto bytes = left_.first(length - 1);  // without the NUL
      left_ = left_.subspan(length);
      return std::string(bytes.begin(), bytes.end());
    }
    const std::uint64_t bits = take(static_cast<std::size_t>(field.least_bytes));
    switch (field.number) {
      case WireNumber::kBoolean:
        return bits != 0;
      case WireNumber::kByte:
        return static_cast<std::uint8_t>(bits);
      case WireNumber::kFloat:
        return finite(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
      case WireNumber::kDouble:
        return finite(std::bit_cast<double>(bits));
      default:
        return bus::signed_value(field.number, bits);
    }
  }

  static Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(); }

  std::uint64_t take(std::size_t width) {
    const std::uint64_t value = read_big_endian(left_.data(), width);
    left_ = left_.subspan(width);
    return value;
  }

  std::span<const std::uint8_t> left_;
};

Json element_schema(const WireField& field) {
  if (field.kind == bus::WireKind::kStruct) {
    return json_schema(*field.nested);
  }
  if (field.kind == bus::WireKind::kString) {
    return {{"type", "string"}};
  }
  switch (field.number) {
    case WireNumber::kBoolean:
      return {{"type", "boolean"}};
    case WireNumber::kFloat:
    case WireNumber::kDouble:
      return {{"type", "number"}};
    default:
      return {{"type", "integer"}};
  }
}

}  // namespace

std::optional<Json> message_json(std::span<const std::uint8_t> message) {
  const WireSchema* schema = type_of(message);
  return schema == nullptr ? std::nullopt : message_json(message, *schema);
}

std::optional<Json> message_json(std::span<const std::uint8_t> message, const WireSchema& schema) {
  const auto data = bus::auth::payload_of(message);
  if (data.size() < kFingerprintBytes) {
    return std::nullopt;
  }
  const auto body = data.subspan(kFingerprintBytes);
  if (!bus::is_well_formed(schema, body)) {
    return std::nullopt;
  }
  return Reader(body).read_struct(schema);
}

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json json_schema(const WireSchema& schema) {
  Json properties = Json::object();
  for (const WireField& field : schema.fields) {
    if (field.rank > 1) {
      continue;
    }
    Json property = element_schema(field);
    if (field.rank == 1) {
      property = Json{{"type", "array"}, {"items", std::move(property)}};
    }
    properties[std::string(field.name)] = std::move(property);
  }
  return {{"title", "vantage." + std::string(schema.name)},
          {"type", "object"},
          {"properties", std::move(properties)}};
}

}  // namespace vantage::logs
