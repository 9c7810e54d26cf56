#include "core/liveness.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/index.hpp"

namespace vantage {
namespace {

constexpr char kUnknownByte = '?';
constexpr char kGroundByte = 'g';
constexpr char kFlightByte = 'f';

char byte_of(InFlight in_flight) {
  switch (in_flight) {
    case InFlight::kUnknown:
      return kUnknownByte;
    case InFlight::kNo:
      return kGroundByte;
    case InFlight::kYes:
      return kFlightByte;
  }
  return kUnknownByte;
}

// Returns the descriptor number in the environment variable if it is the write end of a pipe,
// otherwise −1.
int inherited_descriptor() {
  const char* const given = std::getenv(LivenessSender::kDescriptorVariable);
  if (given == nullptr) {
    return -1;
  }
  int descriptor = -1;
  const char* const end = given + std::strlen(given);
  const auto parsed = std::from_chars(given, end, descriptor);
  ::unsetenv(LivenessSender::kDescriptorVariable);  // children must not inherit the descriptor
  struct stat what {};
  const bool is_pipe = parsed.ec == std::errc() && parsed.ptr == end &&
                       descriptor > STDERR_FILENO && ::fstat(descriptor, &what) == 0 &&
                       S_ISFIFO(what.st_mode);
  if (!is_pipe) {
    return -1;
  }
  ::fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  ::fcntl(descriptor, F_SETFL, O_NONBLOCK);
  return descriptor;
}

void close_if_open(int& descriptor) {
  if (descriptor >= 0) {
    ::close(descriptor);
  }
  descriptor = -1;
}

}  // namespace

LivenessSender::LivenessSender() : descriptor_(inherited_descriptor()) {}

LivenessSender::~LivenessSender() { close_if_open(descriptor_); }

void LivenessSender::on_loop(Time now, InFlight in_flight) {
  const bool is_due = !last_ || now - *last_ >= kPeriod || in_flight != sent_;
  if (descriptor_ < 0 || !is_due) {
    return;
  }
  last_ = now;
  sent_ = in_flight;
  const char byte = byte_of(in_flight);
  if (::write(descriptor_, &byte, 1) < 0 && errno == EPIPE) {
    close_if_open(descriptor_);  // the supervisor has ended
  }
}

LivenessReceiver::~LivenessReceiver() { close_all(); }

LivenessReceiver::LivenessReceiver(LivenessReceiver&& other) noexcept
    : read_(std::exchange(other.read_, -1)), write_(std::exchange(other.write_, -1)) {}

LivenessReceiver& LivenessReceiver::operator=(LivenessReceiver&& other) noexcept {
  if (this != &other) {
    close_all();
    read_ = std::exchange(other.read_, -1);
    write_ = std::exchange(other.write_, -1);
  }
  return *this;
}

void LivenessReceiver::close_all() {
  close_if_open(read_);
  close_if_open(write_);
}

bool LivenessReceiver::open() {
  close_all();
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) {
    return false;
  }
  read_ = ends[0];
  write_ = ends[1];
  return true;
}

void LivenessReceiver::close_child_end() { close_if_open(write_); }

LivenessReceiver::Report LivenessReceiver::take() {
  Report out;
  std::array<char, 256> bytes{};
  ssize_t count = 0;
  while (read_ >= 0 && (count = ::read(read_, bytes.data(), bytes.size())) > 0) {
    out.any = true;
    for (ssize_t i = 0; i < count; ++i) {
      const char byte = bytes[index(i)];
      out.in_flight = byte == kFlightByte   ? InFlight::kYes
                      : byte == kGroundByte ? InFlight::kNo
                                            : out.in_flight;
    }
  }
  return out;
}

}  // namespace vantage
