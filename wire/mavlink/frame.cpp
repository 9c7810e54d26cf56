#include "wire/mavlink/frame.hpp"

namespace vantage::wire::mavlink {
namespace {

/// Appends all bytes between the marker and the CRC.
void append_body(const Frame& frame, std::vector<std::uint8_t>& out) {
  const auto id_byte = [&frame](unsigned i) {
    return static_cast<std::uint8_t>(frame.message_id >> (8 * i));
  };
  out.push_back(frame.payload_size);
  if (!frame.is_v1) {
    out.push_back(frame.incompatible_flags);
    out.push_back(frame.compatible_flags);
  }
  out.push_back(frame.origin.sequence);
  out.push_back(frame.origin.system_id);
  out.push_back(frame.origin.component_id);
  out.push_back(id_byte(0));
  if (!frame.is_v1) {
    out.push_back(id_byte(1));
    out.push_back(id_byte(2));
  }
  const auto payload = frame.payload_bytes();
  out.insert(out.end(), payload.begin(), payload.end());
}

}  // namespace

std::uint16_t crc_of(const Frame& frame) {
  std::vector<std::uint8_t> body;
  body.reserve(kFrameMax);
  append_body(frame, body);
  Crc crc;
  crc.add(body);
  crc.add(find_message(frame.message_id)->crc_extra);
  return crc.value();
}

void append_unsigned_bytes(const Frame& frame, std::vector<std::uint8_t>& out) {
  out.push_back(frame.is_v1 ? kMarkerV1 : kMarkerV2);
  append_body(frame, out);
  out.push_back(static_cast<std::uint8_t>(frame.crc));
  out.push_back(static_cast<std::uint8_t>(frame.crc >> 8U));
}

void append_bytes(const Frame& frame, std::vector<std::uint8_t>& out) {
  append_unsigned_bytes(frame, out);
  if (frame.signature) {
    out.push_back(frame.signature->link_id);
    for (unsigned i = 0; i < 6; ++i) {
      out.push_back(static_cast<std::uint8_t>(frame.signature->timestamp_10us >> (8 * i)));
    }
    out.insert(out.end(), frame.signature->truncated.begin(), frame.signature->truncated.end());
  }
}

}  // namespace vantage::wire::mavlink
