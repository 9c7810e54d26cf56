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

/// Whom a robot's process listens to: its whole team or, where the scenario states a neighbourhood,
/// those whom mocap shows within it, looked up once a planning step. Until the first frame that
/// shows the robot itself that is nobody.
class NeighbourWatch {
 public:
  using Action = std::function<void(const std::string& teammate)>;

  /// Calls `comes` for each teammate to listen to from now on (at once for all of them without a
  /// neighbourhood), and `goes` for each who is no more near. Both may subscribe and unsubscribe.
  /// Precondition: `robot` is in the scenario.
  NeighbourWatch(const scenario::Scenario& scenario, const std::string& robot, Action comes,
                 Action goes);
  void on_frame(const models::MocapFrame& frame);

 private:
  double within_m_;
  Duration step_;
  std::size_t own_ = 0;
  Action comes_;
  Action goes_;
  std::vector<std::string> robots_;
  std::vector<std::uint8_t> is_near_;  ///< of robots_, at the last look
  std::vector<std::uint8_t> was_near_;
  std::optional<Time> looked_;  ///< at a frame of then
};

}  // namespace vantage::bus
