#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace vantage::tools {

/// Queue of text for a descriptor that may not accept text immediately. It never blocks. It stores
/// up to kBytesMax; a text that does not fit is dropped completely and counted.
class OutputQueue {
 public:
  static constexpr std::size_t kBytesMax = 65'536;
  /// `descriptor` is non-blocking and stays open.
  explicit OutputQueue(int descriptor) : descriptor_(descriptor) {}

  void write(std::string_view text);
  /// Writes as much as the descriptor accepts now. Returns true if the queue is then empty.
  bool flush();
  /// Counts a text that the caller dropped because an earlier one is still waiting.
  void count_dropped() { ++dropped_; }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  int descriptor_;
  std::string pending_;
  std::int64_t dropped_ = 0;
};

/// Guard that makes standard output and standard error non-blocking during its lifetime, for this
/// process and its children. So a stopped terminal (Ctrl-S) or a missing reader does not delay
/// heartbeats, orders or drivers. print_line() and Screen then write through OutputQueues.
/// Terminals and pipes are opened a second time, so that the shell keeps its settings; output to
/// files is not changed. The destructor prints the number of dropped texts. At most one object may
/// exist. Only the main thread may create it, destroy it and print.
class NonBlockingOutput {
 public:
  NonBlockingOutput();
  ~NonBlockingOutput();
  NonBlockingOutput(const NonBlockingOutput&) = delete;
  NonBlockingOutput& operator=(const NonBlockingOutput&) = delete;
  NonBlockingOutput(NonBlockingOutput&&) = delete;
  NonBlockingOutput& operator=(NonBlockingOutput&&) = delete;

  /// Returns the queue of `stream`; nullptr if writes to `stream` may block, i.e. for other streams
  /// or if no NonBlockingOutput exists.
  static OutputQueue* queue_of(std::FILE* stream);

 private:
  struct Stream {
    int descriptor;
    int saved = -1;        ///< copy of the original descriptor; -1: not replaced
    int saved_flags = -1;  ///< original flags if changed in place; -1: not changed
    OutputQueue queue{descriptor};
  };
  static void open(Stream& stream);
  static void close(Stream& stream);

  Stream out_{1};
  Stream error_{2};
};

}  // namespace vantage::tools
