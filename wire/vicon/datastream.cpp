#include "wire/vicon/datastream.hpp"

#include <algorithm>
#include <array>

namespace vantage::wire::vicon {
namespace {

// Source: the static and dynamic object types of the SDK.
constexpr std::array<std::uint32_t, 17> kStaticTypes{1,  2,     3,  4,  14, 1401, 19, 20, 27,
                                                     28, 28001, 29, 33, 34, 37,   38, 40};

}  // namespace

bool is_static(std::uint32_t type) {
  return std::find(kStaticTypes.begin(), kStaticTypes.end(), type) != kStaticTypes.end();
}

bool is_dynamic(std::uint32_t type) {
  return type != kPing && type < kObjectEnums && !is_static(type);
}

Framed next_packet(Bytes stream) {
  for (std::size_t i = 0; i < std::min<std::size_t>(stream.size(), 4); ++i) {
    if (stream[i] != static_cast<std::uint8_t>(kPacketMagic >> (8U * i))) {
      return {Framing::kBroken, {}, 0};
    }
  }
  if (stream.size() < kPacketHeaderBytes) {
    return {Framing::kNeedMore, {}, 0};
  }
  Reader<std::endian::little> header(stream.subspan(4));
  const std::size_t body_bytes = header.u32();
  if (body_bytes > kPacketBytesMax - kPacketHeaderBytes) {
    return {Framing::kBroken, {}, 0};
  }
  if (stream.size() - kPacketHeaderBytes < body_bytes) {
    return {Framing::kNeedMore, {}, 0};
  }
  return {Framing::kWhole, stream.subspan(kPacketHeaderBytes, body_bytes),
          kPacketHeaderBytes + body_bytes};
}

std::optional<Block> BlockCursor::next() {
  if (reader_.left() == 0) {
    return std::nullopt;
  }
  Block block;
  block.type = reader_.u32();
  const std::size_t bytes = reader_.u32();
  block.body = reader_.take(bytes);
  if (!reader_.ok()) {
    return std::nullopt;
  }
  return block;
}

PacketWriter::PacketWriter(std::vector<std::uint8_t>& out)
    : writer_(out), packet_start_(out.size()) {
  writer_.u32(kPacketMagic);
  writer_.u32(0);
}

void PacketWriter::begin_block(std::uint32_t type) {
  block_start_ = writer_.size();
  writer_.u32(type);
  writer_.u32(0);
}

void PacketWriter::end_block() {
  writer_.patch_u32(block_start_ + 4,
                    static_cast<std::uint32_t>(writer_.size() - block_start_ - 8));
}

void PacketWriter::finish() {
  writer_.patch_u32(packet_start_ + 4, static_cast<std::uint32_t>(writer_.size() - packet_start_ -
                                                                  kPacketHeaderBytes));
}

}  // namespace vantage::wire::vicon
