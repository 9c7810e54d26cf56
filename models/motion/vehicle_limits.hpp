#pragma once

namespace vantage::models {

/// The limits of a vehicle's motion, and its size.
struct VehicleLimits {
  double speed_max_mps = 3.0;
  double yaw_rate_max_radps = 3.0;
  double brake_mps2 = 2.0;  ///< deceleration of the stop at the end of every plan
  /// radius of the disc around the vehicle's centre that must stay free of obstacles
  double radius_m = 0.25;
};

}  // namespace vantage::models
