#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace vantage::tools {

/// Detector of processes that hang: their signs of life have stopped. Pure; `now` is
/// monotonic. A long pause between two calls of overdue() (the caller was delayed or suspended)
/// does not count as silence of the processes.
class Watchdog {
 public:
  /// s; maximum time between two calls of overdue() that counts as silence.
  static constexpr double kPollS = 0.25;
  /// s; time limit for the first sign of a restarted process, if it gave signs before the restart.
  static constexpr double kFirstSignS = 15.0;

  /// Starts to watch `process`. After its first sign of life, at most `patience_s` may pass between
  /// two signs.
  void watch(const std::string& process, double patience_s) {
    watched_[process] = Watched{};
    watched_[process].patience_s = patience_s;
  }
  void on_sign(const std::string& process, Time now);
  /// Notes that the process has ended: no signs are expected until it is restarted.
  void on_end(const std::string& process);
  /// Notes that the process has been restarted.
  void on_start(const std::string& process, Time now);
  /// Returns the overdue processes. A process is returned only once until it gives a sign or is
  /// restarted.
  std::vector<std::string> overdue(Time now);

 private:
  struct Watched {
    double patience_s = 0.0;
    /// true: the process has given a sign; some programs never give one
    bool has_given_sign = false;
    std::optional<Time> sign;
    std::optional<Time> start;  ///< time of a restart, until the first sign after it
  };
  void skip_pause(Time now);

  std::map<std::string, Watched> watched_;
  std::optional<Time> last_poll_;
};

}  // namespace vantage::tools
