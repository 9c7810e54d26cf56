#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Sets `is_near` to 1 for the `robots` at a horizontal distance of at most `within_m` from robot
/// `own` in `frame`, and to 0 for the others. The entry of `own` is not changed. Robots that are
/// occluded or missing in the frame keep their value; if `own` is missing, all values stay
/// unchanged. Takes O(robots) if the frame lists the robots in the order of `robots`. Precondition:
/// is_near has the size of robots.
void find_neighbours(const MocapFrame& frame, const std::vector<std::string>& robots,
                     std::size_t own, double within_m, std::vector<std::uint8_t>& is_near);

}  // namespace vantage::models
