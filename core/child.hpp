#pragma once

#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "core/result.hpp"

namespace vantage {

/// Where a process runs and what ends it.
struct ChildPlace {
  int output = -1;           ///< descriptor for what it writes, errors included; negative: as ours
  std::string folder;        ///< its working folder; empty: ours
  int end_signal = SIGTERM;  ///< sent by the kernel should the supervisor die
  std::vector<std::string> environment = {};  ///< "NAME=value"; of names that are not here: as ours
  std::vector<int> keep_open = {};            ///< descriptors that it has under the same numbers
  /// Blocks the signals that ask it to end until it handles them (run_process): they must not kill
  /// it while it starts.
  bool blocks_stop_signals = false;
};

/// How a process ended.
struct ChildExit {
  int code = 0;    ///< exit code, meaningless when a signal ended it
  int signal = 0;  ///< 0: it exited by itself
  [[nodiscard]] bool is_success() const { return signal == 0 && code == 0; }
  /// "exit 1", "signal 9".
  [[nodiscard]] std::string describe() const;
};

/// One process that we started; killed, with what it has started, and reaped when the object goes.
/// It is in a process group of its own, so that a Ctrl-C in the terminal reaches it only through
/// its supervisor, and is sent a signal by the kernel should the supervisor die.
class Child {
 public:
  /// Starts `arguments[0]`, searched in PATH when it has no slash. The Error is that of exec
  /// (no such file), not only of fork; a folder that cannot be entered is one, too.
  static Result<Child> start(const std::vector<std::string>& arguments,
                             const ChildPlace& place = {});

  Child(Child&& other) noexcept;
  Child& operator=(Child&& other) noexcept;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child();

  [[nodiscard]] pid_t pid() const { return pid_; }
  /// How it ended, once it has; waits up to `timeout` for that.
  std::optional<ChildExit> wait(std::chrono::milliseconds timeout);
  /// Sends `signal` unless it has ended.
  void send(int signal);

 private:
  explicit Child(pid_t pid, int pidfd) : pid_(pid), pidfd_(pidfd) {}
  void end();
  pid_t pid_ = -1;
  int pidfd_ = -1;
  std::optional<ChildExit> exit_;
};

/// What a short command said, and how it ended.
struct ChildAnswer {
  ChildExit exit;
  std::string text;  ///< output and errors as they came
};
/// Waits for `arguments` to end. The Error is that of Child::start.
Result<ChildAnswer> ask(const std::vector<std::string>& arguments);

}  // namespace vantage
