#include "tools/view/log_index.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/check.hpp"

namespace vantage::tools {
namespace {

// An event: sync word, number, time, two lengths, all big-endian; then the channel and the bytes.
constexpr std::uint32_t kSync = 0xEDA1DA01U;
constexpr std::int64_t kHeaderBytes = 28;
constexpr std::int64_t kChannelBytesMax = 1024;
constexpr std::int64_t kMessageBytesMax = std::int64_t{1} << 28U;

std::uint64_t big_endian(const char* at, int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) {
    value = value << 8U | static_cast<unsigned char>(at[i]);
  }
  return value;
}

}  // namespace

struct LogIndex::Header {
  std::int64_t utime = 0;
  std::int64_t channel_bytes = 0;
  std::int64_t message_bytes = 0;
  std::string channel;
  [[nodiscard]] std::int64_t size() const { return kHeaderBytes + channel_bytes + message_bytes; }
};

LogIndex::LogIndex(const std::string& path) : file_(path, std::ios::binary | std::ios::ate) {
  if (!file_) {
    throw StartupError(path + ": cannot be read");
  }
  file_bytes_ = file_.tellg();
  std::vector<std::pair<Entry, std::string>> found;
  std::int64_t offset = 0;
  Header header;
  while (offset < file_bytes_) {
    if (read_header(offset, header)) {
      found.emplace_back(Entry{header.utime, offset}, header.channel);
      offset += header.size();
    } else {
      const std::int64_t next = find_sync(offset + 1);
      bytes_damaged_ += next - offset;
      offset = next;
    }
  }
  if (found.empty()) {
    throw StartupError(path + ": no event of an LCM log in it");
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first.utime < b.first.utime; });
  for (const auto& [entry, channel] : found) {
    by_channel_[channel].push_back(entries_.size());
    entries_.push_back(entry);
  }
}

bool LogIndex::read_header(std::int64_t offset, Header& header) {
  std::array<char, kHeaderBytes> raw{};
  file_.clear();
  file_.seekg(offset);
  if (offset + kHeaderBytes > file_bytes_ || !file_.read(raw.data(), kHeaderBytes) ||
      big_endian(raw.data(), 4) != kSync) {
    return false;
  }
  header.utime = static_cast<std::int64_t>(big_endian(raw.data() + 12, 8));
  header.channel_bytes = static_cast<std::int64_t>(big_endian(raw.data() + 20, 4));
  header.message_bytes = static_cast<std::int64_t>(big_endian(raw.data() + 24, 4));
  if (header.channel_bytes > kChannelBytesMax || header.message_bytes > kMessageBytesMax ||
      offset + header.size() > file_bytes_) {
    return false;
  }
  header.channel.resize(static_cast<std::size_t>(header.channel_bytes));
  return static_cast<bool>(file_.read(header.channel.data(), header.channel_bytes));
}

std::int64_t LogIndex::find_sync(std::int64_t offset) {
  constexpr std::string_view kWord("\xED\xA1\xDA\x01", 4);
  std::string block(1U << 16U, '\0');
  while (offset + 4 <= file_bytes_) {
    file_.clear();
    file_.seekg(offset);
    file_.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto got = static_cast<std::size_t>(file_.gcount());
    const std::size_t at = std::string_view(block).substr(0, got).find(kWord);
    if (at != std::string_view::npos) {
      return offset + static_cast<std::int64_t>(at);
    }
    if (got < block.size()) {
      break;
    }
    offset += static_cast<std::int64_t>(got) - 3;
  }
  return file_bytes_;
}

std::size_t LogIndex::first_at(Time time) const {
  const auto found =
      std::lower_bound(entries_.begin(), entries_.end(), to_utime(time),
                       [](const Entry& entry, std::int64_t utime) { return entry.utime < utime; });
  return static_cast<std::size_t>(found - entries_.begin());
}

std::vector<std::size_t> LogIndex::newest_before(std::size_t index) const {
  std::vector<std::size_t> newest;
  for (const auto& [channel, events] : by_channel_) {
    const auto after = std::lower_bound(events.begin(), events.end(), index);
    if (after != events.begin()) {
      newest.push_back(*(after - 1));
    }
  }
  std::sort(newest.begin(), newest.end());
  return newest;
}

LogEvent LogIndex::read(std::size_t index) {
  Header header;
  LogEvent event;
  if (read_header(entries_[index].offset, header)) {
    event.time = from_utime(header.utime);
    event.channel = header.channel;
    event.bytes.resize(static_cast<std::size_t>(header.message_bytes));
    file_.read(reinterpret_cast<char*>(event.bytes.data()), header.message_bytes);
  }
  return event;
}

}  // namespace vantage::tools
