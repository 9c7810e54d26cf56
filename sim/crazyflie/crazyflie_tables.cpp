#include "sim/crazyflie/crazyflie_tables.hpp"

#include <algorithm>
#include <utility>

#include "core/check.hpp"

namespace vantage::sim {
namespace {

namespace crtp = wire::crtp;
using crtp::Packet;
using crtp::Port;

constexpr std::uint8_t kUnknownParameter = 2;
constexpr std::size_t kBlocksMax = 16;

/// Returns a checksum of a table. Clients use it only as the key of a cache, so it need not equal
/// that of the firmware.
std::uint32_t checksum(const std::vector<CrazyflieVariable>& table) {
  std::uint32_t out = 2166136261U;
  const auto add = [&out](unsigned byte) { out = (out ^ byte) * 16777619U; };
  for (const CrazyflieVariable& each : table) {
    for (const char c : std::string(each.group) + "." + each.name) {
      add(static_cast<std::uint8_t>(c));
    }
    add(static_cast<unsigned>(each.type));
  }
  return out;
}

std::uint16_t id_of(const Packet& packet, std::size_t at) {
  return static_cast<std::uint16_t>(packet.data[at] | packet.data[at + 1] << 8U);
}

}  // namespace

std::optional<Packet> CrazyflieTables::receive(const Packet& packet, Time now) {
  if (packet.channel == 0) {
    return table_reply(packet);
  }
  if (packet.port == Port::kParameter) {
    return parameter_reply(packet);
  }
  if (packet.channel != 1 || packet.size == 0) {
    return std::nullopt;
  }
  const std::uint8_t block = packet.size > 1 ? packet.data[1] : std::uint8_t{0};
  return crtp::log_reply({packet.data[0], block, control_log(packet, now)});
}

std::optional<Packet> CrazyflieTables::table_reply(const Packet& packet) const {
  const auto& table = packet.port == Port::kLog ? logs_ : parameters_;
  if (packet == crtp::toc_info_request(packet.port)) {
    return crtp::toc_info_reply(packet.port,
                                {static_cast<std::uint16_t>(table.size()), checksum(table)});
  }
  if (packet.size != 3 || packet.data[0] != 2) {
    return std::nullopt;
  }
  const std::uint16_t id = id_of(packet, 1);
  if (id >= table.size()) {
    Packet out = packet;
    out.size = 1;
    return out;
  }
  return crtp::toc_item_reply(
      packet.port, {id, table[id].type, table[id].is_read_only, table[id].group, table[id].name});
}

std::optional<Packet> CrazyflieTables::parameter_reply(const Packet& packet) {
  if (packet.size < 2 || packet.channel > 2) {
    return std::nullopt;
  }
  const std::uint16_t id = id_of(packet, 0);
  Packet out = packet;
  out.size = 2;
  const auto append = [&out](std::uint8_t byte) { out.data[out.size++] = byte; };
  if (id >= parameters_.size()) {
    append(kUnknownParameter);
    return out;
  }
  CrazyflieVariable& parameter = parameters_[id];
  if (packet.channel == 1) {
    std::vector<std::uint8_t> bytes{0};
    crtp::append_value(bytes, parameter.type, parameter.value);
    std::ranges::for_each(bytes, append);
    return out;
  }
  crtp::Bytes rest = packet.payload().subspan(2);
  const auto value = crtp::take_value(rest, parameter.type);
  if (parameter.is_read_only || !value) {
    return std::nullopt;
  }
  parameter.value = *value;
  return packet;
}

std::uint8_t CrazyflieTables::control_log(const Packet& packet, Time now) {
  const std::uint8_t command = packet.data[0];
  if (command == crtp::kLogReset) {
    blocks_.clear();
    return crtp::kLogOk;
  }
  if (packet.size < 2) {
    return crtp::kLogUnknownCommand;
  }
  const auto found = blocks_.find(packet.data[1]);
  if (command == crtp::kLogCreate) {
    return found == blocks_.end() ? create_block(packet) : crtp::kLogExists;
  }
  if (found == blocks_.end()) {
    return crtp::kLogNoSuch;
  }
  switch (command) {
    case crtp::kLogDelete:
      blocks_.erase(found);
      return crtp::kLogOk;
    case crtp::kLogStop:
      found->second.period = {};
      return crtp::kLogOk;
    case crtp::kLogAppend:
      return append_variables(packet, found->second);
    case crtp::kLogStart:
    case crtp::kLogStartTens:
      if (packet.size != (command == crtp::kLogStart ? 4 : 3)) {
        return crtp::kLogUnknownCommand;
      }
      found->second.period =
          Duration{command == crtp::kLogStart ? 1000 * id_of(packet, 2) : 10'000 * packet.data[2]};
      found->second.next = now + found->second.period;
      return crtp::kLogOk;
    default:
      return crtp::kLogUnknownCommand;
  }
}

std::uint8_t CrazyflieTables::create_block(const Packet& packet) {
  if (blocks_.size() >= kBlocksMax) {
    return crtp::kLogFull;
  }
  Block block;
  const std::uint8_t error = append_variables(packet, block);
  if (error == crtp::kLogOk) {
    blocks_[packet.data[1]] = block;
  }
  return error;
}

std::uint8_t CrazyflieTables::append_variables(const Packet& packet, Block& block) const {
  std::vector<crtp::LogVariable> all = block.variables;
  for (std::size_t at = 2; at + 3 <= packet.size; at += 3) {
    const auto type = crtp::type_from_code(Port::kLog, packet.data[at] & 0x0FU);
    const std::uint16_t id = id_of(packet, at + 1);
    if (!type || id >= logs_.size()) {
      return crtp::kLogNoSuch;
    }
    all.push_back({id, *type});
  }
  std::size_t bytes = 0;
  for (const crtp::LogVariable& variable : all) {
    bytes += crtp::size_bytes(variable.type);
  }
  if (bytes > crtp::kLogBytesMax) {
    return crtp::kLogTooBig;
  }
  block.variables = std::move(all);
  return crtp::kLogOk;
}

void CrazyflieTables::append_due(Time now, Time boot, std::vector<Packet>& out) {
  for (auto& [number, block] : blocks_) {
    if (block.period == Duration{} || now < block.next) {
      continue;
    }
    block.next += block.period;
    const auto since_ms = static_cast<std::uint32_t>((now - boot).count() / 1000);
    std::vector<std::uint8_t> bytes{number, static_cast<std::uint8_t>(since_ms),
                                    static_cast<std::uint8_t>(since_ms >> 8U),
                                    static_cast<std::uint8_t>(since_ms >> 16U)};
    for (const crtp::LogVariable& variable : block.variables) {
      crtp::append_value(bytes, variable.type, logs_[variable.id].measure());
    }
    Packet packet;
    packet.port = Port::kLog;
    packet.channel = 2;
    packet.size = static_cast<std::uint8_t>(bytes.size());
    std::ranges::copy(bytes, packet.data.begin());
    out.push_back(packet);
  }
}

double CrazyflieTables::parameter(const std::string& full_name) const {
  const auto found = std::ranges::find_if(parameters_, [&](const CrazyflieVariable& each) {
    return std::string(each.group) + "." + each.name == full_name;
  });
  require(found != parameters_.end(), "emulated Crazyflie: no parameter " + full_name);
  return found->value;
}

void CrazyflieTables::set_parameter(const std::string& full_name, double value) {
  for (CrazyflieVariable& each : parameters_) {
    if (std::string(each.group) + "." + each.name == full_name) {
      each.value = value;
    }
  }
}

}  // namespace vantage::sim
