#include "logs/record/log_writer.hpp"

#include <utility>

#include "core/check.hpp"
#include "logs/file/log_event.hpp"

namespace vantage::logs {
namespace {

constexpr std::size_t kKeptBytes = std::size_t{64} << 10U;

}  // namespace

LogWriter::LogWriter(const std::string& path, Existing existing, const OpenFile& open) {
  auto file = open(path, existing);
  if (!file.ok()) {
    throw StartupError(file.error().message);
  }
  file_ = std::move(file).value();
}

LogWriter::~LogWriter() { close(); }

bool LogWriter::write(Time time, std::string_view channel, std::span<const std::uint8_t> bytes) {
  if (error_) {
    ++events_lost_;
    return false;
  }
  append_event({events_, time, channel, bytes}, kept_);
  ++events_;
  if (kept_.size() >= kKeptBytes) {
    flush();
  }
  return !error_;
}

void LogWriter::flush() {
  const std::uint64_t begin = file_->size_bytes();
  std::size_t done = 0;
  while (done < kept_.size() && !error_) {
    const auto taken = file_->append(std::span(kept_).subspan(done));
    if (taken.ok()) {
      done += taken.value();
    } else {
      error_ = taken.error();
    }
  }
  if (error_) {
    const WholeEvents whole = whole_events(kept_, done);
    events_ -= whole.events_beyond;
    events_lost_ += whole.events_beyond;
    if (const auto uncut = file_->cut(begin + whole.bytes)) {
      error_->message += "; " + uncut->message;
    }
  }
  kept_.clear();
}

std::optional<Error> LogWriter::close() {
  if (file_) {
    flush();
    file_.reset();
  }
  return error_;
}

}  // namespace vantage::logs
