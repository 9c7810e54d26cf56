#pragma once

#include <cstdint>
#include <string_view>

namespace vantage::logs {

/// Returns the CRC-32 of the bytes with CRC-32 `before` (0: none) followed by `bytes`.
/// Source: IEEE 802.3, reflected polynomial 0xEDB88320.
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

}  // namespace vantage::logs
