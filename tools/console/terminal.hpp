#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <termios.h>

namespace vantage::tools {

/// Returns the number of bytes of the first key in `typed`; 0 if more bytes are needed. An arrow or
/// function key is a sequence of several bytes (ESC [ … X, ESC O X, and Linux's ESC [ [ X). A byte
/// that cannot belong to such a sequence begins another key, so SPACE is always a key.
std::size_t key_bytes(std::string_view typed);

/// Standard input of an operator: key by key from a terminal, line by line otherwise. At a terminal
/// flow control and the keys that suspend or quit a process are disabled. The destructor restores
/// the settings.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  Terminal(Terminal&&) = delete;
  Terminal& operator=(Terminal&&) = delete;

  [[nodiscard]] bool is_interactive() const { return saved_.has_value(); }
  /// Returns a key (see key_bytes()), or a line without its end; nullopt if there is none yet.
  /// Never waits.
  std::optional<std::string> read();
  /// True once the input has ended and all of it has been read.
  [[nodiscard]] bool is_closed() const { return is_closed_ && pending_.empty(); }

 private:
  void fill();
  std::optional<termios> saved_;
  std::string pending_;
  bool is_closed_ = false;
};

}  // namespace vantage::tools
