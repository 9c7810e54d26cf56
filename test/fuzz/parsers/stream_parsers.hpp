#pragma once

#include <cstdint>
#include <span>
#include <vector>

// Harnesses of what reads other people's bytes. Each ends the program by abort() when a promise is
// broken; what each starts from is at its side.

namespace vantage::test {

/// MAVLink: a stream in pieces as its first byte says, every message unpacked, signatures judged.
void fuzz_mavlink(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> mavlink_samples();

/// An LCM log with anything wrong in it.
void fuzz_log(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> log_samples();

/// What a browser says to the viewer: Host, Origin, subprotocols, texts and binary frames. (HTTP
/// and WebSocket framing is civetweb's.)
void fuzz_viewer(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> viewer_samples();

}  // namespace vantage::test
