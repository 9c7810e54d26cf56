#pragma once

#include <cstdint>

#include "models/autopilot/dialect.hpp"

namespace vantage::test {

/// Somebody else who speaks to the autopilot of a firmware that `vantage up` started on this host:
/// by its second link (ArduPilot: TCP 5762 + 10 instance, PX4: UDP 18570 + instance), past its
/// driver.
class SecondStation {
 public:
  SecondStation(models::AutopilotDialect dialect, int instance, int system_id);
  ~SecondStation();
  SecondStation(const SecondStation&) = delete;
  SecondStation& operator=(const SecondStation&) = delete;

  // Each: false when it could not be sent.
  /// Out of the mode in which it takes set-points, into one in which it stands still: ArduPilot's
  /// Brake; PX4, which has no Hold where there is no global position, by sticks in their middle.
  bool take_over();
  /// To be called 10 times a second or more until it is given back.
  bool keep();
  bool give_back();
  /// Its simulated battery: at once (ArduPilot), within half a minute (PX4).
  bool empty_battery();
  bool fill_battery();
  /// The first one, for good; ArduPilot's alone.
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
