#pragma once

#include <optional>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/localizer_spec.hpp"
#include "scenario/scenario.hpp"

namespace vantage::sim {

/// Times and areas in which the simulated motion capture does not see bodies.
class MocapOutage {
 public:
  MocapOutage(std::vector<scenario::MocapOutageSpec> outages,
              const std::vector<scenario::RobotSpec>& robots, Time start);

  /// Updates the time of take-off, when all robots have reached their height. Call it for each
  /// instant at which hides() is needed.
  void update(const models::TruthFrame& truth);
  /// True if motion capture does not see a body at `position_m` at `time`.
  [[nodiscard]] bool hides(const Eigen::Vector2d& position_m, Time time) const;
  /// Marks the hidden bodies of `frame` as occluded. `truth` has the same bodies.
  void hide(models::MocapFrame& frame, const models::TruthFrame& truth) const;

 private:
  std::vector<scenario::MocapOutageSpec> outages_;
  std::vector<scenario::RobotSpec> robots_;
  Time start_;
  std::optional<Time> taken_off_;
};

}  // namespace vantage::sim
