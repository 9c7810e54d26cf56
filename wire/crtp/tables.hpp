#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "wire/crtp/packet.hpp"

// Parameters (port 2) and log variables (port 5) of a Crazyflie, with their tables of contents.

namespace vantage::wire::crtp {

enum class ValueType : std::uint8_t { kU8, kU16, kU32, kI8, kI16, kI32, kF32, kF16 };
std::size_t size_bytes(ValueType type);

/// Entry of a table of contents.
struct TocItem {
  std::uint16_t id = 0;
  ValueType type = ValueType::kU8;
  bool is_read_only = false;  ///< parameters only
  std::string group;
  std::string name;

  [[nodiscard]] std::string full_name() const { return group + "." + name; }
  friend bool operator==(const TocItem&, const TocItem&) = default;
};
/// Size of a table, and the checksum by which its content is cached.
struct TocInfo {
  std::uint16_t items = 0;
  std::uint32_t crc = 0;
  friend bool operator==(const TocInfo&, const TocInfo&) = default;
};

/// Return requests for the table on `port`, which is kParameter or kLog.
Packet toc_info_request(Port port);
Packet toc_item_request(Port port, std::uint16_t id);
Packet toc_info_reply(Port port, const TocInfo& info);
/// @return nullopt if the names are too long
std::optional<Packet> toc_item_reply(Port port, const TocItem& item);
/// Return the content of a reply; nullopt for another packet, a wrong length or an unknown type.
std::optional<TocInfo> decode_toc_info(Port port, const Packet& packet);
std::optional<TocItem> decode_toc_item(Port port, const Packet& packet);

Packet parameter_read(std::uint16_t id);
/// @return nullopt if the type cannot represent `value`
std::optional<Packet> parameter_write(std::uint16_t id, ValueType type, double value);
struct ParameterReply {
  std::uint16_t id = 0;
  std::optional<double> value;  ///< absent: the parameter is unknown
};
/// Returns the content of a reply to parameter_read() or parameter_write() of a parameter of
/// `type`.
std::optional<ParameterReply> decode_parameter_reply(const Packet& packet, ValueType type);
/// Returns the id in a reply on port kParameter, channel 1 or 2; nullopt for another packet.
std::optional<std::uint16_t> parameter_reply_id(const Packet& packet);

/// Number of bytes of values in one log block.
inline constexpr std::size_t kLogBytesMax = 26;
/// Variable of a log block.
struct LogVariable {
  std::uint16_t id = 0;
  ValueType type = ValueType::kF32;  ///< type of the transmitted value
};
/// @return nullopt if the values need more than kLogBytesMax or the request needs more than
///   kPayloadMax
std::optional<Packet> log_create(std::uint8_t block, std::span<const LogVariable> variables);
Packet log_start(std::uint8_t block, std::uint16_t period_ms);
Packet log_stop(std::uint8_t block);
Packet log_delete(std::uint8_t block);

/// Commands and errors on port kLog, channel 1.
inline constexpr std::uint8_t kLogDelete = 2;
/// period in units of 10 ms, one byte; used by older clients
inline constexpr std::uint8_t kLogStartTens = 3;
inline constexpr std::uint8_t kLogStop = 4;
inline constexpr std::uint8_t kLogReset = 5;
inline constexpr std::uint8_t kLogCreate = 6;
inline constexpr std::uint8_t kLogAppend = 7;
inline constexpr std::uint8_t kLogStart = 8;
inline constexpr std::uint8_t kLogOk = 0;
inline constexpr std::uint8_t kLogNoSuch = 2;
inline constexpr std::uint8_t kLogTooBig = 7;
inline constexpr std::uint8_t kLogUnknownCommand = 8;
inline constexpr std::uint8_t kLogFull = 12;
inline constexpr std::uint8_t kLogExists = 17;
struct LogReply {
  std::uint8_t command = 0;
  std::uint8_t block = 0;
  std::uint8_t error = 0;
};
Packet log_reply(const LogReply& reply);
std::optional<LogReply> decode_log_reply(const Packet& packet);

/// Values of one log block at one instant.
struct LogData {
  std::uint8_t block = 0;
  std::uint32_t since_boot_ms = 0;  ///< ms; 24 bits, wraps after 4.6 h
  Bytes values;
};
/// Returns the data in `packet`, which must outlive the result; nullopt for another packet.
std::optional<LogData> decode_log_data(const Packet& packet);
/// Returns the next value and removes it from `values`; nullopt if too few bytes remain.
std::optional<double> take_value(Bytes& values, ValueType type);
/// Appends `value`; numbers outside the range of the type are clamped; for integer types, fractions
/// are cut off.
void append_value(std::vector<std::uint8_t>& out, ValueType type, double value);
/// Returns the code of a type in tables and requests. The codes of parameters and log variables
/// differ.
std::uint8_t type_code(Port port, ValueType type);
std::optional<ValueType> type_from_code(Port port, std::uint8_t code);

}  // namespace vantage::wire::crtp
