#include "wire/crtp/compression.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

namespace vantage::wire::crtp {
namespace {

constexpr std::uint32_t kMagnitudeMask = 511;
constexpr std::uint32_t kSignBit = 512;

}  // namespace

std::optional<std::uint32_t> compress(const Quaternion& rotation) {
  const double norm = rotation.norm();
  if (!std::isfinite(norm) || norm < 1e-6) {
    return std::nullopt;
  }
  const std::array<double, 4> xyzw{rotation.x() / norm, rotation.y() / norm, rotation.z() / norm,
                                   rotation.w() / norm};
  const auto largest = static_cast<std::uint32_t>(
      std::ranges::max_element(xyzw, {}, [](double c) { return std::abs(c); }) - xyzw.begin());
  const bool is_negated = xyzw[largest] < 0.0;
  std::uint32_t out = largest;
  for (std::uint32_t i = 0; i < xyzw.size(); ++i) {
    if (i == largest) {
      continue;
    }
    const std::uint32_t sign = (xyzw[i] < 0.0) != is_negated ? kSignBit : 0U;
    const auto magnitude =
        static_cast<std::uint32_t>(kMagnitudeMask * std::abs(xyzw[i]) * std::numbers::sqrt2 + 0.5);
    out = out << 10U | sign | std::min(magnitude, kMagnitudeMask);
  }
  return out;
}

Quaternion decompress(std::uint32_t bits) {
  const std::uint32_t largest = bits >> 30U;
  std::array<double, 4> xyzw{};
  double rest = 1.0;
  for (std::uint32_t i = 4; i-- > 0;) {
    if (i == largest) {
      continue;
    }
    const double magnitude = (bits & kMagnitudeMask) / (kMagnitudeMask * std::numbers::sqrt2);
    xyzw[i] = (bits & kSignBit) != 0U ? -magnitude : magnitude;
    rest -= magnitude * magnitude;
    bits >>= 10U;
  }
  xyzw[largest] = std::sqrt(std::max(0.0, rest));
  return Quaternion(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized();
}

float from_half(std::uint16_t bits) {
  const int exponent = bits >> 10U & 31;
  const int fraction = bits & 1023;
  const float sign = (bits & 0x8000U) != 0U ? -1.0F : 1.0F;
  if (exponent == 31) {
    return fraction == 0 ? sign * std::numeric_limits<float>::infinity()
                         : std::numeric_limits<float>::quiet_NaN();
  }
  return exponent == 0 ? sign * std::ldexp(static_cast<float>(fraction), -24)
                       : sign * std::ldexp(static_cast<float>(1024 + fraction), exponent - 25);
}

std::uint16_t to_half(float value) {
  constexpr std::uint16_t kInfinity = 0x7C00;
  const std::uint16_t sign = std::signbit(value) ? 0x8000 : 0;
  if (std::isnan(value)) {
    return kInfinity | 0x200U;
  }
  const float size = std::abs(value);
  int exponent = 0;
  static_cast<void>(std::frexp(size, &exponent));  // size = f · 2^exponent with f in [0.5, 1)
  const int step = std::max(exponent - 11, -24);   // exponent of the last bit
  const auto units =
      size < 65536.0F
          ? static_cast<std::uint32_t>(std::nearbyint(std::ldexp(static_cast<double>(size), -step)))
          : 0U;
  if (size >= 65520.0F) {
    return sign | kInfinity;
  }
  // A normal number has 1024 units or more. If rounding gives 2048, the sum carries into the
  // exponent.
  const std::uint32_t bits =
      units < 1024 ? units : (static_cast<std::uint32_t>(step + 24) << 10U) + units;
  return static_cast<std::uint16_t>(sign | bits);
}

}  // namespace vantage::wire::crtp
