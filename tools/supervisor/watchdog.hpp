#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace vantage::tools {

/// Tells which processes run but live no more: those that gave signs of life and have stopped.
/// Pure; `now` is monotonic.
class Watchdog {
 public:
  /// From now on `process` has to give a sign at least each `patience_s`, once it has given one.
  void watch(const std::string& process, double patience_s) {
    watched_[process] = {patience_s, {}};
  }
  void on_sign(const std::string& process, Time now);
  /// It has been started anew: it may take its time until its first sign.
  void on_start(const std::string& process);
  /// Those overdue, each named once until it gives a sign or is started anew.
  std::vector<std::string> overdue(Time now);

 private:
  struct Watched {
    double patience_s = 0.0;
    std::optional<Time> sign;
  };
  std::map<std::string, Watched> watched_;
};

}  // namespace vantage::tools
