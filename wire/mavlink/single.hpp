#pragma once

namespace vantage::wire::mavlink {

/// Returns `x` in single precision, which most MAVLink fields have.
constexpr float f32(double x) { return static_cast<float>(x); }

}  // namespace vantage::wire::mavlink
