#pragma once

#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/child.hpp"
#include "core/liveness.hpp"
#include "models/exchange/messages.hpp"
#include "tools/supervisor/restart_schedule.hpp"
#include "tools/supervisor/watchdog.hpp"

namespace vantage::tools {

/// Description of a process to keep alive.
struct ProcessSpec {
  std::string name;
  std::vector<std::string> arguments;  ///< command line, begins with the executable
  bool is_essential = false;           ///< the trial ends if this process is given up
  /// Called before each restart.
  std::function<void()> before_restart = {};
  /// Working folder, created if missing; the output of the process is appended to its `output.txt`.
  /// Empty: working folder and output of the supervisor.
  std::string folder = {};
  std::map<std::string, std::string> files = {};  ///< content by file name, written to `folder`
  int end_signal = SIGTERM;                       ///< signal that ends the process
  /// s; longest time without a sign of life (core/liveness) before the process is killed and
  /// restarted. 0: a foreign program, which gives no signs of life and is not watched.
  double patience_s = 0.0;
  std::string vehicle = {};         ///< vehicle that the process drives; empty: none
  std::vector<int> keep_open = {};  ///< descriptors that the process inherits
};

struct SupervisedStatus {
  std::string name;
  models::SupervisedPhase phase = models::SupervisedPhase::kRunning;
  int restarts = 0;
  double down_s = 0.0;        ///< s; time since the first start in which it did not run
  std::string last_end = {};  ///< last end, such as "exit 1"; empty: it never ended
  pid_t pid = 0;              ///< 0 while the process is not running
  bool is_essential = false;
  std::string vehicle = {};                 ///< vehicle that the process drives; empty: none
  InFlight in_flight = InFlight::kUnknown;  ///< state of the vehicle in the last sign of life
};

/// Event of a process, with a sentence that describes it.
struct SupervisorEvent {
  enum class Kind { kEnded, kStarted, kGivenUp, kHung };
  std::string name;
  Kind kind = Kind::kEnded;
  std::string text;
};

/// Supervisor of child processes. It starts the processes, kills processes without signs of life,
/// restarts processes that end, and stops all processes at the end. Each process sends its signs of
/// life by its own pipe, independent of the network. The driver of a vehicle that may be in flight
/// is restarted without limit. Single-threaded. The caller passes the monotonic clock's time, so
/// that tests of the back-off do not wait.
class Supervisor {
 public:
  using Nanoseconds = RestartSchedule::Nanoseconds;
  explicit Supervisor(RestartPolicy policy = {}) : policy_(policy) {}

  /// Starts a process. @throws StartupError if it cannot be executed.
  void start(const ProcessSpec& spec, Nanoseconds monotonic_ns);
  /// Reads signs of life, kills processes without them, reaps processes that have ended and
  /// restarts processes when their back-off is over. Returns the events in this order.
  std::vector<SupervisorEvent> poll(Nanoseconds monotonic_ns);
  /// Asks the vehicle drivers to shut down. Further calls repeat the request. A driver that ends
  /// after a request is restarted only if it failed, only one request was made, and its vehicle may
  /// be in flight. A restarted driver receives the requests as soon as it has started.
  void end_drivers();
  [[nodiscard]] bool have_drivers_ended() const;
  /// Sends `signal` to all running processes that give signs of life, i.e. not to firmware.
  void send_to_ours(int signal);
  /// Sends each process its end signal in reverse order of starting and waits for all of them.
  /// Kills the remaining processes after `patience`, or as soon as `hurry` (polled) returns true.
  /// Returns the names of the killed processes. No process is restarted afterwards.
  std::vector<std::string> stop_all(std::chrono::milliseconds patience,
                                    const std::function<bool()>& hurry = {});

  [[nodiscard]] std::vector<SupervisedStatus> status(Nanoseconds monotonic_ns) const;
  [[nodiscard]] int restarts() const;
  /// Returns the name of an essential process that was given up; nullopt if there is none.
  [[nodiscard]] std::optional<std::string> lost_essential() const;
  /// Returns the process of that name; nullptr while it is not running.
  [[nodiscard]] Child* find(const std::string& name);

 private:
  struct Supervised {
    ProcessSpec spec;
    RestartSchedule schedule;
    std::optional<Child> child;
    models::SupervisedPhase phase = models::SupervisedPhase::kRunning;
    std::string last_end = {};
    Nanoseconds restart_at_ns = 0;
    LivenessReceiver liveness = {};
    InFlight in_flight = InFlight::kUnknown;  ///< last known state of its vehicle
  };
  void take_signs(Supervised& process, Nanoseconds now_ns);
  void kill_hung(Nanoseconds now_ns, std::vector<SupervisorEvent>& events);
  SupervisorEvent on_end(Supervised& process, const ChildExit& how, Nanoseconds now_ns);
  SupervisorEvent start_again_later(Supervised& process, const std::string& how,
                                    Nanoseconds now_ns);
  SupervisorEvent restart(Supervised& process, Nanoseconds now_ns);
  void request_end(Supervised& process) const;

  RestartPolicy policy_;
  Watchdog watchdog_;
  int end_requests_ = 0;  ///< number of calls of end_drivers()
  std::vector<Supervised> processes_;
};

}  // namespace vantage::tools
