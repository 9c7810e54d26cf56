#include "wire/crtp/tables.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "wire/crtp/compression.hpp"
#include "wire/crtp/packet_builder.hpp"

namespace vantage::wire::crtp {
namespace {

constexpr std::uint8_t kTocItem = 2;
constexpr std::uint8_t kTocInfo = 3;
constexpr std::uint8_t kReadOnly = 0x40;
constexpr std::uint8_t kUnknown = 2;
constexpr std::uint8_t kLogBlocksMax = 16;
constexpr std::uint8_t kLogVariablesMax = 128;

struct TypeRow {
  ValueType type;
  std::size_t bytes;
  std::uint8_t parameter_code;
  std::uint8_t log_code;
};
constexpr std::array<TypeRow, 8> kTypes{{{ValueType::kU8, 1, 8, 1},
                                         {ValueType::kU16, 2, 9, 2},
                                         {ValueType::kU32, 4, 10, 3},
                                         {ValueType::kI8, 1, 0, 4},
                                         {ValueType::kI16, 2, 1, 5},
                                         {ValueType::kI32, 4, 2, 6},
                                         {ValueType::kF32, 4, 6, 7},
                                         {ValueType::kF16, 2, 5, 8}}};

const TypeRow& row_of(ValueType type) { return kTypes[static_cast<std::size_t>(type)]; }

std::uint32_t little_endian(Bytes bytes) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    out |= std::uint32_t{bytes[i]} << (8U * i);
  }
  return out;
}

/// Range of an integer type.
struct Range {
  double low = 0.0;
  double high = 0.0;
};
Range range_of(ValueType type) {
  switch (type) {
    case ValueType::kU8:
      return {0.0, 255.0};
    case ValueType::kU16:
      return {0.0, 65535.0};
    case ValueType::kU32:
      return {0.0, 4294967295.0};
    case ValueType::kI8:
      return {-128.0, 127.0};
    case ValueType::kI16:
      return {-32768.0, 32767.0};
    case ValueType::kI32:
      return {-2147483648.0, 2147483647.0};
    case ValueType::kF32:
    case ValueType::kF16:
      break;
  }
  return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
}

bool represents(ValueType type, double value) {
  if (type == ValueType::kF32) {
    return std::isfinite(static_cast<float>(value));
  }
  if (type == ValueType::kF16) {
    return std::isfinite(from_half(to_half(static_cast<float>(value))));
  }
  const Range range = range_of(type);
  return value >= range.low && value <= range.high && std::floor(value) == value;
}

}  // namespace

std::size_t size_bytes(ValueType type) { return row_of(type).bytes; }

std::uint8_t type_code(Port port, ValueType type) {
  return port == Port::kLog ? row_of(type).log_code : row_of(type).parameter_code;
}

std::optional<ValueType> type_from_code(Port port, std::uint8_t code) {
  const auto found = std::ranges::find_if(kTypes, [&](const TypeRow& row) {
    return (port == Port::kLog ? row.log_code : row.parameter_code) == code;
  });
  return found == kTypes.end() ? std::nullopt : std::optional(found->type);
}

Packet toc_info_request(Port port) { return PacketBuilder(port, 0).u8(kTocInfo).packet(); }

Packet toc_item_request(Port port, std::uint16_t id) {
  return PacketBuilder(port, 0).u8(kTocItem).u16(id).packet();
}

Packet toc_info_reply(Port port, const TocInfo& info) {
  PacketBuilder out(port, 0);
  out.u8(kTocInfo).u16(info.items).u32(info.crc);
  if (port == Port::kLog) {
    out.u8(kLogBlocksMax).u8(kLogVariablesMax);
  }
  return out.packet();
}

std::optional<Packet> toc_item_reply(Port port, const TocItem& item) {
  const unsigned flags = port == Port::kParameter && item.is_read_only ? kReadOnly : 0U;
  PacketBuilder out(port, 0);
  return out.u8(kTocItem)
      .u16(item.id)
      .u8(type_code(port, item.type) | flags)
      .text(item.group)
      .u8(0)
      .text(item.name)
      .u8(0)
      .finish();
}

std::optional<TocInfo> decode_toc_info(Port port, const Packet& packet) {
  if (!packet.is(port, 0) || packet.size < 7 || packet.data[0] != kTocInfo) {
    return std::nullopt;
  }
  return TocInfo{static_cast<std::uint16_t>(little_endian(packet.payload().subspan(1, 2))),
                 little_endian(packet.payload().subspan(3, 4))};
}

std::optional<TocItem> decode_toc_item(Port port, const Packet& packet) {
  if (!packet.is(port, 0) || packet.size < 5 || packet.data[0] != kTocItem) {
    return std::nullopt;
  }
  const Bytes payload = packet.payload();
  const auto type = type_from_code(port, packet.data[3] & 0x0FU);
  const Bytes names = payload.subspan(4);
  const auto middle = std::ranges::find(names, std::uint8_t{0});
  if (!type || middle == names.end()) {
    return std::nullopt;
  }
  TocItem out;
  out.id = static_cast<std::uint16_t>(little_endian(payload.subspan(1, 2)));
  out.type = *type;
  out.is_read_only = port == Port::kParameter && (packet.data[3] & kReadOnly) != 0;
  out.group.assign(names.begin(), middle);
  out.name.assign(middle + 1, std::find(middle + 1, names.end(), std::uint8_t{0}));
  return out;
}

