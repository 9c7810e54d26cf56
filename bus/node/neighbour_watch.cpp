#include "bus/node/neighbour_watch.hpp"

#include <algorithm>
#include <utility>

#include "models/exchange/neighbours.hpp"

namespace vantage::bus {

NeighbourWatch::NeighbourWatch(const scenario::Scenario& scenario, const std::string& robot,
                               Action on_enter, Action on_leave)
    : within_m_(scenario.network.neighbourhood_m),
      step_(from_seconds(scenario.planner.step_s)),
      on_enter_(std::move(on_enter)),
      on_leave_(std::move(on_leave)) {
  for (const scenario::RobotSpec& each : scenario.robots) {
    if (within_m_ > 0.0) {
      own_ = each.name == robot ? robots_.size() : own_;
      robots_.push_back(each.name);
    } else if (each.name != robot) {
      on_enter_(each.name);
    }
  }
  is_near_.resize(robots_.size(), 0);
}

void NeighbourWatch::on_frame(const models::MocapFrame& frame) {
  // A time stamp long before the last update means that the last update's time was wrong or that
  // the clock was reset. Such a frame is used.
  const Duration since = updated_at_ ? frame.stamp.time - *updated_at_ : step_;
  if (robots_.empty() || (since < step_ && since > -step_)) {
    return;
  }
  was_near_ = is_near_;
  models::find_neighbours(frame, robots_, own_, within_m_, is_near_);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (is_near_[i] != was_near_[i]) {
      (is_near_[i] != 0 ? on_enter_ : on_leave_)(robots_[i]);
    }
  }
  updated_at_ = frame.stamp.time;
}

}  // namespace vantage::bus
