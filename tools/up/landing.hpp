#pragma once

#include "core/time.hpp"

namespace vantage::tools {

/// Decides how long to wait for the drivers at the end of a trial with vehicles in flight. The
/// caller requests the drivers to end once before the first step. Pure.
class Landing {
 public:
  static constexpr Duration kPatience = std::chrono::seconds(60);
  /// Time for the drivers to hand over to the autopilots' own landing after the second request.
  static constexpr Duration kHurriedPatience = std::chrono::seconds(4);

  explicit Landing(Time begin) : give_up_(begin + kPatience) {}

  enum class Step {
    kWait,
    kRequestAgain,  ///< request the end of the drivers once more
    kOver,
  };
  /// @param is_at_rest   all drivers have ended and all vehicles have landed
  /// @param is_urgent    the user has requested the end a second time
  Step step(bool is_at_rest, bool is_urgent, Time now);

 private:
  Time give_up_;
  bool is_hurried_ = false;
};

}  // namespace vantage::tools
