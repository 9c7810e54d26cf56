#pragma once

#include <cstdint>
#include <string_view>

namespace vantage::logs {

/// Continues a CRC-32 over `bytes`. `before` is the CRC-32 of all preceding bytes; 0 if there are
/// none.
/// Source: IEEE 802.3, reflected polynomial 0xEDB88320.
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

}  // namespace vantage::logs
