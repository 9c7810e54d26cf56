#pragma once

#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "core/result.hpp"

namespace vantage {

/// Settings for the start of a child process.
struct ChildOptions {
  int output = -1;           ///< descriptor for stdout and stderr; negative: inherited
  std::string folder;        ///< working folder; empty: inherited
  int end_signal = SIGTERM;  ///< signal that the kernel sends to the child if the supervisor dies
  std::vector<std::string> environment = {};  ///< "NAME=value"; added to this process's environment
  std::vector<int> keep_open = {};  ///< descriptors that the child inherits with the same numbers
  /// True: stop signals are blocked until the process handles them (run_process). They then cannot
  /// kill the process during its start.
  bool blocks_stop_signals = false;
};

/// Exit status of a process.
struct ChildExit {
  int code = 0;    ///< meaningless if a signal ended the process
  int signal = 0;  ///< signal that ended the process; 0: none
  [[nodiscard]] bool is_success() const { return signal == 0 && code == 0; }
  /// Returns text such as "exit 1" or "signal 9".
  [[nodiscard]] std::string describe() const;
};

/// Child process. The destructor kills it and its process group, and reaps it. The child has its
/// own process group, so that a Ctrl-C in the terminal reaches it only through its supervisor. The
/// kernel sends the child a signal if the supervisor dies.
class Child {
 public:
  /// Starts `arguments[0]`, which is searched in PATH if it has no slash. Returns an Error if fork
  /// or exec (no such file) fails, or if the folder cannot be entered.
  static Result<Child> start(const std::vector<std::string>& arguments,
                             const ChildOptions& options = {});

  Child(Child&& other) noexcept;
  Child& operator=(Child&& other) noexcept;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child();

  [[nodiscard]] pid_t pid() const { return pid_; }
  /// Waits up to `timeout` for the end of the child. Returns the exit status, nullopt if the child
  /// still runs.
  std::optional<ChildExit> wait(std::chrono::milliseconds timeout);
  /// Sends `signal` if the child has not ended.
  void send(int signal);

 private:
  explicit Child(pid_t pid, int pidfd) : pid_(pid), pidfd_(pidfd) {}
  void end();
  pid_t pid_ = -1;
  int pidfd_ = -1;
  std::optional<ChildExit> exit_;
};

/// Output and exit status of a short command.
struct CommandOutput {
  ChildExit exit;
  std::string text;  ///< stdout and stderr in order of arrival
};
/// Runs the command `arguments` and waits until it ends. Error as for Child::start().
Result<CommandOutput> run_command(const std::vector<std::string>& arguments);

}  // namespace vantage
