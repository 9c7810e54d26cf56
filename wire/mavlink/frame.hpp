#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "wire/mavlink/messages.hpp"

// MAVLink frames, which carry the messages. Source: MAVLink developer guide, serialization.

namespace vantage::wire::mavlink {

constexpr std::uint8_t kMarkerV1 = 0xFE;
constexpr std::uint8_t kMarkerV2 = 0xFD;
constexpr std::uint8_t kFlagSigned = 0x01;
constexpr std::size_t kPayloadMax = 255;
constexpr std::size_t kFrameMax = 10 + kPayloadMax + 2 + 13;

/// Sender of a frame, and its sequence number.
struct Origin {
  std::uint8_t system_id = 0;
  std::uint8_t component_id = 0;
  std::uint8_t sequence = 0;
  friend bool operator==(const Origin&, const Origin&) = default;
};

struct Signature {
  std::uint8_t link_id = 0;
  std::uint64_t timestamp_10us = 0;         ///< 10 µs since 2015-01-01, 48 bits
  std::array<std::uint8_t, 6> truncated{};  ///< first 48 bits of the SHA-256 hash
};

/// One frame with a valid CRC.
struct Frame {
  bool is_v1 = false;
  std::uint8_t incompatible_flags = 0;
  std::uint8_t compatible_flags = 0;
  Origin origin;
  std::uint32_t message_id = 0;
  std::uint8_t payload_size = 0;  ///< size as sent: version 2 removes trailing zeros
  std::array<std::uint8_t, kPayloadMax> payload{};
  std::uint16_t crc = 0;
  std::optional<Signature> signature;

  [[nodiscard]] std::span<const std::uint8_t> payload_bytes() const {
    return {payload.data(), payload_size};
  }
};

/// Returns the CRC that `frame` must carry. Precondition: find_message(frame.message_id).
std::uint16_t crc_of(const Frame& frame);
/// Appends header, payload and CRC of `frame` to `out`, without the signature.
void append_unsigned_bytes(const Frame& frame, std::vector<std::uint8_t>& out);
/// Appends all bytes of `frame` to `out`.
void append_bytes(const Frame& frame, std::vector<std::uint8_t>& out);

/// Writes the little-endian payload bytes of one element.
template <class T>
void put_element(T value, std::uint8_t* out) {
  using Bits = std::conditional_t<
      sizeof(T) == 1, std::uint8_t,
      std::conditional_t<sizeof(T) == 2, std::uint16_t,
                         std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
  const auto bits = std::bit_cast<Bits>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    out[i] = static_cast<std::uint8_t>(bits >> (8 * i));
  }
}
template <class T>
T element_at(const std::uint8_t* in) {
  using Bits = std::conditional_t<
      sizeof(T) == 1, std::uint8_t,
      std::conditional_t<sizeof(T) == 2, std::uint16_t,
                         std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bits |= std::uint64_t{in[i]} << (8 * i);
  }
  return std::bit_cast<T>(static_cast<Bits>(bits));
}

/// Returns `message` in an unsigned version-2 frame, with trailing zeros removed.
template <class Message>
Frame pack(const Message& message, const Origin& origin) {
  Frame frame;
  frame.origin = origin;
  frame.message_id = Message::kMessage.id;
  std::uint8_t* out = frame.payload.data();
  const auto put = [&out](std::string_view, const auto& field) {
    using Shape = FieldShape<std::remove_cvref_t<decltype(field)>>;
    if constexpr (Shape::kCount == 0) {
      put_element(field, out);
      out += sizeof(field);
    } else {
      for (const auto& element : field) {
        put_element(element, out);
        out += sizeof(element);
      }
    }
  };
  Message::Fields::for_each(message, put);
  Message::Extensions::for_each(message, put);
  std::size_t size = full_bytes<Message>();
  while (size > 1 && frame.payload[size - 1] == 0) {
    --size;
  }
  frame.payload_size = static_cast<std::uint8_t>(size);
  frame.crc = crc_of(frame);
  return frame;
}

/// Returns the message in `frame`; nullopt if the frame has another message id. Removed trailing
/// bytes are read as zero; bytes beyond the known fields are ignored.
template <class Message>
std::optional<Message> unpack(const Frame& frame) {
  if (frame.message_id != Message::kMessage.id) {
    return std::nullopt;
  }
  std::array<std::uint8_t, kPayloadMax> bytes{};
  std::copy_n(frame.payload.begin(), frame.payload_size, bytes.begin());
  if (frame.is_v1) {  // version 1 has no extensions
    std::fill(bytes.begin() + base_bytes<Message>(), bytes.end(), std::uint8_t{0});
  }
  const std::uint8_t* in = bytes.data();
  Message message;
  const auto take = [&in](std::string_view, auto& field) {
    using Shape = FieldShape<std::remove_cvref_t<decltype(field)>>;
    using Element = typename Shape::Element;
    if constexpr (Shape::kCount == 0) {
      field = element_at<Element>(in);
      in += sizeof(Element);
    } else {
      for (Element& element : field) {
        element = element_at<Element>(in);
        in += sizeof(Element);
      }
    }
  };
  Message::Fields::for_each(message, take);
  Message::Extensions::for_each(message, take);
  return message;
}

}  // namespace vantage::wire::mavlink
