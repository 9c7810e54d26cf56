#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vantage::test {

/// Takes `input` as datagrams of up to 16 senders, one after the other, through all that stands
/// between a socket and those who hear: packet, reassembly, decoding of every wire type, the log.
/// Ends the program by abort() when a promise is broken. Each datagram: a byte (who; how much time
/// has passed), its length (big-endian, 2 bytes), its bytes; the last may be cut short.
void fuzz_packet_path(std::span<const std::uint8_t> input);

/// Inputs to start from: each wire type in one datagram, in fragments in and out of order, doubled.
std::vector<std::vector<std::uint8_t>> packet_path_samples();

}  // namespace vantage::test
