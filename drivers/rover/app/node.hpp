#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "bus/node.hpp"
#include "core/time.hpp"
#include "drivers/quadrotor/port.hpp"
#include "drivers/rover/driver.hpp"
#include "models/exchange/messages.hpp"
#include "models/scenario/scenario.hpp"

namespace vantage::drivers {

/// vantage-rover of one robot on the bus: VICON, PLAN_*, COMMAND and SCENARIO in, QUADROTOR_R (the
/// channel of every vehicle's state) out at 10 Hz and on change; a command on its port each 20 ms
/// and at once on an operator's word.
class RoverNode : public bus::Node {
 public:
  /// @throws UsageError for a robot that is not in the scenario or is no rover.
  RoverNode(bus::Bus& bus, const bus::Clock& clock, const models::Scenario& scenario,
            const std::string& robot, std::unique_ptr<Port> port);

  [[nodiscard]] std::string name() const override { return "ROVER_" + robot_; }
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  /// The stack's time carried on by the machine's monotonic clock, so that a clock that is set
  /// does not move a vehicle.
  [[nodiscard]] Time steady_now() const;
  void act(Time now);

  bus::Bus& bus_;
  const bus::Clock& clock_;
  std::string robot_;
  RoverDriver driver_;
  std::unique_ptr<Port> port_;
  Time started_;
  std::int64_t started_ns_;
  Time next_tick_;
  Time next_status_{};
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace vantage::drivers
