#pragma once

#include <cstdint>
#include <span>
#include <vector>

// Harnesses of parsers of untrusted bytes. Each harness calls abort() if a check fails. The
// function below each harness returns its initial inputs.

namespace vantage::test {

/// Passes `input`, cut into pieces according to its first byte, to the MAVLink parser; every
/// message is unpacked and its signature verified.
void fuzz_mavlink(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> mavlink_samples();

/// Reads `input` as a link URI, and as one CRTP packet with the decoders of both ends.
void fuzz_crtp(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> crtp_samples();

/// Reads `input` as an LCM log with arbitrary errors.
void fuzz_log(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> log_samples();

/// Passes `input` to the viewer as a browser's requests: Host, Origin, subprotocols, texts and
/// binary frames. (civetweb handles HTTP and WebSocket framing.)
void fuzz_viewer(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> viewer_samples();

}  // namespace vantage::test
