#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "sim/app/wire_vehicle.hpp"
#include "sim/firmware/firmware_flight.hpp"

namespace vantage::sim {

/// Quadrotor controlled by unmodified autopilot firmware. The simulator supplies the body, which
/// begins on the ground at the robot's start. The firmware communicates with the driver directly.
class WireFirmware : public WireVehicle {
 public:
  /// @param instance  instance number of the firmware, which selects its ports
  /// @throws StartupError if a port cannot be opened.
  WireFirmware(const scenario::RobotSpec& robot, const scenario::WindSpec& wind, int instance,
               std::uint64_t seed);

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] double radius_m() const override { return radius_m_; }
  [[nodiscard]] Pose3 world_from_body() const override { return now_.world_from_body; }
  [[nodiscard]] Eigen::Vector3d velocity_world_mps() const override {
    return now_.velocity_world_mps;
  }
  /// Reads the state of the body, which FirmwareFlight moves in a separate thread.
  void step(Time now, double dt_s) override;
  void exchange(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  std::string name_;
  double radius_m_;
  FirmwareFlight flight_;
  FirmwareFlight::Sample now_;
  std::int64_t monotonic_minus_clock_ns_ = 0;  ///< ns; monotonic clock minus the stack's clock
  bool has_clock_ = false;
};

}  // namespace vantage::sim
