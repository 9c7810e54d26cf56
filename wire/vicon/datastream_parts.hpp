#pragma once

#include <string>

#include "wire/vicon/bytes.hpp"
#include "wire/vicon/datastream.hpp"

// Functions for parts that are common to the bodies of several blocks.

namespace vantage::wire::vicon::parts {

using LittleReader = Reader<std::endian::little>;
using LittleWriter = Writer<std::endian::little>;

inline constexpr std::size_t kCountBytes = 4;

inline void read_string(LittleReader& from, std::string& out) { out = from.text(from.count(1)); }

inline void write_string(LittleWriter& to, const std::string& text) {
  to.u32(static_cast<std::uint32_t>(text.size()));
  to.text(text);
}

inline void write_count(LittleWriter& to, std::size_t elements) {
  to.u32(static_cast<std::uint32_t>(elements));
}

/// Appends one block of `type`; `write` fills its body.
template <class Write>
void append_block(PacketWriter& packet, std::uint32_t type, const Write& write) {
  packet.begin_block(type);
  write(packet.body());
  packet.end_block();
}

}  // namespace vantage::wire::vicon::parts
