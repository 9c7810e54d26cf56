#pragma once

#include <cstdint>

#include "models/autopilot/dialect.hpp"

namespace vantage::test {

/// A second ground station for the autopilot of a firmware that `vantage up` started on this host.
/// The station uses the autopilot's second link (ArduPilot: TCP 5762 + 10 instance, PX4: UDP 18570
/// + instance), so its messages do not pass through the driver. The functions that send a message
/// return false if it could not be sent.
class SecondStation {
 public:
  SecondStation(models::AutopilotDialect dialect, int instance, int system_id);
  ~SecondStation();
  SecondStation(const SecondStation&) = delete;
  SecondStation& operator=(const SecondStation&) = delete;

  /// Switches the autopilot from the mode that accepts set-points to one in which it hovers.
  /// ArduPilot: Brake. PX4: Position mode with centred sticks, since Hold needs a global position.
  bool take_over();
  /// Keeps the vehicle in the mode of take_over(); call it at least 10 times per second until
  /// give_back().
  bool keep();
  bool give_back();
  /// Empties the simulated battery: immediately (ArduPilot) or within half a minute (PX4).
  bool empty_battery();
  bool fill_battery();
  /// Stops the first motor permanently; ArduPilot only.
  bool stop_motor();

 private:
  template <class Message>
  bool send(const Message& message);
  bool order_mode(float custom_mode);
  bool set(const char* name, double value, std::uint8_t type);

  models::AutopilotDialect dialect_;
  std::uint8_t system_id_;
  int socket_ = -1;
  std::uint8_t sequence_ = 0;
};

}  // namespace vantage::test
