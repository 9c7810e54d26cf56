#include "sim/autopilot/endpoint.hpp"

namespace vantage::sim {
namespace {

constexpr int kReadsMax = 64;  // in one run: a flood must not stop the vehicle

}  // namespace

AutopilotEndpoint::AutopilotEndpoint(const AutopilotEmulatorSpec& spec,
                                     const std::string& driver_url, Time boot)
    : emulator_(spec, boot), socket_(driver_url) {}

void AutopilotEndpoint::run_to(Time now) {
  emulator_.advance_to(now);
  for (int i = 0; i < kReadsMax; ++i) {
    const auto datagram = socket_.read(buffer_);
    if (!datagram) {
      break;
    }
    emulator_.receive({buffer_.data(), datagram->bytes}, now);
  }
  for (const auto& bytes : emulator_.take_output()) {
    socket_.write(bytes);
  }
}

}  // namespace vantage::sim
