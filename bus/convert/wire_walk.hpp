#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

// Checks messages from the network before lcm-gen's decoders read them. Those decoders trust every
// length: a negative count throws, a string length of INT_MIN crashes, and a count of 2³¹ allocates
// for seconds. The check reads all lengths without allocating; the resulting size must equal the
// message size.

namespace vantage::bus {

enum class WireKind : std::uint8_t { kBytes, kInteger, kString, kStruct };
/// Number type of one element; kNone for strings and structs.
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

/// Returns the signed number in the lower bits of `bits`, with the width of `number`.
std::int64_t signed_value(WireNumber number, std::uint64_t bits);

struct WireSchema;

/// Limits of a layout. lcm-gen itself has no limits.
inline constexpr std::size_t kWireDims = 4;         ///< maximum number of dimensions of an array
inline constexpr std::size_t kWireFieldsMax = 256;  ///< maximum number of fields of a type

/// One array dimension: the value of integer field number `field`, or `constant` if `field` is −1.
struct WireDim {
  std::int32_t constant;
  std::int32_t field;
};

struct WireField {
  WireKind kind;
  std::int32_t least_bytes;  ///< smallest size of one element; exact for kBytes and kInteger
  const WireSchema* nested;  ///< layout of the elements of a kStruct
  std::array<WireDim, kWireDims> dims;  ///< {1, −1} for unused dimensions
  std::string_view name;
  WireNumber number;
  std::int32_t rank;  ///< number of used `dims`; 0 for a scalar
};

/// Layout of one wire type, without the fingerprint before it. bus/convert/wire_schema.py generates
/// the tables from lcmtypes/ at build time.
struct WireSchema {
  std::string_view name;
  std::span<const WireField> fields;
};

/// Returns the layout of `type` ("plan_t"), or null for a name that is not in lcmtypes/.
const WireSchema* find_wire_schema(std::string_view type);

/// True if `body` (a message after its fingerprint) is exactly one value of `schema`: counts are
/// not negative and fit into the remaining bytes, strings end in NUL, and the size is exact.
/// Cost: one pass over the strings and structs, no allocation.
[[nodiscard]] bool is_well_formed(const WireSchema& schema, std::span<const std::uint8_t> body);

/// Decodes `message`. Returns nullopt when it is not exactly one value of `Wire`: wrong fingerprint
/// (another type or version), inconsistent lengths, truncated, or too long. A signature trailer
/// (bus/auth/trailer) is removed first; it is not checked.
template <class Wire>
std::optional<Wire> decode_wire(std::span<const std::uint8_t> message);

}  // namespace vantage::bus

#include "bus/convert/wire_walk_impl.hpp"  // IWYU pragma: export
