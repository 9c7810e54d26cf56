#pragma once

#include <cstddef>

namespace vantage {

/// A number that counts from 0, as containers want it. Precondition: not negative.
template <class Integer>
constexpr std::size_t index(Integer i) {
  return static_cast<std::size_t>(i);
}

}  // namespace vantage
