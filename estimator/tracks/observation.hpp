#pragma once

#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

/// One scan by this robot's sensor or by a teammate's: the part of a RobotMeasurement that the
/// tracks use. The filter stores it, and every store uses it, in this form.
struct Observation {
  Time time{};
  int source = -1;  ///< index into FilterSpec::team; −1: this robot, which is not in the team
  models::Viewpoint from;
  std::vector<models::Detection>
      detections;        ///< only the detections that TrackStore::file() accepted
  bool counted = false;  ///< true: the counters include the detections of this observation
};

}  // namespace vantage::estimator
