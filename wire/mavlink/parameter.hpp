#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

// Encodings of parameter values and names in PARAM_VALUE, PARAM_SET and PARAM_REQUEST_READ.

namespace vantage::wire::mavlink {

/// Encoding of integers in a float field: converted to float (ArduPilot), or copied bytewise (PX4).
/// Source: MAVLink developer guide, parameter protocol.
enum class ParameterEncoding { kCast, kBytewise };

/// Values of param_type, MAV_PARAM_TYPE.
namespace parameter_type {
constexpr std::uint8_t kInt32 = 6;
constexpr std::uint8_t kFloat = 9;
}  // namespace parameter_type

/// Returns the number encoded in the field `wire`; NaN for types of eight bytes, which do not fit
/// into the field.
double decode_parameter(float wire, std::uint8_t type, ParameterEncoding encoding);
/// Returns the encoded value; for integer types it is rounded and clamped to their range.
float encode_parameter(double value, std::uint8_t type, ParameterEncoding encoding);

/// Returns the name as a message field: cut at 16 characters, without a NUL if the name fills the
/// field.
std::array<char, 16> parameter_id(std::string_view name);
std::string parameter_name(const std::array<char, 16>& id);

}  // namespace vantage::wire::mavlink
