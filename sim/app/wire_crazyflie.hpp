#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "sim/app/wire_vehicle.hpp"
#include "sim/crazyflie/crazyflie_emulator.hpp"

namespace vantage::sim {

/// Emulated Crazyflie on a UDP socket.
class WireCrazyflie : public EmulatedWireVehicle<CrazyflieEmulator> {
 public:
  /// @throws StartupError for a robot without a `crazyflie`, with a url that is not
  /// udp://HOST:PORT,
  ///         or if the port cannot be opened.
  WireCrazyflie(const scenario::RobotSpec& robot, const scenario::WindSpec& wind,
                std::uint64_t seed, Time start);

  void step(Time now, double dt_s) override;
  void exchange(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
};

}  // namespace vantage::sim
