#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

// What stands in PARAM_VALUE, PARAM_SET and PARAM_REQUEST_READ besides plain numbers.

namespace vantage::wire::mavlink {

/// How a whole number stands in a float: as the float of that value (ArduPilot), or as its bytes
/// (PX4). Source: MAVLink developer guide, parameter protocol.
enum class ParameterEncoding { kCast, kBytewise };

/// Of param_type: MAV_PARAM_TYPE.
namespace parameter_type {
constexpr std::uint8_t kInt32 = 6;
constexpr std::uint8_t kFloat = 9;
}  // namespace parameter_type

/// The number that `wire` stands for. Types of eight bytes do not fit: NaN.
double decode_parameter(float wire, std::uint8_t type, ParameterEncoding encoding);
/// The other way; whole types are rounded, and kept in their range.
float encode_parameter(double value, std::uint8_t type, ParameterEncoding encoding);

/// A name as it travels: not terminated when it fills the field, cut behind it.
std::array<char, 16> parameter_id(std::string_view name);
std::string parameter_name(const std::array<char, 16>& id);

}  // namespace vantage::wire::mavlink
