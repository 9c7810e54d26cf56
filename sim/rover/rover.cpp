#include "sim/rover/rover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angle.hpp"

namespace vantage::sim {
namespace {

constexpr double kPredictionStepS = 0.05;

double ramp(double from, double to, double up, double down) {
  return to >= from ? std::min(to, from + up) : std::max(to, from - down);
}

}  // namespace

RoverState step_rover(const RoverState& state, const RoverCommand& command,
                      const RoverParameters& parameters, double dt_s) {
  RoverState next;
  next.speed_mps =
      ramp(state.speed_mps, std::clamp(command.speed_mps, 0.0, parameters.speed_max_mps),
           parameters.acceleration_mps2 * dt_s, parameters.brake_mps2 * dt_s);
  next.yaw_rate_radps =
      ramp(state.yaw_rate_radps,
           std::clamp(command.yaw_rate_radps, -parameters.yaw_rate_max_radps,
                      parameters.yaw_rate_max_radps),
           parameters.yaw_acceleration_radps2 * dt_s, parameters.yaw_acceleration_radps2 * dt_s);
  const double turn_rad = 0.5 * (state.yaw_rate_radps + next.yaw_rate_radps) * dt_s;
  const double travel_m = 0.5 * (state.speed_mps + next.speed_mps) * dt_s;
  const double heading_rad = state.world_from_body.yaw_rad + 0.5 * turn_rad;
  next.world_from_body = {state.world_from_body.x_m + travel_m * std::cos(heading_rad),
                          state.world_from_body.y_m + travel_m * std::sin(heading_rad),
                          wrap_to_pi(state.world_from_body.yaw_rad + turn_rad)};
  return next;
}

StoppingPath::StoppingPath(const RoverState& state, const RoverCommand& command,
                           const RoverParameters& parameters, double period_s) {
  append(state.world_from_body.position_m());
  const int driven = static_cast<int>(std::ceil(period_s / kPredictionStepS - 1e-9));
  RoverState at = state;
  for (int step = 0; n_ < kPointsMax; ++step) {
    if (step >= driven && at.speed_mps <= 0.0) {
      break;
    }
    at = step < driven ? step_rover(at, command, parameters, period_s / driven)
                       : step_rover(at, RoverCommand{}, parameters, kPredictionStepS);
    append(at.world_from_body.position_m());
  }
}

void StoppingPath::append(const Eigen::Vector2d& point_m) {
  if (n_ > 0) {
    sampling_error_m_ = std::max(sampling_error_m_, 0.5 * (point_m - points_m_[n_ - 1]).norm());
  }
  points_m_[n_++] = point_m;
}

double distance_m(const StoppingPath& a, const StoppingPath& b) {
  double least_m2 = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p : a.points_m()) {
    for (const Eigen::Vector2d& q : b.points_m()) {
      least_m2 = std::min(least_m2, (p - q).squaredNorm());
    }
  }
  return std::sqrt(least_m2) - a.sampling_error_m() - b.sampling_error_m();
}

}  // namespace vantage::sim
