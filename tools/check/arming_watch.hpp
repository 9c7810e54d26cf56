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

/// Listens to a running system and says what keeps each vehicle from being armed: bodies that mocap
/// does not show, drivers that are silent, an operator who is missing, messages of another version
/// of the message types, messages that processes refuse meanwhile for their signatures, and what
/// each driver gives as its reasons.
class ArmingWatch {
 public:
  /// `bus` and `scenario` must outlive it.
  ArmingWatch(bus::Bus& bus, const scenario::Scenario& scenario);
  ArmingWatch(const ArmingWatch&) = delete;
  ArmingWatch& operator=(const ArmingWatch&) = delete;
  ArmingWatch(ArmingWatch&&) = delete;
  ArmingWatch& operator=(ArmingWatch&&) = delete;
  ~ArmingWatch() = default;

  /// One line for each obstacle to arming, from what was heard so far; empty: all may be armed.
  [[nodiscard]] std::vector<std::string> blocks() const;

 private:
  /// What one counter of one process said first and last.
  struct Growth {
    std::int64_t first = 0;
    std::int64_t last = 0;
  };
  static constexpr std::size_t kProcessesMax = 1024;
  static constexpr std::size_t kRefusalsMax = 256;  ///< of one process
  void on_health(const models::ProcessHealth& health);
  void append_refusals(std::vector<std::string>& out) const;

  const bus::Bus& bus_;
  const scenario::Scenario& scenario_;
  std::map<std::string, models::VehicleStatus> vehicles_;
  std::map<std::string, int> frames_with_;  ///< frames that show the body unoccluded
  int frames_ = 0;
  int heartbeats_ = 0;
  std::map<std::string, bool> processes_;                          ///< heard once already
  std::map<std::string, std::map<std::string, Growth>> refusals_;  ///< by process and counter
};

}  // namespace vantage::tools
