#include "tools/live/output.hpp"

#include <cerrno>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/deadline.hpp"

namespace vantage::tools {
namespace {

NonBlockingOutput* current = nullptr;
constexpr int kPollPatience_ms = 200;
constexpr std::int64_t kLastPatience_ns = 1'000'000'000;

}  // namespace

void OutputQueue::write(std::string_view text) {
  flush();
  if (pending_.size() + text.size() > kBytesMax && !pending_.empty()) {
    ++dropped_;
    return;
  }
  pending_ += text;
  flush();
}

bool OutputQueue::flush() {
  while (!pending_.empty()) {
    const ssize_t written = ::write(descriptor_, pending_.data(), pending_.size());
    if (written > 0) {
      pending_.erase(0, static_cast<std::size_t>(written));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return false;
    } else if (errno != EINTR) {
      pending_.clear();  // the reader has closed its end
      ++dropped_;
    }
  }
  return true;
}

NonBlockingOutput::NonBlockingOutput() {
  std::fflush(stdout);
  std::fflush(stderr);
  open(out_);
  open(error_);
  current = this;
}

NonBlockingOutput::~NonBlockingOutput() {
  current = nullptr;
  close(out_);
  close(error_);
  if (const std::int64_t dropped = out_.queue.dropped() + error_.queue.dropped(); dropped > 0) {
    fmt::print(stderr,
               "vantage: {} lines or screens were not printed: the terminal or pipe was blocked\n",
               dropped);
  }
}

OutputQueue* NonBlockingOutput::queue_of(std::FILE* stream) {
  if (current == nullptr) {
    return nullptr;
  }
  return stream == stdout   ? &current->out_.queue
         : stream == stderr ? &current->error_.queue
                            : nullptr;
}

void NonBlockingOutput::open(Stream& stream) {
  struct stat status {};
  if (::fstat(stream.descriptor, &status) != 0 || S_ISREG(status.st_mode)) {
    return;
  }
  // Opens a new file description, because O_NONBLOCK on the old one would also affect the shell.
  const std::string path = fmt::format("/proc/self/fd/{}", stream.descriptor);
  const int own = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (own >= 0) {
    stream.saved = ::fcntl(stream.descriptor, F_DUPFD_CLOEXEC, 3);
    ::dup2(own, stream.descriptor);
    ::close(own);
    return;
  }
  // A socket, or a terminal of another user, cannot be opened again.
  stream.saved_flags = ::fcntl(stream.descriptor, F_GETFL);
  if (stream.saved_flags >= 0) {
    ::fcntl(stream.descriptor, F_SETFL, stream.saved_flags | O_NONBLOCK);
  }
}

// If the reader never reads, the descriptor stays non-blocking, so that the process can end.
void NonBlockingOutput::close(Stream& stream) {
  pollfd ready{stream.descriptor, POLLOUT, 0};
  const std::int64_t give_up_ns = monotonic_ns() + kLastPatience_ns;
  while (!stream.queue.flush() && ::poll(&ready, 1, kPollPatience_ms) > 0 &&
         monotonic_ns() < give_up_ns) {
  }
  const bool is_read = stream.queue.flush();
  if (stream.saved >= 0) {
    if (is_read) {
      ::dup2(stream.saved, stream.descriptor);
    }
    ::close(stream.saved);
  } else if (stream.saved_flags >= 0) {
    ::fcntl(stream.descriptor, F_SETFL, stream.saved_flags);
  }
}

}  // namespace vantage::tools
