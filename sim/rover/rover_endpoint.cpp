#include "sim/rover/rover_endpoint.hpp"

namespace vantage::sim {
namespace {

constexpr int kReadsMax = 64;  // in one run: a flood must not stop the vehicle

}  // namespace

RoverEndpoint::RoverEndpoint(const RoverEmulatorSpec& spec, const std::string& driver_url,
                             Time start)
    : emulator_(spec, start), socket_(driver_url) {}

void RoverEndpoint::run_to(Time now) {
  emulator_.advance_to(now);
  for (int i = 0; i < kReadsMax; ++i) {
    const auto datagram = socket_.read(buffer_);
    if (!datagram) {
      break;
    }
    emulator_.receive({buffer_.data(), datagram->bytes}, now);
  }
  if (const auto telemetry = emulator_.take_output()) {
    socket_.write(*telemetry);
  }
}

}  // namespace vantage::sim
