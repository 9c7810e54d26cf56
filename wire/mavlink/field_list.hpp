#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "wire/mavlink/crc.hpp"

// Each message is described once, by a struct and the list of its members. Names, order, lengths,
// encoding, decoding and CRC_EXTRA all follow from this description.

namespace vantage::wire::mavlink {

struct MessageName {
  std::string_view name;
  std::uint32_t id = 0;
};

/// Returns the name of a data member as the compiler prints it: "custom_mode".
template <auto Member>
constexpr std::string_view field_name() {
  std::string_view text = __PRETTY_FUNCTION__;
  text.remove_prefix(text.find("Member = ") + 9);
  text = text.substr(0, text.find_first_of(";]"));
  return text.substr(text.rfind(':') + 1);
}

/// Element type, count and size of a field, which may be an array.
template <class T>
struct FieldShape {
  using Element = T;
  static constexpr std::size_t kCount = 0;  ///< 0: not an array
  static constexpr std::size_t kBytes = sizeof(T);
};
template <class T, std::size_t n>
struct FieldShape<std::array<T, n>> {
  using Element = T;
  static constexpr std::size_t kCount = n;
  static constexpr std::size_t kBytes = n * sizeof(T);
};

/// Pointers to members of one message, in the order of transmission.
template <auto... members>
struct FieldList {
  /// Calls visit(name, reference) with each field of `message`.
  template <class Message, class Visit>
  static constexpr void for_each([[maybe_unused]] Message& message,
                                 [[maybe_unused]] const Visit& visit) {
    (visit(field_name<members>(), message.*members), ...);
  }
};

template <class First, class Second>
struct JoinedFields;
template <auto... first, auto... second>
struct JoinedFields<FieldList<first...>, FieldList<second...>> {
  using Type = FieldList<first..., second...>;
};
/// List of the fields of `First`, then those of `Second`, for messages that share their first
/// fields.
template <class First, class Second>
using Joined = typename JoinedFields<First, Second>::Type;

/// Returns the name of a type in the message definitions.
template <class T>
constexpr std::string_view type_name() {
  if constexpr (std::is_same_v<T, float>) {
    return "float";
  } else if constexpr (std::is_same_v<T, char>) {
    return "char";
  } else if constexpr (std::is_signed_v<T>) {
    constexpr std::array<std::string_view, 9> kNames{"", "int8_t", "int16_t", "",       "int32_t",
                                                     "", "",       "",        "int64_t"};
    return kNames[sizeof(T)];
  } else {
    constexpr std::array<std::string_view, 9> kNames{"", "uint8_t", "uint16_t", "", "uint32_t", "",
                                                     "", "",        "uint64_t"};
    return kNames[sizeof(T)];
  }
}

/// Returns the size of `Fields` in a payload before truncation, bytes.
template <class Message, class Fields>
constexpr std::size_t payload_bytes() {
  std::size_t bytes = 0;
  const Message message{};
  Fields::for_each(message, [&](std::string_view, const auto& field) {
    bytes += FieldShape<std::remove_cvref_t<decltype(field)>>::kBytes;
  });
  return bytes;
}
template <class Message>
constexpr std::size_t base_bytes() {
  return payload_bytes<Message, typename Message::Fields>();
}
template <class Message>
constexpr std::size_t full_bytes() {
  return base_bytes<Message>() + payload_bytes<Message, typename Message::Extensions>();
}

/// Returns a checksum over a message's name, field types and field names. This checksum is part of
/// each frame's CRC, so that two peers with different definitions reject each other's frames.
/// Extensions are excluded. Source: MAVLink developer guide, serialization, CRC_EXTRA.
template <class Message>
constexpr std::uint8_t crc_extra() {
  Crc crc;
  crc.add(Message::kMessage.name);
  crc.add(" ");
  const Message message{};
  Message::Fields::for_each(message, [&](std::string_view name, const auto& field) {
    using Shape = FieldShape<std::remove_cvref_t<decltype(field)>>;
    crc.add(type_name<typename Shape::Element>());
    crc.add(" ");
    crc.add(name);
    crc.add(" ");
    if (Shape::kCount != 0) {
      crc.add(static_cast<std::uint8_t>(Shape::kCount));
    }
  });
  return static_cast<std::uint8_t>((crc.value() & 0xFFU) ^ (crc.value() >> 8U));
}

}  // namespace vantage::wire::mavlink
