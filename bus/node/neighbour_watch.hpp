#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::bus {

/// Set of teammates that a robot's process subscribes to. If the scenario has no neighbourhood, the
/// set is the complete team. Otherwise the set contains the robots that are in the neighbourhood
/// according to mocap: it is empty until the first frame with the robot, and is updated once per
/// planning step.
class NeighbourWatch {
 public:
  using Action = std::function<void(const std::string& teammate)>;

  /// Calls `on_enter` for each teammate that enters the set, and `on_leave` for each that leaves
  /// the neighbourhood. Without a neighbourhood the constructor calls `on_enter` for all teammates.
  /// Both functions may subscribe and unsubscribe. Precondition: `robot` is in the scenario.
  NeighbourWatch(const scenario::Scenario& scenario, const std::string& robot, Action on_enter,
                 Action on_leave);
  void on_frame(const models::MocapFrame& frame);

 private:
  double within_m_;
  Duration step_;
  std::size_t own_ = 0;
  Action on_enter_;
  Action on_leave_;
  std::vector<std::string> robots_;
  std::vector<std::uint8_t>
      is_near_;  ///< by index in robots_: 1 if the robot was near at the last update
  std::vector<std::uint8_t> was_near_;
  std::optional<Time> updated_at_;  ///< time of the frame of the last update
};

}  // namespace vantage::bus
