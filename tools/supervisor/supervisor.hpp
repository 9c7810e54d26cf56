#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "tools/supervisor/child.hpp"

namespace vantage::tools {

/// One process to keep alive.
struct ProcessSpec {
  std::string name;
  std::vector<std::string> arguments;  ///< the executable first
};

/// How a dead process is started again.
struct RestartPolicy {
  double backoff_first_s = 0.25;  ///< doubled after each death
  double backoff_max_s = 4.0;
  int restarts_max = 5;  ///< of each process; after that it is given up
};

enum class ProcessPhase { kRunning, kWaiting, kGivenUp };

struct SupervisedStatus {
  std::string name;
  ProcessPhase phase = ProcessPhase::kRunning;
  int restarts = 0;
  std::string last_end;  ///< how it last ended; empty: it never did
};

/// Starts processes, starts the dead ones again, ends them all. Single thread; told the time (of
/// the monotonic clock), so that back-off can be tested without waiting.
class Supervisor {
 public:
  using Nanoseconds = std::int64_t;
  explicit Supervisor(RestartPolicy policy = {}) : policy_(policy) {}

  /// @throws StartupError when it cannot be executed at all.
  void start(const ProcessSpec& spec);
  /// Reaps the dead and starts again those whose back-off is over; what happened, in sentences.
  std::vector<std::string> poll(Nanoseconds monotonic_ns);
  /// SIGTERM to all in reverse order of starting, waits for them, SIGKILL to those still alive
  /// after `patience`; what had to be killed.
  std::vector<std::string> stop_all(std::chrono::milliseconds patience);

  [[nodiscard]] std::vector<SupervisedStatus> status() const;
  [[nodiscard]] int restarts() const;
  [[nodiscard]] bool any_given_up() const;
  /// nullptr while it is not running.
  [[nodiscard]] Child* find(const std::string& name);

 private:
  struct Supervised {
    ProcessSpec spec;
    std::optional<Child> child;
    SupervisedStatus status;
    Nanoseconds restart_at_ns = 0;
  };
  std::string on_end(Supervised& process, const std::string& how, Nanoseconds now_ns) const;

  RestartPolicy policy_;
  std::vector<Supervised> processes_;
};

}  // namespace vantage::tools
