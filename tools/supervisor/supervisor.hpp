#pragma once

#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/child.hpp"
#include "models/exchange/messages.hpp"
#include "tools/supervisor/restart_schedule.hpp"

namespace vantage::tools {

/// One process to keep alive.
struct ProcessSpec {
  std::string name;
  std::vector<std::string> arguments;  ///< the executable first
  bool is_essential = false;           ///< without it there is no point in going on
  /// Called before each start but the first.
  std::function<void()> before_restart = {};
  /// Made if need be; the process works there, and what it writes goes into `output.txt`. Empty: it
  /// works and writes where we do.
  std::string folder = {};
  std::map<std::string, std::string> files = {};  ///< written there before each start, by name
  int end_signal = SIGTERM;                       ///< that ends it
};

struct SupervisedStatus {
  std::string name;
  models::SupervisedPhase phase = models::SupervisedPhase::kRunning;
  int restarts = 0;
  double down_s = 0.0;        ///< not running, since its first start
  std::string last_end = {};  ///< how it last ended; empty: it never did
  pid_t pid = 0;              ///< 0 while it is not running
  bool is_essential = false;
};

/// Something that happened to a process, and a sentence about it.
struct SupervisorEvent {
  enum class Kind { kEnded, kStarted, kGivenUp };
  std::string name;
  Kind kind = Kind::kEnded;
  std::string words;
};

/// Starts processes, starts the dead ones again, ends them all. Single thread; told the time (of
/// the monotonic clock), so that back-off can be tested without waiting.
class Supervisor {
 public:
  using Nanoseconds = RestartSchedule::Nanoseconds;
  explicit Supervisor(RestartPolicy policy = {}) : policy_(policy) {}

  /// @throws StartupError when it cannot be executed at all.
  void start(const ProcessSpec& spec, Nanoseconds monotonic_ns);
  /// Reaps the dead and starts again those whose back-off is over; what happened, in that order.
  std::vector<SupervisorEvent> poll(Nanoseconds monotonic_ns);
  /// SIGTERM to all in reverse order of starting, waits for them, SIGKILL to those still alive
  /// after `patience` or once `hurry`, asked all the time, says so; what had to be killed. Nothing
  /// is started again after that.
  std::vector<std::string> stop_all(std::chrono::milliseconds patience,
                                    const std::function<bool()>& hurry = {});

  [[nodiscard]] std::vector<SupervisedStatus> status(Nanoseconds monotonic_ns) const;
  [[nodiscard]] int restarts() const;
  [[nodiscard]] bool any_given_up() const;
  /// The name of an essential process that was given up.
  [[nodiscard]] std::optional<std::string> lost_essential() const;
  /// nullptr while it is not running.
  [[nodiscard]] Child* find(const std::string& name);

 private:
  struct Supervised {
    ProcessSpec spec;
    RestartSchedule schedule;
    std::optional<Child> child;
    models::SupervisedPhase phase = models::SupervisedPhase::kRunning;
    std::string last_end = {};
    Nanoseconds restart_at_ns = 0;
  };
  static SupervisorEvent on_end(Supervised& process, const std::string& how, Nanoseconds now_ns);
  static SupervisorEvent restart(Supervised& process, Nanoseconds now_ns);

  RestartPolicy policy_;
  std::vector<Supervised> processes_;
};

}  // namespace vantage::tools
