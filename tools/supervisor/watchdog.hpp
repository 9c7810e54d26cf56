#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace vantage::tools {

/// Tells which processes run but live no more: those that gave signs of life and have stopped.
/// Pure; `now` is monotonic. Time in which nobody looked, for who looks was held up or put to
/// sleep, is not their silence.
class Watchdog {
 public:
  /// Between two looks, at most: of a longer pause no more counts.
  static constexpr double kLookS = 0.25;
  /// For the first sign of one that is started again and gave signs before.
  static constexpr double kFirstSignS = 15.0;

  /// From now on `process` has to give a sign at least each `patience_s`, once it has given one.
  void watch(const std::string& process, double patience_s) {
    watched_[process] = Watched{};
    watched_[process].patience_s = patience_s;
  }
  void on_sign(const std::string& process, Time now);
  /// It has ended: until it is started again nothing is expected of it.
  void on_end(const std::string& process);
  /// It has been started anew.
  void on_start(const std::string& process, Time now);
  /// Those overdue, each named once until it gives a sign or is started anew.
  std::vector<std::string> overdue(Time now);

 private:
  struct Watched {
    double patience_s = 0.0;
    bool has_lived = false;  ///< gave a sign once; some never do
    std::optional<Time> sign;
    std::optional<Time> start;  ///< since when a first sign is waited for
  };
  void leave_out_pause(Time now);

  std::map<std::string, Watched> watched_;
  std::optional<Time> looked_;
};

}  // namespace vantage::tools
