#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Sets `is_near` to 1 for the `robots` within `within_m` of robot `own` on the ground in `frame`,
/// and to 0 for the others. The entry of `own` is not changed. Robots missing from the frame or
/// occluded keep their value; if `own` is missing, all do. O(robots) if frames contain the robots
/// in this order. Precondition: is_near has the size of robots.
void find_neighbours(const MocapFrame& frame, const std::vector<std::string>& robots,
                     std::size_t own, double within_m, std::vector<std::uint8_t>& is_near);

}  // namespace vantage::models
