#pragma once

#include <memory>

#include "drivers/crazyflie/crazyradio.hpp"
#include "drivers/vehicle/port.hpp"
#include "wire/crtp/link_uri.hpp"

namespace vantage::drivers {

/// Opens the connection to a Crazyflie through a dongle. A thread exchanges packets continuously,
/// because the vehicle sends only in reply to a packet. A dongle that was removed is opened again.
std::unique_ptr<Port> open_radio_port(const wire::crtp::RadioUri& uri);
/// As above, with the given dongle.
std::unique_ptr<Port> open_radio_port(std::unique_ptr<UsbRadio> usb,
                                      const wire::crtp::RadioAddress& address);

}  // namespace vantage::drivers
