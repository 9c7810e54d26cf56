#include "wire/mavlink/parameter.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace vantage::wire::mavlink {
namespace {

/// Calls use(T{}) with T, the integer type of up to four bytes that `type` denotes; returns false
/// for other types.
template <class Use>
bool with_whole_type(std::uint8_t type, const Use& use) {
  switch (type) {
    case 1:
      use(std::uint8_t{});
      return true;
    case 2:
      use(std::int8_t{});
      return true;
    case 3:
      use(std::uint16_t{});
      return true;
    case 4:
      use(std::int16_t{});
      return true;
    case 5:
      use(std::uint32_t{});
      return true;
    case 6:
      use(std::int32_t{});
      return true;
    default:
      return false;
  }
}

constexpr double kNotThere = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double decode_parameter(float wire, std::uint8_t type, ParameterEncoding encoding) {
  if (encoding == ParameterEncoding::kCast || type == parameter_type::kFloat) {
    return static_cast<double>(wire);
  }
  double out = kNotThere;
  with_whole_type(type, [&](auto whole) {
    // The bytes are little-endian: the low bytes are first.
    out = static_cast<double>(static_cast<decltype(whole)>(std::bit_cast<std::uint32_t>(wire)));
  });
  return out;
}

float encode_parameter(double value, std::uint8_t type, ParameterEncoding encoding) {
  auto out = static_cast<float>(value);
  with_whole_type(type, [&](auto whole) {
    using Whole = decltype(whole);
    const auto kept = static_cast<Whole>(
        std::clamp(std::round(value), static_cast<double>(std::numeric_limits<Whole>::min()),
                   static_cast<double>(std::numeric_limits<Whole>::max())));
    out = encoding == ParameterEncoding::kCast
              ? static_cast<float>(kept)
              : std::bit_cast<float>(static_cast<std::uint32_t>(kept));
  });
  return out;
}

std::array<char, 16> parameter_id(std::string_view name) {
  std::array<char, 16> out{};
  std::copy_n(name.begin(), std::min(name.size(), out.size()), out.begin());
  return out;
}

std::string parameter_name(const std::array<char, 16>& id) {
  return {id.begin(), std::find(id.begin(), id.end(), '\0')};
}

}  // namespace vantage::wire::mavlink
