#pragma once

#include "core/time.hpp"

namespace vantage::tools {

/// The end of a trial with vehicles in flight: decides how long to wait for their drivers. The
/// drivers were asked to end once when it begins. Pure.
class Landing {
 public:
  static constexpr Duration kPatience = std::chrono::seconds(60);
  /// For the drivers once they were asked again, to hand over to the autopilots' own landing.
  static constexpr Duration kHurry = std::chrono::seconds(4);

  explicit Landing(Time begin) : give_up_(begin + kPatience) {}

  enum class Step {
    kWait,
    kHurry,  ///< ask the drivers again
    kOver,
  };
  /// @param is_at_rest   no driver and no vehicle is waited for any more
  /// @param is_urgent    somebody asked for the end once more
  Step step(bool is_at_rest, bool is_urgent, Time now);

 private:
  Time give_up_;
  bool is_hurried_ = false;
};

}  // namespace vantage::tools
