#include "sim/rover/rover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angle.hpp"

namespace vantage::sim {
namespace {

constexpr double kPredictionStepS = 0.05;
constexpr double kFarM = 2.0;  // m; beyond this distance a lower bound suffices

double ramp(double from, double to, double up, double down) {
  return to >= from ? std::min(to, from + up) : std::max(to, from - down);
}

double points_to_pieces_m(std::span<const Eigen::Vector2d> points_m,
                          std::span<const Eigen::Vector2d> corners_m) {
  double least_m2 = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p_m : points_m) {
    least_m2 = std::min(least_m2, (p_m - corners_m[0]).squaredNorm());
    for (std::size_t k = 0; k + 1 < corners_m.size(); ++k) {
      const Eigen::Vector2d piece_m = corners_m[k + 1] - corners_m[k];
      const Eigen::Vector2d to_p_m = p_m - corners_m[k];
      const double length2 = piece_m.squaredNorm();
      const double s = length2 > 0.0 ? std::clamp(to_p_m.dot(piece_m) / length2, 0.0, 1.0) : 0.0;
      least_m2 = std::min(least_m2, (to_p_m - s * piece_m).squaredNorm());
    }
  }
  return std::sqrt(least_m2);
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
  points_m_[n_++] = point_m;
  reach_m_ = std::max(reach_m_, (point_m - points_m_[0]).norm());
}

double distance_m(const StoppingPath& a, const StoppingPath& b) {
  const auto p = a.points_m();
  const auto q = b.points_m();
  const double bound_m = (p[0] - q[0]).norm() - a.reach_m() - b.reach_m();
  if (bound_m > kFarM) {
    return bound_m;
  }
  return std::min(points_to_pieces_m(p, q), points_to_pieces_m(q, p));
}

}  // namespace vantage::sim
