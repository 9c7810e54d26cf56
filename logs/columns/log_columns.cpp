#include "logs/columns/log_columns.hpp"

#include <array>
#include <bit>
#include <utility>

#include "bus/auth/trailer.hpp"
#include "core/index.hpp"
#include "logs/file/log_event.hpp"
#include "logs/file/wire_check.hpp"

namespace vantage::logs {
namespace {

using bus::WireField;
using bus::WireKind;
using bus::WireNumber;

constexpr std::size_t kFingerprintBytes = 8;

LogColumn::Values no_values(const WireField& field) {
  if (field.kind == WireKind::kString) {
    return std::vector<std::string>{};
  }
  switch (field.number) {
    case WireNumber::kFloat:
    case WireNumber::kDouble:
      return std::vector<double>{};
    case WireNumber::kBoolean:
    case WireNumber::kByte:
      return std::vector<std::uint8_t>{};
    default:
      return std::vector<std::int64_t>{};
  }
}

bool has_list(const WireField& field) {
  return field.rank > 0 &&
         (field.dims[0].field >= 0 || field.dims[1].field >= 0 || field.kind == WireKind::kStruct);
}

}  // namespace

/// Reader of a message body that is_well_formed() has accepted.
class LogColumns::Reader {
 public:
  Reader(LogColumns& to, std::span<const std::uint8_t> left) : to_(to), left_(left) {}

  void read(const std::vector<Field>& fields) {
    std::array<std::size_t, 64> few{};
    std::vector<std::size_t> many(fields.size() > few.size() ? fields.size() : 0);
    const std::span<std::size_t> integers = many.empty() ? std::span(few) : std::span(many);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const Field& field = fields[i];
      std::size_t count = 1;
      for (std::size_t d = 0; d < static_cast<std::size_t>(field.wire->rank); ++d) {
        const bus::WireDim& dim = field.wire->dims[d];
        count *=
            dim.field < 0 ? static_cast<std::size_t>(dim.constant) : integers[index(dim.field)];
      }
      if (field.list >= 0) {
        std::vector<std::int64_t>& offsets = to_.lists_[index(field.list)].offsets;
        offsets.push_back(offsets.back() + static_cast<std::int64_t>(count));
      }
      for (std::size_t n = 0; n < count; ++n) {
        integers[i] = read_element(field);
      }
    }
  }

 private:
  /// Reads one element. Returns its value if it may be an array size, else 0.
  std::size_t read_element(const Field& field) {
    if (field.wire->kind == WireKind::kStruct) {
      read(field.nested);
      return 0;
    }
    LogColumn::Values& values = to_.columns_[index(field.column)].values;
    if (field.wire->kind == WireKind::kString) {
      const std::size_t length = take(4);
      const auto text = left_.first(length - 1);  // without the NUL
      left_ = left_.subspan(length);
      std::get<std::vector<std::string>>(values).emplace_back(text.begin(), text.end());
      return 0;
    }
    const std::uint64_t bits = take(static_cast<std::size_t>(field.wire->least_bytes));
    switch (field.wire->number) {
      case WireNumber::kFloat:
        std::get<std::vector<double>>(values).push_back(
            static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits))));
        return 0;
      case WireNumber::kDouble:
        std::get<std::vector<double>>(values).push_back(std::bit_cast<double>(bits));
        return 0;
      case WireNumber::kBoolean:
        std::get<std::vector<std::uint8_t>>(values).push_back(bits != 0 ? 1 : 0);
        return 0;
      case WireNumber::kByte:
        std::get<std::vector<std::uint8_t>>(values).push_back(static_cast<std::uint8_t>(bits));
        return bits;
      default:
        break;
    }
    const std::int64_t value = bus::signed_value(field.wire->number, bits);
    std::get<std::vector<std::int64_t>>(values).push_back(value);
    return value < 0 ? 0 : static_cast<std::size_t>(value);
  }

  std::uint64_t take(std::size_t width) {
    const std::uint64_t value = read_big_endian(left_.data(), width);
    left_ = left_.subspan(width);
    return value;
  }

  LogColumns& to_;
  std::span<const std::uint8_t> left_;
};

LogColumns::LogColumns(const bus::WireSchema& schema)
    : schema_(schema), fields_(plan(schema, "", -1)) {}

std::vector<LogColumns::Field> LogColumns::plan(const bus::WireSchema& schema,
                                                const std::string& prefix, int list) {
  std::vector<Field> fields;
  for (const WireField& wire : schema.fields) {
    Field field;
    field.wire = &wire;
    const std::string name = prefix + std::string(wire.name);
    int rows = list;
    if (has_list(wire)) {
      field.list = static_cast<int>(lists_.size());
      rows = field.list;
      lists_.push_back({name, list, {0}});
    }
    if (wire.kind == WireKind::kStruct) {
      field.nested = plan(*wire.nested, name + ".", rows);
    } else {
      LogColumn column;
      column.name = name;
      column.is_boolean = wire.number == WireNumber::kBoolean;
      column.list = rows;
      column.values = no_values(wire);
      for (std::size_t d = 0; field.list < 0 && d < static_cast<std::size_t>(wire.rank); ++d) {
        column.item_shape.push_back(static_cast<std::size_t>(wire.dims[d].constant));
      }
      field.column = static_cast<int>(columns_.size());
      columns_.push_back(std::move(column));
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

bool LogColumns::add(Time logged, std::span<const std::uint8_t> data) {
  const auto message = bus::auth::payload_of(data);
  if (type_of(message) != &schema_) {
    return false;
  }
  const auto body = message.subspan(kFingerprintBytes);
  if (!bus::is_well_formed(schema_, body)) {
    return false;
  }
  Reader(*this, body).read(fields_);
  logged_utime_.push_back(to_utime(logged));
  return true;
}

}  // namespace vantage::logs
