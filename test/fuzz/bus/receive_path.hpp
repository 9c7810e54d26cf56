#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vantage::test {

/// Lets a vehicle that demands signatures hear `input`: datagrams one after the other, each behind
/// one byte of control and two of its length. They are taken apart, put together, verified,
/// decoded and handed to its guard, which ticks. The upper bit of control has the harness sign the
/// datagram's message as a process of the trial would; its lower four bits are the sender. Ends the
/// program by abort() when a promise is broken: something unsigned is handed on, a set-point is not
/// finite, memory grows.
void fuzz_receive_path(std::span<const std::uint8_t> input);

/// Inputs to start from: each message of a flight, signed and not, whole and in fragments.
std::vector<std::vector<std::uint8_t>> receive_path_samples();

}  // namespace vantage::test
