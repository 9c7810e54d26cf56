#pragma once

#include <initializer_list>
#include <string_view>
#include <vector>

#include "wire/natnet/packet.hpp"

namespace vantage::test {

/// Bytes of a payload, written field by field from the published tables.
struct NatNetBytes {
  std::vector<std::uint8_t> bytes;

  NatNetBytes& u16(std::uint16_t value) {
    return write([&](auto& to) { to.u16(value); });
  }
  NatNetBytes& u32(std::uint32_t value) {
    return write([&](auto& to) { to.u32(value); });
  }
  NatNetBytes& u64(std::uint64_t value) {
    return write([&](auto& to) { to.u64(value); });
  }
  NatNetBytes& i32(std::int32_t value) {
    return write([&](auto& to) { to.i32(value); });
  }
  NatNetBytes& f64(double value) {
    return write([&](auto& to) { to.f64(value); });
  }
  NatNetBytes& f32s(std::initializer_list<float> values) {
    for (const float value : values) {
      write([&](auto& to) { to.f32(value); });
    }
    return *this;
  }
  NatNetBytes& zeros(std::size_t count) {
    return write([&](auto& to) { to.zeros(count); });
  }
  NatNetBytes& text(std::string_view text) {
    return write([&](auto& to) {
      to.text(text);
      to.u8(0);
    });
  }
  NatNetBytes& append(const NatNetBytes& other) {
    bytes.insert(bytes.end(), other.bytes.begin(), other.bytes.end());
    return *this;
  }

 private:
  template <class Write>
  NatNetBytes& write(const Write& write) {
    wire::natnet::Writer to(bytes);
    write(to);
    return *this;
  }
};

}  // namespace vantage::test
