#pragma once

#include <algorithm>
#include <cmath>

namespace vantage::models {

/// Returns the signed distance in m from a point to the border of a rectangle, negative inside.
/// `outside_x_m` and `outside_y_m` are the point's distances beyond the rectangle along each axis,
/// negative within it.
inline double border_distance_m(double outside_x_m, double outside_y_m) {
  return outside_x_m <= 0.0 || outside_y_m <= 0.0 ? std::max(outside_x_m, outside_y_m)
                                                  : std::hypot(outside_x_m, outside_y_m);
}

}  // namespace vantage::models
