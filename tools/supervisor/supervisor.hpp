#pragma once

#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/child.hpp"
#include "core/life_line.hpp"
#include "models/exchange/messages.hpp"
#include "tools/supervisor/restart_schedule.hpp"
#include "tools/supervisor/watchdog.hpp"

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
  /// It is ended and started again after so long without a sign of life (core/life_line); 0: it is
  /// no program of ours, gives no signs and is not watched.
  double patience_s = 0.0;
  std::string vehicle = {};         ///< that it drives; empty: none
  std::vector<int> keep_open = {};  ///< descriptors that it needs
};

struct SupervisedStatus {
  std::string name;
  models::SupervisedPhase phase = models::SupervisedPhase::kRunning;
  int restarts = 0;
  double down_s = 0.0;        ///< not running, since its first start
  std::string last_end = {};  ///< how it last ended; empty: it never did
  pid_t pid = 0;              ///< 0 while it is not running
  bool is_essential = false;
  std::string vehicle = {};                 ///< that it drives; empty: none
  InFlight in_flight = InFlight::kUnknown;  ///< the vehicle, by the last sign of life
};

/// Something that happened to a process, and a sentence about it.
struct SupervisorEvent {
  enum class Kind { kEnded, kStarted, kGivenUp, kHung };
  std::string name;
  Kind kind = Kind::kEnded;
  std::string words;
};

/// Starts processes, ends those that give no signs of life, starts the dead ones again, ends them
/// all. Signs of life come by a pipe of each process alone, so that the network has no part in it.
/// The driver of a vehicle that may be in flight is started again without end. Single thread; it is
/// handed the time (of the monotonic clock), so that back-off can be tested without waiting.
class Supervisor {
 public:
  using Nanoseconds = RestartSchedule::Nanoseconds;
  explicit Supervisor(RestartPolicy policy = {}) : policy_(policy) {}

  /// @throws StartupError when it cannot be executed at all.
  void start(const ProcessSpec& spec, Nanoseconds monotonic_ns);
  /// Takes signs of life, kills what gives none, reaps the dead and starts again those whose
  /// back-off is over; what happened, in that order.
  std::vector<SupervisorEvent> poll(Nanoseconds monotonic_ns);
  /// Asks the drivers of vehicles to end; each further call is one more request. A driver that has
  /// ended then is not started again, unless it failed while its vehicle may be in flight: then its
  /// successor is asked as soon as it has started.
  void end_drivers();
  [[nodiscard]] bool have_drivers_ended() const;
  /// Sends `signal` to every process of ours.
  void send_to_ours(int signal);
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
    LifeLine line = {};
    InFlight in_flight = InFlight::kUnknown;  ///< its vehicle, by the last sign that knew it
  };
  void take_signs(Supervised& process, Nanoseconds now_ns);
  void kill_hung(Nanoseconds now_ns, std::vector<SupervisorEvent>& events);
  SupervisorEvent on_end(Supervised& process, const ChildExit& how, Nanoseconds now_ns);
  SupervisorEvent start_again_later(Supervised& process, const std::string& how,
                                    Nanoseconds now_ns);
  SupervisorEvent restart(Supervised& process, Nanoseconds now_ns);
  void ask_driver(Supervised& process) const;

  RestartPolicy policy_;
  Watchdog watchdog_;
  int driver_requests_ = 0;  ///< to end
  std::vector<Supervised> processes_;
};

}  // namespace vantage::tools
