#pragma once

#include <array>
#include <csignal>
#include <functional>
#include <string>

namespace vantage {

/// The signals that ask a process to end.
inline constexpr std::array kStopSignals{SIGINT, SIGTERM, SIGHUP};

/// Runs `body` and turns its outcome into an exit code: what it returned, 1 when it failed while
/// running, 2 when it could not start (StartupError, UsageError), with one sentence on stderr.
/// SIGINT, SIGTERM and SIGHUP (unless it came in ignored, as under nohup) make stop_requested()
/// true; `body` is expected to notice and return. Those that were blocked until then are let in.
int run_process(const std::string& name, const std::function<int()>& body);

/// True once the process has been asked to end. Safe to call from any thread.
bool stop_requested();
/// How often it has been asked: a second Ctrl-C may mean "now". Safe to call from any thread.
int stop_requests();
/// Asks the process to end, as SIGTERM would.
void request_stop();

/// While it lives, SIGINT, SIGTERM and SIGHUP end the process where it stands, as they end one that
/// does not handle them; so does one that came before. For work that leaves nothing behind:
/// reading, preparing, looking up a name. Not nested; made and ended by the main thread.
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
