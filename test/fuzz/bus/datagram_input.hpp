#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace vantage::test {

/// One datagram of a fuzzed input.
struct FuzzedDatagram {
  std::uint8_t control = 0;         ///< encodes sender and elapsed time
  std::vector<std::uint8_t> bytes;  ///< exactly sized, so that a read beyond the end is detected
};

/// Removes the first datagram from `input`: its control byte, its length (big-endian, 2 bytes) and
/// its bytes, which may be cut short. Returns nullopt when nothing is left.
inline std::optional<FuzzedDatagram> take_datagram(std::span<const std::uint8_t>& input) {
  constexpr std::size_t kHead = 3;
  if (input.size() <= kHead) {
    return std::nullopt;
  }
  const std::size_t announced = (std::size_t{input[1]} << 8U) | input[2];
  const auto bytes = input.subspan(kHead, std::min(announced, input.size() - kHead));
  FuzzedDatagram taken{input[0], {bytes.begin(), bytes.end()}};
  input = input.subspan(kHead + bytes.size());
  return taken;
}

}  // namespace vantage::test
