#pragma once

#include <cstdint>
#include <span>
#include <vector>

// Harnesses of the decoders of mocap protocols; they work like those of stream_parsers.hpp.

namespace vantage::test {

/// Decodes `input` after its first byte as a NatNet datagram, and its payload as every kind of
/// packet. The first byte selects the version. Decoded frames are encoded and decoded again.
void fuzz_natnet(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> natnet_samples();

/// Decodes `input` as a QTM stream, as a data packet and as an XML document. Decoded frames are
/// encoded and decoded again.
void fuzz_qtm(std::span<const std::uint8_t> input);
std::vector<std::vector<std::uint8_t>> qtm_samples();

}  // namespace vantage::test
