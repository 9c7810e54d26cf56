#include "models/motion/unicycle.hpp"

#include <cmath>

namespace vantage::models {
namespace {

double sinc(double a) {
  return std::abs(a) < 1e-4 ? 1.0 - a * a / 6.0
                            : std::sin(a) / a;  // the next term, a⁴/120, is below 1e-18
}

std::vector<UnicycleControl> primitives_of(std::initializer_list<double> speeds_mps) {
  std::vector<UnicycleControl> primitives;
  for (const double speed_mps : speeds_mps) {
    for (const double yaw_rate_radps : {0.0, 1.0, -1.0, 3.0, -3.0}) {
      primitives.push_back({speed_mps, yaw_rate_radps});
    }
  }
  return primitives;
}

}  // namespace

Pose2 step_unicycle(const Pose2& world_from_body, const UnicycleControl& control,
                    double duration_s) {
  const double half_turn_rad = 0.5 * control.yaw_rate_radps * duration_s;
  const double chord_m = control.speed_mps * duration_s * sinc(half_turn_rad);
  const double heading_rad = world_from_body.yaw_rad + half_turn_rad;
  return {world_from_body.x_m + chord_m * std::cos(heading_rad),
          world_from_body.y_m + chord_m * std::sin(heading_rad),
          wrap_to_pi(world_from_body.yaw_rad + control.yaw_rate_radps * duration_s)};
}

std::vector<UnicycleControl> standard_primitives() { return primitives_of({1.0, 3.0}); }
std::vector<UnicycleControl> lab_primitives() { return primitives_of({1.0}); }

}  // namespace vantage::models
