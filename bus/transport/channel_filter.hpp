#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <linux/filter.h>

namespace vantage::bus::udpm {

/// Largest program of channel_filter(); the kernel accepts at least this size.
inline constexpr std::size_t kFilterInstructionsMax = 800;

/// Returns a socket filter (classic BPF) that drops LCM's short datagrams on channels that no
/// pattern matches, so that they do not wake the process. It passes all other datagrams: fragments,
/// because only the first fragment contains the channel, and malformed ones, which are counted.
/// Returns nullopt if every datagram must pass ("*"), or if the program would be too long.
std::optional<std::vector<sock_filter>> channel_filter(std::span<const std::string_view> patterns);

}  // namespace vantage::bus::udpm
