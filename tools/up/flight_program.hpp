#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::tools {

/// An operator who follows a rule: arms vehicles, has them take off and follow, and lands them at
/// the end. What a person at the console would type, from what VEHICLE_* says; no clock, no bus.
///
/// It asks again until it is obeyed. A vehicle that another station commands is no longer its own:
/// it is not told to fly any more, only to land at the end. One that has landed, been killed or
/// come to rest stays down.
class FlightProgram {
 public:
  struct Order {
    models::OperatorAction action = models::OperatorAction::kHold;
    std::string robot;
  };

  explicit FlightProgram(const std::vector<std::string>& robots);

  void on_status(const models::VehicleStatus& status);
  /// A command by another station than this one; one that is not said now (a log) is ignored.
  void on_other_station(const models::OperatorCommand& command, Time now);
  /// What is to be said now; to be asked every 100 ms or so.
  std::vector<Order> due(Time now);

  /// From now on everything is to come down.
  void bring_down() { is_over_ = true; }
  /// All vehicles are at rest, and have been told so at least once.
  [[nodiscard]] bool is_down() const;
  /// Vehicles that have followed a plan since the start.
  [[nodiscard]] const std::set<std::string>& have_flown() const { return have_flown_; }

 private:
  struct Vehicle {
    std::optional<models::VehicleStatus> status;
    bool is_others = false;   ///< another station has spoken to it
    bool has_lifted = false;  ///< it has been in the air
    bool was_told_to_land = false;
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
