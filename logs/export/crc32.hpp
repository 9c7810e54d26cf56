#pragma once

#include <cstdint>
#include <string_view>

namespace vantage::logs {

/// CRC-32 of `bytes` after what `before` is the CRC-32 of (0: nothing).
/// Source: IEEE 802.3, reflected polynomial 0xEDB88320.
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

}  // namespace vantage::logs
