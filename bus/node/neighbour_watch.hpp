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

/// The set of robots that a robot's process subscribes to: the whole team or, if the scenario
/// states a neighbourhood, the robots that mocap shows within it. The set is updated once per
/// planning step. It is empty until the first frame that contains the robot itself.
class NeighbourWatch {
 public:
  using Action = std::function<void(const std::string& teammate)>;

  /// Calls `on_enter` for each teammate to subscribe to from now on. Without a neighbourhood it
  /// does so at once for all teammates. Calls `on_leave` for each teammate that has left the
  /// neighbourhood. Both may subscribe and unsubscribe. Precondition: `robot` is in the scenario.
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
  std::vector<std::uint8_t> is_near_;  ///< of robots_, at the last update
  std::vector<std::uint8_t> was_near_;
  std::optional<Time> updated_at_;  ///< time of the frame of the last update
};

}  // namespace vantage::bus
