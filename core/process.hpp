#pragma once

#include <array>
#include <csignal>
#include <functional>
#include <string>

namespace vantage {

/// Signals that request a process to end.
inline constexpr std::array kStopSignals{SIGINT, SIGTERM, SIGHUP};

/// Runs `body` and returns an exit code: the result of `body`, 1 if `body` failed while running, or
/// 2 if it could not start (StartupError, UsageError). An error is printed on stderr in one
/// sentence. After SIGINT, SIGTERM or SIGHUP, stop_requested() is true and `body` must return. If
/// SIGHUP was ignored at start, as under nohup, it stays ignored. Stop signals that were blocked
/// are unblocked.
int run_process(const std::string& name, const std::function<int()>& body);

/// True once a stop of the process was requested. Safe to call from any thread.
bool stop_requested();
/// Returns the number of stop requests. A caller may treat a second Ctrl-C as an urgent stop. Safe
/// to call from any thread.
int stop_requests();

/// Scope in which SIGINT, SIGTERM and SIGHUP end the process immediately, as without a handler. A
/// signal received before the scope has the same effect. Use this scope for work that can be
/// interrupted without clean-up: reading, preparation, name resolution. Scopes must not be nested
/// and must be created and destroyed in the main thread.
class DefaultSignalScope {
 public:
  DefaultSignalScope();
  ~DefaultSignalScope();
  DefaultSignalScope(const DefaultSignalScope&) = delete;
  DefaultSignalScope& operator=(const DefaultSignalScope&) = delete;
  DefaultSignalScope(DefaultSignalScope&&) = delete;
  DefaultSignalScope& operator=(DefaultSignalScope&&) = delete;
};

}  // namespace vantage
