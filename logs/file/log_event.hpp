#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/time.hpp"

// The bytes of an LCM event log: events one after the other, each a header of 28 bytes
// (big-endian: u32 sync word, i64 event number, i64 time in µs, u32 length of the channel, u32
// length of the data), the channel without a NUL, the data. No index, no checksum, no end mark.
// Source: LCM, eventlog.c.

namespace vantage::logs {

inline constexpr std::uint32_t kSyncWord = 0xEDA1DA01U;
inline constexpr std::size_t kSyncBytes = sizeof kSyncWord;
inline constexpr std::size_t kEventHeaderBytes = 28;
inline constexpr std::size_t kChannelBytesMax = 63;  ///< LCM publishes no longer name

/// One event. Channel and data belong to whoever holds the log's bytes.
struct LogEvent {
  std::int64_t number = 0;  ///< counted by the logger from 0
  Time time{};              ///< when the logger received it
  std::string_view channel;
  std::span<const std::uint8_t> data;

  [[nodiscard]] std::size_t size_bytes() const {
    return kEventHeaderBytes + channel.size() + data.size();
  }
};

/// The event whose header begins at `offset`, or nullopt when there is none that could be true:
/// sync word, number and time not negative, a name of 1 to 63 bytes that is UTF-8 or without
/// control characters, and all of it inside `log`. Says nothing about what comes after it.
std::optional<LogEvent> event_at(std::span<const std::uint8_t> log, std::size_t offset);

/// Whether events on `channel` can be told from damage when they are read: 1 to 63 bytes that are
/// UTF-8 or have no control character among them.
bool is_event_channel(std::string_view channel);

/// First place at or after `offset` where the sync word stands; log.size() when there is none.
std::size_t find_sync(std::span<const std::uint8_t> log, std::size_t offset);

/// Appends the event as it stands in a file.
void append_event(const LogEvent& event, std::vector<std::uint8_t>& out);

/// The size of the event at `offset`. Precondition: a whole one begins there.
std::size_t event_bytes_at(std::span<const std::uint8_t> events, std::size_t offset);

/// How much of `events`, whole ones one after the other, `written` bytes are.
struct WholeEvents {
  std::size_t bytes = 0;           ///< of those that end within `written`
  std::int64_t events_beyond = 0;  ///< the others
};
WholeEvents whole_events(std::span<const std::uint8_t> events, std::size_t written);

/// The big-endian number of `width` ≤ 8 bytes at `bytes`.
std::uint64_t read_big_endian(const std::uint8_t* bytes, std::size_t width);
/// Appends it.
void append_big_endian(std::uint64_t value, std::size_t width, std::vector<std::uint8_t>& out);

}  // namespace vantage::logs
