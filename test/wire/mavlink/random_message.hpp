#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <string_view>
#include <type_traits>

#include "wire/mavlink/frame.hpp"

namespace vantage::test {

/// Returns a random element: random bits, but a NaN is always the standard quiet NaN and characters
/// are printable. Every fourth element is zero, so that payloads are truncated.
template <class T>
T random_element(std::mt19937_64& rng) {
  if (rng() % 4 == 0) {
    return T{};
  }
  if constexpr (std::is_same_v<T, float>) {
    const float value = std::bit_cast<float>(static_cast<std::uint32_t>(rng()));
    return value == value ? value : std::numeric_limits<float>::quiet_NaN();
  } else if constexpr (std::is_same_v<T, char>) {
    return static_cast<char>(' ' + static_cast<char>(rng() % 95));
  } else {
    return static_cast<T>(rng());
  }
}

/// Returns a message with random contents; a text ends at its first zero.
template <class Message>
Message random_message(std::mt19937_64& rng) {
  Message message;
  const auto fill = [&rng](std::string_view, auto& field) {
    using Shape = wire::mavlink::FieldShape<std::remove_cvref_t<decltype(field)>>;
    using Element = typename Shape::Element;
    if constexpr (Shape::kCount == 0) {
      field = random_element<Element>(rng);
    } else {
      bool is_over = false;
      for (Element& element : field) {
        element = is_over ? Element{} : random_element<Element>(rng);
        is_over = is_over || (std::is_same_v<Element, char> && element == Element{});
      }
    }
  };
  Message::Fields::for_each(message, fill);
  if (rng() % 3 != 0) {
    Message::Extensions::for_each(message, fill);
  }
  return message;
}

/// Calls body.operator()<Message>() for every message type that the codec knows.
template <class Body>
void for_each_message(const Body& body) {
  const auto each = [&body]<class... Message>(const std::tuple<Message...>&) {
    (body.template operator()<Message>(), ...);
  };
  each(wire::mavlink::AllMessages{});
}

}  // namespace vantage::test
