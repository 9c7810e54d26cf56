#pragma once

#include <vector>

#include "core/pose.hpp"

namespace vantage::models {

/// Constant command to a unicycle: forward speed and yaw rate, in the body frame.
struct UnicycleControl {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
  friend bool operator==(const UnicycleControl&, const UnicycleControl&) = default;
};

/// Returns the exact pose after `duration_s` of `control` (no integration error).
/// x' = x + ντ sinc(ωτ/2) cos(θ + ωτ/2), y' = y + ντ sinc(ωτ/2) sin(θ + ωτ/2), θ' = θ + ωτ wrapped.
/// Source: Schlotfeldt, dissertation, eq. 2.37 with the factor τ that is missing in eq. 3.5 and
/// 4.12.
Pose2 step_unicycle(const Pose2& world_from_body, const UnicycleControl& control,
                    double duration_s);

/// Returns {1, 3} m/s × {0, ±1, ±3} rad/s in that order: the ten primitives of the simulations.
std::vector<UnicycleControl> standard_primitives();
/// Returns 1 m/s × {0, ±1, ±3} rad/s: the five primitives of the hardware experiment.
std::vector<UnicycleControl> lab_primitives();

}  // namespace vantage::models
