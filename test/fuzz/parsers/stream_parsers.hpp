#pragma once

#include <cstdint>
#include <span>
#include <vector>

// Harnesses of parsers of untrusted bytes. Each calls abort() when a promise is broken; the
// function below it returns its initial inputs.

namespace vantage::test {

/// MAVLink: a stream, cut into pieces according to its first byte; every message is unpacked and
/// its signature verified.
void fuzz_mavlink(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> mavlink_samples();

/// An LCM log with arbitrary errors.
void fuzz_log(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> log_samples();

/// Requests of a browser to the viewer: Host, Origin, subprotocols, texts and binary frames.
/// (civetweb handles HTTP and WebSocket framing.)
void fuzz_viewer(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> viewer_samples();

}  // namespace vantage::test
