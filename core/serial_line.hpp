#pragma once

#include <string>

namespace vantage {

/// A serial line can be set to this speed.
bool is_baud_rate(int baud);

/// Opens `device` as a raw line of 8 bits without parity or flow control, whose reads and writes
/// never wait; its descriptor, −1 when it is not there or refuses (errno says why). An empty line
/// reads as EAGAIN. Precondition: is_baud_rate(baud).
int open_serial_line(const std::string& device, int baud);

}  // namespace vantage
