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
  /// Out of the mode in which it takes set-points, into one in which it stands still.
  bool take_over();
  bool give_back();
  /// Its simulated battery: at once (ArduPilot), within half a minute (PX4).
  bool empty_battery();
  bool fill_battery();
  /// The first one, for good.
  bool stop_motor();

 private:
  template <class Message>
  bool send(const Message& message);
  bool set(const char* name, double value, std::uint8_t type);

  models::AutopilotDialect dialect_;
  std::uint8_t system_id_;
  int socket_ = -1;
  std::uint8_t sequence_ = 0;
};

}  // namespace vantage::test
