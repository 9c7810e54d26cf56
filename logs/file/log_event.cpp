#include "logs/file/log_event.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/utf8.hpp"

namespace vantage::logs {
namespace {

constexpr std::array<std::uint8_t, 4> kSync{0xED, 0xA1, 0xDA, 0x01};

}  // namespace

WholeEvents whole_events(std::span<const std::uint8_t> events, std::size_t written) {
  WholeEvents out;
  for (std::size_t at = 0; at < events.size();) {
    at += event_bytes_at(events, at);
    if (at <= written) {
      out.bytes = at;
    } else {
      ++out.events_beyond;
    }
  }
  return out;
}

std::size_t event_bytes_at(std::span<const std::uint8_t> events, std::size_t offset) {
  const std::uint8_t* header = events.data() + offset;
  return kEventHeaderBytes + read_big_endian(header + 20, 4) + read_big_endian(header + 24, 4);
}

// LCM accepts any bytes as a name. Damaged names are rarely UTF-8 and rarely free of control
// characters, so this test detects most of them.
bool is_event_channel(std::string_view channel) {
  constexpr unsigned char kFirstPrintable = 0x20;
  constexpr unsigned char kDelete = 0x7F;
  const bool has_control = std::any_of(channel.begin(), channel.end(), [](unsigned char character) {
    return character < kFirstPrintable || character == kDelete;
  });
  return !channel.empty() && channel.size() <= kChannelBytesMax &&
         (!has_control || is_utf8(channel));
}

std::uint64_t read_big_endian(const std::uint8_t* bytes, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < width; ++i) {
    value = (value << 8U) | bytes[i];
  }
  return value;
}

void append_big_endian(std::uint64_t value, std::size_t width, std::vector<std::uint8_t>& out) {
  for (std::size_t i = width; i-- > 0;) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

std::optional<LogEvent> event_at(std::span<const std::uint8_t> log, std::size_t offset) {
  if (offset > log.size() || log.size() - offset < kEventHeaderBytes) {
    return std::nullopt;
  }
  const std::uint8_t* header = log.data() + offset;
  if (std::memcmp(header, kSync.data(), kSync.size()) != 0) {
    return std::nullopt;
  }
  LogEvent event;
  event.number = static_cast<std::int64_t>(read_big_endian(header + 4, 8));
  const auto utime = static_cast<std::int64_t>(read_big_endian(header + 12, 8));
  const std::size_t channel_bytes = read_big_endian(header + 20, 4);
  const std::size_t data_bytes = read_big_endian(header + 24, 4);
  const std::size_t left = log.size() - offset - kEventHeaderBytes;
  if (event.number < 0 || utime < 0 || channel_bytes < 1 || channel_bytes > kChannelBytesMax ||
      channel_bytes > left || data_bytes > left - channel_bytes) {
    return std::nullopt;
  }
  event.channel = {reinterpret_cast<const char*>(header + kEventHeaderBytes), channel_bytes};
  if (!is_event_channel(event.channel)) {
    return std::nullopt;
  }
  event.time = from_utime(utime);
  event.data = log.subspan(offset + kEventHeaderBytes + channel_bytes, data_bytes);
  return event;
}

std::size_t find_sync(std::span<const std::uint8_t> log, std::size_t offset) {
  if (offset >= log.size()) {
    return log.size();
  }
  const void* found = memmem(log.data() + offset, log.size() - offset, kSync.data(), kSync.size());
  return found == nullptr
             ? log.size()
             : static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - log.data());
}

void append_event(const LogEvent& event, std::vector<std::uint8_t>& out) {
  out.insert(out.end(), kSync.begin(), kSync.end());
  append_big_endian(static_cast<std::uint64_t>(event.number), 8, out);
  append_big_endian(static_cast<std::uint64_t>(to_utime(event.time)), 8, out);
  append_big_endian(event.channel.size(), 4, out);
  append_big_endian(event.data.size(), 4, out);
  out.insert(out.end(), event.channel.begin(), event.channel.end());
  out.insert(out.end(), event.data.begin(), event.data.end());
}

}  // namespace vantage::logs
