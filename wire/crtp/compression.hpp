#pragma once

#include <cstdint>
#include <optional>

#include "core/linear.hpp"

namespace vantage::wire::crtp {

/// Returns the rotation in 32 bits: bits 31 and 30 contain the index of the largest of x, y, z, w;
/// the others follow in order, most significant first, each as a sign bit and 9 bits of magnitude
/// in units of 1/(511 √2). The quaternion is normalised first.
/// @return nullopt if a component is not finite or all are 0
std::optional<std::uint32_t> compress(const Quaternion& rotation);
/// Returns the rotation in `bits`; always a unit quaternion.
Quaternion decompress(std::uint32_t bits);

/// Converts a number of IEEE 754 binary16.
float from_half(std::uint16_t bits);
/// Returns the nearest number of IEEE 754 binary16 (ties to even; overflow gives infinity).
std::uint16_t to_half(float value);

}  // namespace vantage::wire::crtp
