#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

// What stands between the network and the decoders that lcm-gen wrote. Those trust every length in
// a message: a negative count throws, a string length of INT_MIN crashes, a count of 2³¹ allocates
// for seconds. Here the lengths are walked first, without allocating, and must add up exactly.

namespace vantage::bus {

enum class WireKind : std::uint8_t { kBytes, kInteger, kString, kStruct };
/// What the bytes of one element mean; kNone for strings and structs.
enum class WireNumber : std::uint8_t {
  kNone,
  kBoolean,
  kByte,
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kFloat,
  kDouble
};

/// Of an integer field's `bits`, as many as it has: the number, with its sign.
std::int64_t signed_value(WireNumber number, std::uint64_t bits);

struct WireSchema;

/// Bounds of a layout, generous: lcm-gen itself has none.
inline constexpr std::size_t kWireDims = 4;         ///< of an array
inline constexpr std::size_t kWireFieldsMax = 256;  ///< of a type

/// One array dimension: the value of the integer field number `field`, or `constant` if that is −1.
struct WireDim {
  std::int32_t constant;
  std::int32_t field;
};

struct WireField {
  WireKind kind;
  std::int32_t least_bytes;  ///< that one element takes; exactly so for kBytes and kInteger
  const WireSchema* nested;  ///< of a kStruct
  std::array<WireDim, kWireDims> dims;  ///< {1, −1} where there is none
  std::string_view name;
  WireNumber number;
  std::int32_t rank;  ///< how many of `dims` there are: 0 for a scalar
};

/// Layout of one wire type after its fingerprint. The tables are generated from lcmtypes/ at build
/// time by bus/convert/wire_schema.py.
struct WireSchema {
  std::string_view name;
  std::span<const WireField> fields;
};

/// The layout of `type` ("plan_t"), or null for a name that lcmtypes/ does not have.
const WireSchema* find_wire_schema(std::string_view type);

/// True when `body` (a message after its fingerprint) is exactly one value of `schema`: counts are
/// not negative and fit into what is left, strings end in NUL, no byte is missing or left over.
/// Cost: one pass over the strings and structs, no allocation.
[[nodiscard]] bool is_well_formed(const WireSchema& schema, std::span<const std::uint8_t> body);

/// The wire message in `message`, or nullopt when it is not exactly one value of `Wire`: wrong
/// fingerprint (another type or version), lying lengths, truncated, or with bytes left over. What
/// makes it a signed message (bus/auth/trailer) is taken off first, unread.
template <class Wire>
std::optional<Wire> decode_wire(std::span<const std::uint8_t> message);

}  // namespace vantage::bus

#include "bus/convert/wire_walk_impl.hpp"  // IWYU pragma: export
