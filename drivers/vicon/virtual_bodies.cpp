#include "drivers/vicon/virtual_bodies.hpp"

#include <algorithm>
#include <utility>

namespace vantage::drivers::vicon {

void VirtualBodies::add_to(models::MocapFrame& frame) {
  if (!truth_) {
    return;
  }
  const Duration ahead = frame.stamp.time - truth_->stamp.time;
  if (std::max(ahead, -ahead) > kAgeMax) {
    return;
  }
  const std::size_t real = frame.bodies.size();
  for (const models::TruthBody& body : truth_->bodies) {
    const auto end = frame.bodies.begin() + static_cast<std::ptrdiff_t>(real);
    if (std::any_of(frame.bodies.begin(), end,
                    [&](const models::MocapBody& seen) { return seen.name == body.name; })) {
      ++names_taken_;
      continue;
    }
    models::MocapBody added{body.name, body.world_from_body, false};
    added.world_from_body.translation_m += to_seconds(ahead) * body.velocity_world_mps;
    frame.bodies.push_back(std::move(added));
  }
}

}  // namespace vantage::drivers::vicon
