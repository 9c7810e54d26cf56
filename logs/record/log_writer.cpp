#include "logs/record/log_writer.hpp"

#include <lcm/lcm-cpp.hpp>

#include "core/check.hpp"

namespace vantage::logs {

struct LogWriter::File {
  explicit File(const std::string& path) : log(path, "w") {}
  lcm::LogFile log;
};

LogWriter::LogWriter(const std::string& path) : file_(std::make_unique<File>(path)) {
  if (!file_->log.good()) {
    throw StartupError(path + ": cannot be written");
  }
}

LogWriter::~LogWriter() = default;

bool LogWriter::write(Time time, std::string_view channel, std::span<const std::uint8_t> bytes) {
  lcm::LogEvent event{};
  event.eventnum = events_;
  event.timestamp = to_utime(time);
  event.channel = channel;
  event.datalen = static_cast<std::int32_t>(bytes.size());
  // LCM's signature is not const-correct; it only reads.
  event.data = const_cast<std::uint8_t*>(bytes.data());  // NOLINT
  const bool written = file_->log.writeEvent(&event) == 0;
  ++(written ? events_ : events_lost_);
  return written;
}

}  // namespace vantage::logs
