#pragma once

#include <cstddef>

namespace vantage {

/// Converts a non-negative index to std::size_t for containers.
template <class Integer>
constexpr std::size_t index(Integer i) {
  return static_cast<std::size_t>(i);
}

}  // namespace vantage
