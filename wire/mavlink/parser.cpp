#include "wire/mavlink/parser.hpp"

#include <algorithm>

namespace vantage::wire::mavlink {
namespace {

constexpr std::size_t kHeaderV1 = 6;
constexpr std::size_t kHeaderV2 = 10;
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kSignatureBytes = 13;

bool is_marker(std::uint8_t byte) { return byte == kMarkerV1 || byte == kMarkerV2; }

Signature read_signature(std::span<const std::uint8_t> bytes) {
  Signature signature;
  signature.link_id = bytes[0];
  for (unsigned i = 0; i < 6; ++i) {
    signature.timestamp_10us |= std::uint64_t{bytes[1 + i]} << (8 * i);
    signature.truncated[i] = bytes[7 + i];
  }
  return signature;
}

/// Reads header and payload without checking the CRC.
Frame read_without_crc_check(std::span<const std::uint8_t> bytes) {
  Frame frame;
  frame.is_v1 = bytes[0] == kMarkerV1;
  frame.payload_size = bytes[1];
  const std::size_t header = frame.is_v1 ? kHeaderV1 : kHeaderV2;
  if (frame.is_v1) {
    frame.origin = {bytes[3], bytes[4], bytes[2]};
    frame.message_id = bytes[5];
  } else {
    frame.incompatible_flags = bytes[2];
    frame.compatible_flags = bytes[3];
    frame.origin = {bytes[5], bytes[6], bytes[4]};
    frame.message_id = bytes[7] | std::uint32_t{bytes[8]} << 8U | std::uint32_t{bytes[9]} << 16U;
  }
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(header), frame.payload_size,
              frame.payload.begin());
  const std::size_t crc_at = header + frame.payload_size;
  frame.crc = static_cast<std::uint16_t>(bytes[crc_at] | bytes[crc_at + 1] << 8U);
  if ((frame.incompatible_flags & kFlagSigned) != 0) {
    frame.signature = read_signature(bytes.subspan(crc_at + kCrcBytes, kSignatureBytes));
  }
  return frame;
}

}  // namespace

std::size_t Parser::fill(std::span<const std::uint8_t> bytes) {
  if (begin_ != 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  // next() leaves less than one frame in the buffer, so the buffer always has free bytes.
  const std::size_t taken = std::min(bytes.size(), kBufferBytes - end_);
  std::copy_n(bytes.begin(), taken, buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
  end_ += taken;
  return taken;
}

void Parser::skip(std::size_t bytes) {
  begin_ += bytes;
  counts_.bytes_skipped += static_cast<std::int64_t>(bytes);
}

std::optional<Frame> Parser::next() {
  while (begin_ != end_) {
    if (!is_marker(buffer_[begin_])) {
      skip(1);
      continue;
    }
    bool is_incomplete = false;
    std::optional<Frame> frame = read_frame(is_incomplete);
    if (frame || is_incomplete) {
      return frame;
    }
  }
  return std::nullopt;
}

std::optional<Frame> Parser::read_frame(bool& is_incomplete) {
  const std::span<const std::uint8_t> bytes(buffer_.data() + begin_, end_ - begin_);
  const bool is_v1 = bytes[0] == kMarkerV1;
  const std::size_t header = is_v1 ? kHeaderV1 : kHeaderV2;
  if (bytes.size() < header) {
    is_incomplete = true;
    return std::nullopt;
  }
  const bool is_signed = !is_v1 && (bytes[2] & kFlagSigned) != 0;
  const std::size_t size =
      header + bytes[1] + kCrcBytes + (is_signed ? kSignatureBytes : std::size_t{0});
  if (bytes.size() < size) {
    is_incomplete = true;
    return std::nullopt;
  }
  Frame frame = read_without_crc_check(bytes.first(size));
  const MessageInfo* const message = find_message(frame.message_id);
  if (message == nullptr) {
    // The CRC of a message without known CRC_EXTRA cannot be checked. The bytes count as a frame if
    // they end the data or a marker follows.
    if (bytes.size() == size || is_marker(bytes[size])) {
      begin_ += size;
      ++counts_.unknown;
    } else {
      skip(1);
    }
    return std::nullopt;
  }
  Crc crc;
  crc.add(bytes.subspan(1, header + frame.payload_size - 1));
  crc.add(message->crc_extra);
  if (frame.crc != crc.value()) {
    skip(1);
    return std::nullopt;
  }
  begin_ += size;
  if ((frame.incompatible_flags & ~kFlagSigned) != 0) {
    ++counts_.unknown_flags;
    return std::nullopt;
  }
  ++counts_.frames;
  counts_.frames_v1 += is_v1 ? 1 : 0;
  return frame;
}

void SequenceMonitor::on_frame(const Origin& origin) {
  const auto sender = std::make_pair(origin.system_id, origin.component_id);
  const auto next = static_cast<std::uint8_t>(origin.sequence + 1);
  const auto found = expected_.find(sender);
  if (found == expected_.end()) {
    if (expected_.size() < kSendersMax) {
      expected_.emplace(sender, next);
    }
    return;
  }
  const auto gap = static_cast<std::uint8_t>(origin.sequence - found->second);
  if (gap >= 128) {
    ++out_of_order_;
    return;
  }
  lost_ += gap;
  found->second = next;
}

}  // namespace vantage::wire::mavlink
