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

/// Chooses the next event and its vehicle when each vehicle of a flight has its own sequence of
/// events, independent of the others. Only a vehicle that has followed a plan for 1.5 to 4 s and is
/// commanded to move faster than kMovingMps gets an event.
class DrillLanes {
 public:
  static constexpr double kMovingMps = 0.3;

  struct Event {
    std::string what;
    std::string robot;
  };

  /// Each of `kinds` is to happen `times` times in all.
  DrillLanes(const std::vector<std::string>& kinds, int times, std::uint64_t seed);

  void on_status(const models::VehicleStatus& status);
  /// Returns the event that is due, if any. The caller confirms it with happened() once it was
  /// done.
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
