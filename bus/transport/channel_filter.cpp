#include "bus/transport/channel_filter.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

#include "bus/transport/udpm_packet.hpp"

namespace vantage::bus::udpm {
namespace {

// The kernel runs the filter on the datagram including its UDP header of this size.
constexpr std::uint32_t kUdpHeaderBytes = 8;
constexpr std::uint32_t kChannelOffset = kUdpHeaderBytes + kShortHeaderBytes;
constexpr std::uint32_t kPass = 0xFFFFFFFF;
constexpr std::uint32_t kDrop = 0;

using Program = std::vector<sock_filter>;

void add(Program& out, int code, std::uint32_t value, std::size_t if_true = 0,
         std::size_t if_false = 0) {
  out.push_back({static_cast<std::uint16_t>(code), static_cast<std::uint8_t>(if_true),
                 static_cast<std::uint8_t>(if_false), value});
}

/// Appends instructions that pass a datagram whose channel begins with `bytes`; for other
/// datagrams, the next instruction follows. The length is tested first, because a load beyond the
/// end of a datagram would drop it.
void add_pattern(Program& out, const std::string& bytes) {
  struct Piece {
    int size_code;
    std::size_t offset;
    std::uint32_t value;
  };
  std::vector<Piece> pieces;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t left = bytes.size() - at;
    const std::size_t size = left >= 4 ? 4 : (left >= 2 ? 2 : 1);
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value = (value << 8U) | static_cast<std::uint8_t>(bytes[at + i]);
    }
    pieces.push_back({size == 4 ? BPF_W : (size == 2 ? BPF_H : BPF_B), at, value});
    at += size;
  }
  // Each piece needs two instructions; one more passes the datagram. A failed test jumps past all
  // of them.
  std::size_t left = 2 * pieces.size() + 1;
  add(out, BPF_LD | BPF_W | BPF_LEN, 0);
  add(out, BPF_JMP | BPF_JGE | BPF_K, kChannelOffset + static_cast<std::uint32_t>(bytes.size()), 0,
      left);
  for (const Piece& piece : pieces) {
    left -= 2;
    add(out, BPF_LD | piece.size_code | BPF_ABS,
        kChannelOffset + static_cast<std::uint32_t>(piece.offset));
    add(out, BPF_JMP | BPF_JEQ | BPF_K, piece.value, 0, left);
  }
  add(out, BPF_RET | BPF_K, kPass);
}

}  // namespace

std::optional<Program> channel_filter(std::span<const std::string_view> patterns) {
  Program out;
  add(out, BPF_LD | BPF_W | BPF_ABS, kUdpHeaderBytes);
  add(out, BPF_JMP | BPF_JEQ | BPF_K, kShortMagic, 1, 0);
  add(out, BPF_RET | BPF_K, kPass);
  for (const std::string_view pattern : patterns) {
    const bool is_prefix = !pattern.empty() && pattern.back() == '*';
    std::string bytes(pattern.substr(0, pattern.size() - (is_prefix ? 1 : 0)));
    if (is_prefix && bytes.empty()) {
      return std::nullopt;
    }
    if (!is_prefix) {
      bytes.push_back('\0');
    }
    // LCM has no channel names longer than this, so a longer pattern matches nothing.
    if (bytes.size() <= kChannelBytesMax + 1) {
      add_pattern(out, bytes);
    }
    if (out.size() >= kFilterInstructionsMax) {
      return std::nullopt;
    }
  }
  add(out, BPF_RET | BPF_K, kDrop);
  return out;
}

}  // namespace vantage::bus::udpm
