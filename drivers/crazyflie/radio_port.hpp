#pragma once

#include <memory>

#include "drivers/crazyflie/crazyradio.hpp"
#include "drivers/vehicle/port.hpp"
#include "wire/crtp/link_uri.hpp"

namespace vantage::drivers {

/// Opens the connection to a Crazyflie by a dongle. A thread exchanges packets continuously,
/// because the vehicle can only answer. A dongle that is removed is opened again.
std::unique_ptr<Port> open_radio_port(const wire::crtp::RadioUri& uri);
/// As above, on a given dongle.
std::unique_ptr<Port> open_radio_port(std::unique_ptr<UsbRadio> usb,
                                      const wire::crtp::RadioAddress& address);

}  // namespace vantage::drivers
