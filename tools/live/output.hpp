#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace vantage::tools {

/// Text for a descriptor that may not accept it at once. It never waits: the text is kept up to
/// kBytesMax, and a text that does not fit is dropped whole and counted.
class OutputQueue {
 public:
  static constexpr std::size_t kBytesMax = 65'536;
  /// `descriptor` is non-blocking and stays open.
  explicit OutputQueue(int descriptor) : descriptor_(descriptor) {}

  void write(std::string_view text);
  /// Writes what the descriptor accepts now; true when nothing is left.
  bool flush();
  /// Counts a text that its owner did not hand over because an earlier one is still waiting.
  void count_dropped() { ++dropped_; }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  int descriptor_;
  std::string pending_;
  std::int64_t dropped_ = 0;
};

/// While it lives, no write to standard output or standard error waits, neither of this process nor
/// of the processes that it starts: a terminal that is stopped (Ctrl-S) or that nothing reads
/// delays no heartbeat, order or driver. print_line() and Screen then write through OutputQueues.
/// Terminals and pipes are opened anew for that, so that the shell keeps its own settings; files
/// stay as they are. At the end it states how many texts were dropped. At most one; made and ended
/// by the main thread, which alone prints.
class NonBlockingOutput {
 public:
  NonBlockingOutput();
  ~NonBlockingOutput();
  NonBlockingOutput(const NonBlockingOutput&) = delete;
  NonBlockingOutput& operator=(const NonBlockingOutput&) = delete;
  NonBlockingOutput(NonBlockingOutput&&) = delete;
  NonBlockingOutput& operator=(NonBlockingOutput&&) = delete;

  /// The queue of `stream`; nullptr where writes may wait: none lives, or another stream.
  static OutputQueue* queue_of(std::FILE* stream);

 private:
  struct Stream {
    int descriptor;
    int saved = -1;        ///< what was open before; -1: the same still is
    int saved_flags = -1;  ///< of what was made non-blocking in its place; -1: none
    OutputQueue queue{descriptor};
  };
  static void open(Stream& stream);
  static void close(Stream& stream);

  Stream out_{1};
  Stream error_{2};
};

}  // namespace vantage::tools
