#include "bus/convert/wire_walk.hpp"

#include <cstddef>
#include <limits>

#include "core/index.hpp"

namespace vantage::bus {
namespace {

constexpr int kMaxDepth = 8;

/// Returns the product, or the largest number on overflow, so that an overflow cannot give a small
/// count.
std::uint64_t saturating_product(std::uint64_t a, std::uint64_t b) {
  constexpr auto kMost = std::numeric_limits<std::uint64_t>::max();
  return b != 0 && a > kMost / b ? kMost : a * b;
}

class Walker {
 public:
  explicit Walker(std::span<const std::uint8_t> left) : left_(left) {}

  bool walk_struct(const WireSchema& schema, int depth) {
    if (depth > kMaxDepth || schema.fields.size() > kWireFieldsMax) {
      return false;
    }
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): each element is set before it is read
    std::array<std::int64_t, kWireFieldsMax> integers;
    for (std::size_t i = 0; i < schema.fields.size(); ++i) {
      integers[i] = 0;
      const WireField& field = schema.fields[i];
      std::uint64_t count = 1;
      std::uint64_t rows = 1;
      for (const WireDim& dim : field.dims) {
        const std::int64_t length = dim.field < 0 ? dim.constant : integers[index(dim.field)];
        if (length < 0) {
          return false;
        }
        // Also limits the product of the dimensions in the message: n rows of zero elements need no
        // bytes, but allocate n vectors.
        if (dim.field >= 0 && length > 0) {
          rows = saturating_product(rows, static_cast<std::uint64_t>(length));
          if (rows > left_.size()) {
            return false;
          }
        }
        count = saturating_product(count, static_cast<std::uint64_t>(length));
      }
      if (count > left_.size() ||
          count * static_cast<std::uint64_t>(field.least_bytes) > left_.size()) {
        return false;
      }
      if (field.kind == WireKind::kInteger && count == 1) {
        integers[i] = integer(static_cast<std::size_t>(field.least_bytes));
      }
      if (!walk_elements(field, static_cast<std::size_t>(count), depth)) {
        return false;
      }
    }
    return true;
  }

  [[nodiscard]] bool is_at_end() const { return left_.empty(); }

 private:
  [[nodiscard]] std::int64_t left_bytes() const { return static_cast<std::int64_t>(left_.size()); }

  bool walk_elements(const WireField& field, std::size_t count, int depth) {
    if (field.kind == WireKind::kBytes || field.kind == WireKind::kInteger) {
      left_ = left_.subspan(count * static_cast<std::size_t>(field.least_bytes));
      return true;
    }
    for (std::size_t n = 0; n < count; ++n) {
      if (!(field.kind == WireKind::kString ? walk_string()
                                            : walk_struct(*field.nested, depth + 1))) {
        return false;
      }
    }
    return true;
  }

  bool walk_string() {
    constexpr std::size_t kLengthBytes = 4;
    if (left_.size() < kLengthBytes) {
      return false;
    }
    const std::int64_t length = integer(kLengthBytes);  // includes the NUL
    left_ = left_.subspan(kLengthBytes);
    if (length < 1 || length > left_bytes()) {
      return false;
    }
    const auto taken = static_cast<std::size_t>(length);
    const bool is_terminated = left_[taken - 1] == 0;
    left_ = left_.subspan(taken);
    return is_terminated;
  }

  /// Returns the next big-endian signed integer of `width` bytes; does not advance.
  [[nodiscard]] std::int64_t integer(std::size_t width) const {
    std::uint64_t value = (left_[0] & 0x80U) != 0 ? ~std::uint64_t{0} : 0;
    for (const std::uint8_t byte : left_.first(width)) {
      value = (value << 8U) | byte;
    }
    return static_cast<std::int64_t>(value);
  }

  std::span<const std::uint8_t> left_;
};

}  // namespace

std::int64_t signed_value(WireNumber number, std::uint64_t bits) {
  switch (number) {
    case WireNumber::kInt8:
      return static_cast<std::int8_t>(bits);
    case WireNumber::kInt16:
      return static_cast<std::int16_t>(bits);
    case WireNumber::kInt32:
      return static_cast<std::int32_t>(bits);
    default:
      return static_cast<std::int64_t>(bits);
  }
}

bool is_well_formed(const WireSchema& schema, std::span<const std::uint8_t> body) {
  Walker walker(body);
  return walker.walk_struct(schema, 0) && walker.is_at_end();
}

}  // namespace vantage::bus
