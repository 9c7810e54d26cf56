#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// Monitor of a running system that reports why vehicles cannot be armed:
/// - bodies without mocap poses, and drivers without statuses;
/// - a missing heartbeat of an operator;
/// - messages of another version of the message types;
/// - messages that processes refuse because of their signatures;
/// - the reasons that each driver reports.
class ArmingWatch {
 public:
  /// `bus` and `scenario` must outlive this object.
  ArmingWatch(bus::Bus& bus, const scenario::Scenario& scenario);
  ArmingWatch(const ArmingWatch&) = delete;
  ArmingWatch& operator=(const ArmingWatch&) = delete;
  ArmingWatch(ArmingWatch&&) = delete;
  ArmingWatch& operator=(ArmingWatch&&) = delete;
  ~ArmingWatch() = default;

  /// Returns one line per reason found in the messages received so far; empty: all vehicles may be
  /// armed.
  [[nodiscard]] std::vector<std::string> blocks() const;

 private:
  /// First and last value of one counter of one process.
  struct Growth {
    std::int64_t first = 0;
    std::int64_t last = 0;
  };
  static constexpr std::size_t kProcessesMax = 1024;
  static constexpr std::size_t kRefusalsMax = 256;  ///< maximum number of counters per process
  void on_health(const models::ProcessHealth& health);
  void append_refusals(std::vector<std::string>& out) const;

  const bus::Bus& bus_;
  const scenario::Scenario& scenario_;
  std::map<std::string, models::VehicleStatus> vehicles_;
  std::map<std::string, int> frames_with_;  ///< number of frames in which the body is not occluded
  int frames_ = 0;
  int heartbeats_ = 0;
  std::map<std::string, bool> processes_;  ///< by process; true: a message was received
  std::map<std::string, std::map<std::string, Growth>>
      refusals_;  ///< refused messages, by process and counter
};

}  // namespace vantage::tools
