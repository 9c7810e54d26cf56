#pragma once

#include <array>
#include <csignal>
#include <functional>
#include <string>

namespace vantage {

/// Signals that request a process to end.
inline constexpr std::array kStopSignals{SIGINT, SIGTERM, SIGHUP};

/// Runs `body` and returns an exit code: that of `body`; 1 if it failed while running; 2 if it
/// could not start (StartupError, UsageError). Errors print one sentence on stderr. SIGINT, SIGTERM
/// and SIGHUP make stop_requested() true, and `body` is expected to return then. A SIGHUP that was
/// ignored at start, as under nohup, stays ignored. Stop signals that were blocked are unblocked.
int run_process(const std::string& name, const std::function<int()>& body);

/// True once a stop of the process was requested. Safe to call from any thread.
bool stop_requested();
/// Returns the number of stop requests: a second Ctrl-C may mean "now". Safe to call from any
/// thread.
int stop_requests();
/// Requests a stop of the process, as SIGTERM does.
void request_stop();

/// Scope in which SIGINT, SIGTERM and SIGHUP end the process immediately, as without a handler. A
/// signal received before the scope has the same effect. For work that leaves nothing behind:
/// reading, preparing, name resolution. Not nested; create and destroy it in the main thread.
class EndsAtOnce {
 public:
  EndsAtOnce();
  ~EndsAtOnce();
  EndsAtOnce(const EndsAtOnce&) = delete;
  EndsAtOnce& operator=(const EndsAtOnce&) = delete;
  EndsAtOnce(EndsAtOnce&&) = delete;
  EndsAtOnce& operator=(EndsAtOnce&&) = delete;
};

}  // namespace vantage
