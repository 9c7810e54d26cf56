#pragma once

#include <cstdint>
#include <span>
#include <vector>

// Harnesses of the decoders of mocap protocols; they work like those of stream_parsers.hpp.

namespace vantage::test {

/// Reads `input` after its first byte as a NatNet datagram and as the payload of each packet. The
/// first byte selects the version. Frames that are read are written and read again.
void fuzz_natnet(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> natnet_samples();

/// Reads `input` as a QTM stream, as a data packet and as an XML document. Frames that are read are
/// written and read again.
void fuzz_qtm(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> qtm_samples();

}  // namespace vantage::test
