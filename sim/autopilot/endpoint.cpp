#include "sim/autopilot/endpoint.hpp"

namespace vantage::sim {

AutopilotEndpoint::AutopilotEndpoint(const AutopilotEmulatorSpec& spec,
                                     const std::string& driver_url, Time boot)
    : emulator_(spec, boot), socket_(driver_url) {}

void AutopilotEndpoint::run_to(Time now) {
  emulator_.advance_to(now);
  socket_.read_each([&](auto bytes, Time /*arrival*/) { emulator_.receive(bytes, now); });
  for (const auto& bytes : emulator_.take_output()) {
    socket_.write(bytes);
  }
}

}  // namespace vantage::sim
