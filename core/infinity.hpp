#pragma once

#include <limits>

namespace vantage {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace vantage
