#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <termios.h>

namespace vantage::tools {

/// How many bytes of `typed` its first key is; 0 when more are to come. Arrows and function keys
/// are one key each, of several bytes that would mean something alone (ESC [ … X, ESC O X, and
/// Linux's ESC [ [ X); whatever cannot belong to such a key begins another, so SPACE always is one.
std::size_t key_bytes(std::string_view typed);

/// Standard input as an operator uses it: key by key from a terminal, line by line otherwise. At a
/// terminal flow control and the keys that suspend or quit a process are off; its settings are
/// restored at the end.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  Terminal(Terminal&&) = delete;
  Terminal& operator=(Terminal&&) = delete;

  [[nodiscard]] bool is_interactive() const { return saved_.has_value(); }
  /// A key, as key_bytes() has it, or a line without its end; nullopt when there is none yet. Never
  /// waits.
  std::optional<std::string> read();
  /// True once there will be no more input.
  [[nodiscard]] bool is_closed() const { return is_closed_ && pending_.empty(); }

 private:
  void fill();
  std::optional<termios> saved_;
  std::string pending_;
  bool is_closed_ = false;
};

}  // namespace vantage::tools
