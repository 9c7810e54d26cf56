#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Who of `robots` is within `within_m` of robot `own` on the ground in `frame`: 1 in `is_near`,
/// one for each; `own` itself is 0. Who is not seen stays what he was, and all do where `own` is
/// not seen. O(robots) where frames have them in this order. Precondition: is_near has the size of
/// robots.
void find_neighbours(const MocapFrame& frame, const std::vector<std::string>& robots,
                     std::size_t own, double within_m, std::vector<std::uint8_t>& is_near);

}  // namespace vantage::models
