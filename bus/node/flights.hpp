#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// The vehicles that are in the air or drive, by their last status (VEHICLE_*).
class Flights {
 public:
  /// An older status counts as none.
  static constexpr Duration kKnownFor = std::chrono::seconds(1);

  explicit Flights(std::set<std::string> robots) : robots_(std::move(robots)) {}

  /// `now`: when it arrived. Statuses of other robots are ignored.
  void on_status(const models::VehicleStatus& status, Time now);
  /// Those in the air or driving, by name.
  [[nodiscard]] std::vector<std::string> in_flight(Time now) const;

 private:
  std::set<std::string> robots_;
  std::map<std::string, Time> seen_in_flight_;
};

/// Holds back the first request to end a process on which vehicles depend, until they have landed.
class EndAfterFlights {
 public:
  /// The first request is not held back for longer.
  static constexpr Duration kPatience = std::chrono::seconds(60);

  /// The number of requests to obey now, of `requests` that have been made.
  int requests(int requests, bool is_any_in_flight, Time now);

 private:
  std::optional<Time> first_;
};

}  // namespace vantage::bus
