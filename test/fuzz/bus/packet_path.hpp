#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vantage::test {

/// Passes `input`, a sequence of datagrams of up to 16 senders, through the whole path from socket
/// to subscriber: packet parser, reassembly, decoder of every wire type, log. Calls abort() if a
/// check fails. Each datagram has a control byte (sender and elapsed time), its length (big-endian,
/// 2 bytes) and its bytes; the last one may be cut short.
void fuzz_packet_path(std::span<const std::uint8_t> input);

/// Returns the initial inputs: each wire type in one datagram, in fragments in and out of order,
/// and duplicated.
std::vector<std::vector<std::uint8_t>> packet_path_samples();

}  // namespace vantage::test
