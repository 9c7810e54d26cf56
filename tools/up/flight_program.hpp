#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::tools {

/// Automatic operator: arms vehicles, lets them take off and follow plans, and lands them at the
/// end. Chooses its orders from the vehicle statuses (VEHICLE_*). Uses neither a clock nor the bus.
///
/// Repeats each order until the vehicle obeys. A vehicle that another station has commanded gets
/// only the order to land at the end. A vehicle that has landed, was killed or is idle again does
/// not take off again.
class FlightProgram {
 public:
  struct Order {
    models::OperatorAction action = models::OperatorAction::kHold;
    std::string robot;
  };

  explicit FlightProgram(const std::vector<std::string>& robots);

  void on_status(const models::VehicleStatus& status);
  /// Handles a command of another station. Ignores heartbeats and old commands (from a played log).
  void on_other_station(const models::OperatorCommand& command, Time now);
  /// Returns the orders to send now. Call about every 100 ms.
  std::vector<Order> due(Time now);

  /// Orders all vehicles to land from now on.
  void land_all() { is_over_ = true; }
  /// True if every vehicle with a status is idle or killed and was ordered to land at least once.
  [[nodiscard]] bool is_down() const;
  /// Returns the vehicles that have followed a plan since the start.
  [[nodiscard]] const std::set<std::string>& have_flown() const { return have_flown_; }

 private:
  struct Vehicle {
    std::optional<models::VehicleStatus> status;
    bool has_other_station = false;  ///< another station has commanded the vehicle
    bool has_lifted = false;         ///< the vehicle has left the idle state once
    bool was_ordered_to_land = false;
    int ground_orders = 0;
    Time next_order{};
    std::optional<Time> holding_since;
  };
  [[nodiscard]] std::optional<models::OperatorAction> wanted(Vehicle& vehicle, Time now) const;

  std::map<std::string, Vehicle> vehicles_;
  std::set<std::string> have_flown_;
  bool is_over_ = false;
};

}  // namespace vantage::tools