Packet parameter_read(std::uint16_t id) {
  return PacketBuilder(Port::kParameter, 1).u16(id).packet();
}

std::optional<Packet> parameter_write(std::uint16_t id, ValueType type, double value) {
  if (!represents(type, value)) {
    return std::nullopt;
  }
  std::vector<std::uint8_t> bytes;
  append_value(bytes, type, value);
  return PacketBuilder(Port::kParameter, 2).u16(id).bytes(bytes).finish();
}

std::optional<std::uint16_t> parameter_reply_id(const Packet& packet) {
  const bool is_value = packet.is(Port::kParameter, 1) || packet.is(Port::kParameter, 2);
  if (!is_value || packet.size < 3) {
    return std::nullopt;
  }
  return static_cast<std::uint16_t>(little_endian(packet.payload().first(2)));
}

std::optional<ParameterReply> decode_parameter_reply(const Packet& packet, ValueType type) {
  const auto id = parameter_reply_id(packet);
  if (!id) {
    return std::nullopt;
  }
  ParameterReply out{*id, std::nullopt};
  Bytes rest = packet.payload().subspan(2);
  if (packet.channel == 1) {
    if (rest[0] == kUnknown && rest.size() == 1) {
      return out;
    }
    if (rest[0] != 0) {
      return std::nullopt;
    }
    rest = rest.subspan(1);
  } else if (rest.size() == 1 && rest[0] == kUnknown && size_bytes(type) != 1) {
    return out;
  }
  out.value = take_value(rest, type);
  return out.value && rest.empty() ? std::optional(out) : std::nullopt;
}

std::optional<Packet> log_create(std::uint8_t block, std::span<const LogVariable> variables) {
  PacketBuilder out(Port::kLog, 1);
  out.u8(kLogCreate).u8(block);
  std::size_t bytes = 0;
  for (const LogVariable& variable : variables) {
    out.u8(type_code(Port::kLog, variable.type)).u16(variable.id);
    bytes += size_bytes(variable.type);
  }
  return out.check(bytes <= kLogBytesMax).finish();
}

Packet log_start(std::uint8_t block, std::uint16_t period_ms) {
  return PacketBuilder(Port::kLog, 1).u8(kLogStart).u8(block).u16(period_ms).packet();
}

Packet log_stop(std::uint8_t block) {
  return PacketBuilder(Port::kLog, 1).u8(kLogStop).u8(block).packet();
}

Packet log_delete(std::uint8_t block) {
  return PacketBuilder(Port::kLog, 1).u8(kLogDelete).u8(block).packet();
}

Packet log_reply(const LogReply& reply) {
  return PacketBuilder(Port::kLog, 1).u8(reply.command).u8(reply.block).u8(reply.error).packet();
}

std::optional<LogReply> decode_log_reply(const Packet& packet) {
  if (!packet.is(Port::kLog, 1) || packet.size != 3) {
    return std::nullopt;
  }
  return LogReply{packet.data[0], packet.data[1], packet.data[2]};
}

std::optional<LogData> decode_log_data(const Packet& packet) {
  if (!packet.is(Port::kLog, 2) || packet.size < 4) {
    return std::nullopt;
  }
  return LogData{packet.data[0], little_endian(packet.payload().subspan(1, 3)),
                 packet.payload().subspan(4)};
}

std::optional<double> take_value(Bytes& values, ValueType type) {
  const std::size_t bytes = size_bytes(type);
  if (values.size() < bytes) {
    return std::nullopt;
  }
  const std::uint32_t bits = little_endian(values.first(bytes));
  values = values.subspan(bytes);
  switch (type) {
    case ValueType::kI8:
      return static_cast<std::int8_t>(bits);
    case ValueType::kI16:
      return static_cast<std::int16_t>(bits);
    case ValueType::kI32:
      return static_cast<std::int32_t>(bits);
    case ValueType::kF32:
      return static_cast<double>(std::bit_cast<float>(bits));
    case ValueType::kF16:
      return static_cast<double>(from_half(static_cast<std::uint16_t>(bits)));
    case ValueType::kU8:
    case ValueType::kU16:
    case ValueType::kU32:
      break;
  }
  return bits;
}

void append_value(std::vector<std::uint8_t>& out, ValueType type, double value) {
  std::uint32_t bits = 0;
  if (type == ValueType::kF32) {
    bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  } else if (type == ValueType::kF16) {
    bits = to_half(static_cast<float>(value));
  } else if (!std::isnan(value)) {
    const Range range = range_of(type);
    bits = static_cast<std::uint32_t>(
        static_cast<std::int64_t>(std::clamp(value, range.low, range.high)));
  }
  for (std::size_t i = 0; i < size_bytes(type); ++i) {
    out.push_back(static_cast<std::uint8_t>(bits >> (8U * i)));
  }
}

}  // namespace vantage::wire::crtp
