#include "sim/rover/rover_endpoint.hpp"

namespace vantage::sim {

RoverEndpoint::RoverEndpoint(const RoverEmulatorSpec& spec, const std::string& driver_url,
                             Time start)
    : emulator_(spec, start), socket_(driver_url) {}

void RoverEndpoint::run_to(Time now) {
  emulator_.advance_to(now);
  socket_.read_each([&](auto bytes, Time /*arrival*/) { emulator_.receive(bytes, now); });
  if (const auto telemetry = emulator_.take_output()) {
    socket_.write(*telemetry);
  }
}

}  // namespace vantage::sim
