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

/// Which vehicle something happens to next, and what, when each vehicle of a flight has its own
/// mishaps, one after the other, and nobody waits for the others. Only to a vehicle that follows a
/// plan, has done so for 1.5 to 4 s, and is asked to move faster than kMovingMps.
class DrillLanes {
 public:
  static constexpr double kMovingMps = 0.3;

  struct Event {
    std::string what;
    std::string robot;
  };

  /// Each of `kinds` is to happen `times` times.
  DrillLanes(const std::vector<std::string>& kinds, int times, std::uint64_t seed);

  void on_status(const models::VehicleStatus& status);
  /// What happens now; it is for the caller to say with happened() that it did.
  std::optional<Event> due(Time now);
  void happened(const Event& event);
  /// Until then nothing more happens to this robot.
  void rest(const std::string& robot, Time until) { lanes_[robot].ready = until; }
  [[nodiscard]] int left() const;

 private:
  struct Lane {
    std::optional<models::VehicleStatus> status;
    double asked_mps = 0.0;
    std::optional<Time> ready;  ///< while it follows
  };

  std::map<std::string, int> left_;  ///< by kind
  std::mt19937_64 rng_;
  std::map<std::string, Lane> lanes_;
};

}  // namespace vantage::test
