#pragma once

namespace vantage::models {

/// Motion limits and size of a vehicle.
struct VehicleLimits {
  double speed_max_mps = 3.0;
  double yaw_rate_max_radps = 3.0;
  double brake_mps2 = 2.0;  ///< deceleration of the stop that ends every plan
  double radius_m = 0.25;   ///< of the disc around its centre that must stay free of obstacles
};

}  // namespace vantage::models
