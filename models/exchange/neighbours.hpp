#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Sets is_near[i] to 1 if robots[i] is within `within_m` (horizontally) of robot `own` in `frame`,
/// else to 0; `own` itself keeps its flag. Robots missing from the frame keep their previous flag;
/// if `own` is missing, all flags are kept. O(robots) if frames list the bodies in the order of
/// `robots`. Precondition: is_near has the size of robots.
void find_neighbours(const MocapFrame& frame, const std::vector<std::string>& robots,
                     std::size_t own, double within_m, std::vector<std::uint8_t>& is_near);

}  // namespace vantage::models
