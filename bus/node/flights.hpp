#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// Set of vehicles that are flying or driving, according to their last status (VEHICLE_*).
class Flights {
 public:
  /// Maximum age of a status; older statuses are ignored.
  static constexpr Duration kKnownFor = std::chrono::seconds(1);

  explicit Flights(std::set<std::string> robots) : robots_(std::move(robots)) {}

  /// Uses a status that arrived at `now`. Statuses of robots that are not in `robots` (constructor)
  /// are ignored.
  void on_status(const models::VehicleStatus& status, Time now);
  /// Returns the names of the vehicles that are flying or driving.
  [[nodiscard]] std::vector<std::string> in_flight(Time now) const;

 private:
  std::set<std::string> robots_;
  std::map<std::string, Time> seen_in_flight_;
};

/// Delays the first stop request to a process that vehicles need, until the vehicles have landed.
class EndAfterFlights {
 public:
  /// Maximum delay of the first request.
  static constexpr Duration kPatience = std::chrono::seconds(60);

  /// Returns the number of stop requests to obey now. `requests` is the number received so far.
  int requests(int requests, bool is_any_in_flight, Time now);

 private:
  std::optional<Time> first_;
};

}  // namespace vantage::bus
