#include "drivers/crazyflie/telemetry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angle.hpp"
#include "wire/crtp/compression.hpp"

namespace vantage::drivers {
namespace {

namespace crtp = wire::crtp;
using crtp::ValueType;

constexpr std::array<LoggedVariable, 7> kState{{{"stateEstimate.x", ValueType::kF32},
                                                {"stateEstimate.y", ValueType::kF32},
                                                {"stateEstimate.z", ValueType::kF32},
                                                {"stateEstimate.vx", ValueType::kF16},
                                                {"stateEstimate.vy", ValueType::kF16},
                                                {"stateEstimate.vz", ValueType::kF16},
                                                {"stateEstimateZ.quat", ValueType::kU32}}};
constexpr std::array<LoggedVariable, 6> kHealth{{{"supervisor.info", ValueType::kU16},
                                                 {"kalman.varX", ValueType::kF16},
                                                 {"kalman.varY", ValueType::kF16},
                                                 {"kalman.varZ", ValueType::kF16},
                                                 {"gyro.z", ValueType::kF16},
                                                 {"pm.vbat", ValueType::kF16, true}}};
constexpr double kBatteryKept = 0.975;  // weight of the old value per report; time constant 2 s

}  // namespace

std::span<const LoggedVariable> logged_variables(std::uint8_t block) {
  return block == kStateBlock ? std::span<const LoggedVariable>(kState)
                              : std::span<const LoggedVariable>(kHealth);
}

void CrazyflieTelemetry::take(const crtp::LogData& data, bool has_battery, Time now) {
  crtp::Bytes rest = data.values;
  std::array<double, kState.size()> values{};
  const auto variables = logged_variables(data.block);
  const std::size_t count =
      data.block == kHealthBlock && !has_battery ? variables.size() - 1 : variables.size();
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = crtp::take_value(rest, variables[i].type);
    if (!value) {
      return;  // another block with this number
    }
    values[i] = *value;
  }
  if (!rest.empty()) {
    return;
  }
  if (data.block == kStateBlock) {
    state_at_ = now;
    position_world_m_ = {values[0], values[1], values[2]};
    velocity_world_mps_ = {values[3], values[4], values[5]};
    world_from_body_ = crtp::decompress(static_cast<std::uint32_t>(values[6]));
    return;
  }
  take_info(static_cast<std::uint16_t>(values[0]), now);
  const double variance_m2 = std::max({values[1], values[2], values[3]});
  const bool is_known = std::isfinite(values[1] + values[2] + values[3]);
  sigma_m_ =
      is_known ? std::sqrt(std::max(0.0, variance_m2)) : std::numeric_limits<double>::infinity();
  yaw_rate_radps_ = values[4] * kPi / 180.0;
  if (has_battery && std::isfinite(values[5])) {
    battery_v_ =
        battery_at_ ? kBatteryKept * battery_v_ + (1.0 - kBatteryKept) * values[5] : values[5];
    battery_at_ = now;
  }
}

double CrazyflieTelemetry::tilt_rad() const {
  return std::acos(std::clamp((world_from_body_ * Eigen::Vector3d::UnitZ()).z(), -1.0, 1.0));
}

}  // namespace vantage::drivers
