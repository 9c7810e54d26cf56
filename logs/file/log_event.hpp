#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/time.hpp"

// Format of an LCM event log: a sequence of events. Each event has a header of 28 bytes
// (big-endian: u32 sync word, i64 event number, i64 time in µs, u32 length of the channel, u32
// length of the data), the channel without a NUL, and the data. It has neither index nor checksum.
// Source: LCM, eventlog.c.

namespace vantage::logs {

inline constexpr std::uint32_t kSyncWord = 0xEDA1DA01U;
inline constexpr std::size_t kSyncBytes = sizeof kSyncWord;
inline constexpr std::size_t kEventHeaderBytes = 28;
inline constexpr std::size_t kChannelBytesMax = 63;  ///< limit of LCM for names that it publishes

/// One event. Channel and data are views into the log's bytes, which must outlive the event.
struct LogEvent {
  std::int64_t number = 0;  ///< number of the event, counted by the logger from 0
  Time time{};              ///< time of reception by the logger
  std::string_view channel;
  std::span<const std::uint8_t> data;

  [[nodiscard]] std::size_t size_bytes() const {
    return kEventHeaderBytes + channel.size() + data.size();
  }
};

/// Returns the event with its header at `offset`, or nullopt if no valid event is there. Valid:
/// sync word, number and time ≥ 0, is_event_channel(), and all bytes inside `log`. The bytes that
/// follow the event are not checked.
std::optional<LogEvent> event_at(std::span<const std::uint8_t> log, std::size_t offset);

/// True if `channel` is a plausible name: 1 to 63 bytes that are UTF-8 or contain no control
/// character. A reader treats events with other names as damage.
bool is_event_channel(std::string_view channel);

/// Returns the offset of the first sync word at or after `offset`; log.size() if there is none.
std::size_t find_sync(std::span<const std::uint8_t> log, std::size_t offset);

/// Appends the event in the format of the file.
void append_event(const LogEvent& event, std::vector<std::uint8_t>& out);

/// Returns the size of the event at `offset`. Precondition: a complete event begins there.
std::size_t event_bytes_at(std::span<const std::uint8_t> events, std::size_t offset);

/// Effect of a partial write on a sequence of complete events.
struct WholeEvents {
  std::size_t bytes = 0;           ///< size of the events that end within the written bytes
  std::int64_t events_beyond = 0;  ///< number of events that end after the written bytes
};
WholeEvents whole_events(std::span<const std::uint8_t> events, std::size_t written);

/// Reads the big-endian number of `width` ≤ 8 bytes at `bytes`.
std::uint64_t read_big_endian(const std::uint8_t* bytes, std::size_t width);
/// Appends the lowest `width` ≤ 8 bytes of `value` in big-endian order.
void append_big_endian(std::uint64_t value, std::size_t width, std::vector<std::uint8_t>& out);

}  // namespace vantage::logs
