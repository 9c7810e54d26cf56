#pragma once

#include <string>

namespace vantage {

/// True if a serial line supports this speed.
bool is_baud_rate(int baud);

/// Opens `device` as a raw 8-bit line without parity and flow control, with non-blocking reads and
/// writes. Returns the descriptor, or −1 with errno set if the device is absent or cannot be
/// opened. Reading without available data gives EAGAIN. Precondition: is_baud_rate(baud).
int open_serial_line(const std::string& device, int baud);

}  // namespace vantage
