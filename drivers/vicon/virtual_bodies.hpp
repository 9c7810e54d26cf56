#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers::vicon {

/// Simulated bodies in a trial with real and simulated vehicles. They are added to the frames of
/// the cameras as if they were in the lab.
///
/// Their poses are taken from the simulator's TRUTH message, which contains only simulated bodies.
/// They are extrapolated to the instant of the frame by their velocity. A real body has priority
/// over a simulated body of the same name. Without a simulator, frames are unchanged.
class VirtualBodies {
 public:
  /// Largest time between TRUTH and the frame; otherwise TRUTH is ignored (the simulator has ended,
  /// or a log is replayed).
  static constexpr Duration kAgeMax = std::chrono::milliseconds(200);

  void on_truth(const models::TruthFrame& truth) { truth_ = truth; }
  /// Adds the simulated bodies to a frame of the cameras.
  void add_to(models::MocapFrame& frame);
  /// Returns the number of simulated bodies omitted because a real body has the same name.
  [[nodiscard]] std::int64_t names_taken() const { return names_taken_; }

 private:
  std::optional<models::TruthFrame> truth_;
  std::int64_t names_taken_ = 0;
};

}  // namespace vantage::drivers::vicon
