#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers::vicon {

/// Bodies that no camera sees, because they are simulated: a trial of real vehicles and simulated
/// ones has them in its frames as if they stood in the lab.
///
/// Where they are comes from the simulator's TRUTH, whose bodies are the simulated ones and nothing
/// else, carried on to the instant of the frame by their velocity. What the cameras see wins over a
/// simulated body of the same name. Real bodies never depend on this: without a simulator, frames
/// are as they came.
class VirtualBodies {
 public:
  /// A truth farther from the frame's instant than this tells nothing (a simulator that has ended,
  /// a log that is played back): nothing is added.
  static constexpr Duration kAgeMax = std::chrono::milliseconds(200);

  void on_truth(const models::TruthFrame& truth) { truth_ = truth; }
  /// Adds the simulated bodies to a frame of the cameras'.
  void add_to(models::MocapFrame& frame);
  /// Simulated bodies left out, because a real one has their name.
  [[nodiscard]] std::int64_t names_taken() const { return names_taken_; }

 private:
  std::optional<models::TruthFrame> truth_;
  std::int64_t names_taken_ = 0;
};

}  // namespace vantage::drivers::vicon
