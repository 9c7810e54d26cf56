#pragma once

namespace vantage::wire::mavlink {

/// `x` as most of MAVLink's fields have it.
constexpr float f32(double x) { return static_cast<float>(x); }

}  // namespace vantage::wire::mavlink
