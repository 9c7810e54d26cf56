#pragma once

#include "core/time.hpp"

namespace vantage::tools {

/// Decides how long to wait for the drivers at the end of a trial with vehicles in flight. Before
/// the first step, the caller asks the drivers once to shut down. Pure.
class Landing {
 public:
  static constexpr Duration kPatience = std::chrono::seconds(60);
  /// Time after the second request in which the drivers hand over the landing to the autopilots.
  static constexpr Duration kHurriedPatience = std::chrono::seconds(4);

  explicit Landing(Time begin) : give_up_(begin + kPatience) {}

  enum class Step {
    kWait,
    kRequestAgain,  ///< ask the drivers once more to shut down
    kOver,
  };
  /// @param is_at_rest   all drivers have ended and all vehicles have landed
  /// @param is_urgent    the user has asked a second time to end the trial
  Step step(bool is_at_rest, bool is_urgent, Time now);

 private:
  Time give_up_;
  bool is_hurried_ = false;
};

}  // namespace vantage::tools
