#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "bus/node.hpp"
#include "core/time.hpp"
#include "drivers/quadrotor/driver.hpp"
#include "drivers/quadrotor/port.hpp"
#include "models/exchange/messages.hpp"
#include "models/scenario/scenario.hpp"

namespace vantage::drivers {

/// The 32 bytes of a key file; nullopt for an empty name.
/// @throws StartupError for a file that cannot be read or is not 32 bytes long.
std::optional<models::mavlink::SigningKey> load_key(const std::string& file);

/// vantage-quadrotor of one robot on the bus: VICON, PLAN_*, COMMAND and SCENARIO in, QUADROTOR_R
/// out at 10 Hz and on change; MAVLink on its port, looked at each 5 ms.
class QuadrotorNode : public bus::Node {
 public:
  /// @throws UsageError for a robot that is not in the scenario or has no autopilot.
  QuadrotorNode(bus::Bus& bus, const bus::Clock& clock, const models::Scenario& scenario,
                const std::string& robot, std::unique_ptr<Port> port);

  [[nodiscard]] std::string name() const override { return "QUADROTOR_" + robot_; }
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  /// The stack's time carried on by the machine's monotonic clock, so that a clock that is set
  /// does not move a vehicle.
  [[nodiscard]] Time steady_now() const;
  void send_output(Time now);
  void publish_status(Time now);

  bus::Bus& bus_;
  const bus::Clock& clock_;
  std::string robot_;
  QuadrotorDriver driver_;
  std::unique_ptr<Port> port_;
  Time started_;
  std::int64_t started_ns_;
  Time next_tick_;
  Time next_status_{};
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace vantage::drivers
