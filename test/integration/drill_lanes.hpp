#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::test {

/// Chooses the next event and its vehicle for a flight in which each vehicle has its own sequence
/// of events, independent of the others. A vehicle gets an event only if it has followed a plan for
/// 1.5 to 4 s and is commanded to move faster than kMovingMps.
class DrillLanes {
 public:
  static constexpr double kMovingMps = 0.3;

  struct Event {
    std::string what;
    std::string robot;
  };

  /// Sets the kinds of events; each kind is to happen `times` times over all vehicles.
  DrillLanes(const std::vector<std::string>& kinds, int times, std::uint64_t seed);

  void on_status(const models::VehicleStatus& status);
  /// Returns an event that is due, if any. The caller calls happened() after the event was carried
  /// out.
  std::optional<Event> due(Time now);
  void happened(const Event& event);
  /// Suppresses events of `robot` until the given time.
  void rest(const std::string& robot, Time until) { lanes_[robot].ready = until; }
  [[nodiscard]] int left() const;

 private:
  struct Lane {
    std::optional<models::VehicleStatus> status;
    double asked_mps = 0.0;
    std::optional<Time> ready;  ///< earliest time of the next event
  };

  std::map<std::string, int> left_;  ///< number of events left, by kind
  std::mt19937_64 rng_;
  std::map<std::string, Lane> lanes_;
};

}  // namespace vantage::test
