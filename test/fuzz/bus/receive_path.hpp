#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vantage::test {

/// Passes `input` to a vehicle that requires signatures. `input` is a sequence of datagrams, each
/// after one control byte and two bytes of length. They are parsed, reassembled, verified, decoded
/// and passed to the vehicle's guard, which then ticks. If the highest control bit is set, the
/// harness signs the datagram's message as a process of the trial; the lower four bits are the
/// sender. Calls abort() if an unsigned message is delivered, a set-point is not finite, or memory
/// grows.
void fuzz_receive_path(std::span<const std::uint8_t> input);

/// Returns the initial inputs: each message of a flight, signed and unsigned, in one datagram and
/// in fragments.
std::vector<std::vector<std::uint8_t>> receive_path_samples();

}  // namespace vantage::test
