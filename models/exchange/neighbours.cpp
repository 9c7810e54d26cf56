#include "models/exchange/neighbours.hpp"

namespace vantage::models {

void find_neighbours(const MocapFrame& frame, const std::vector<std::string>& robots,
                     std::size_t own, double within_m, std::vector<std::uint8_t>& is_near) {
  const MocapBody* self = frame.find(robots[own], own);
  if (self == nullptr || self->occluded) {
    return;
  }
  const Eigen::Vector2d here_m = self->world_from_body.translation_m.head<2>();
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const MocapBody* body = frame.find(robots[i], i);
    if (i == own || body == nullptr || body->occluded) {
      continue;
    }
    const Eigen::Vector2d away_m = body->world_from_body.translation_m.head<2>() - here_m;
    is_near[i] = away_m.squaredNorm() <= within_m * within_m ? 1 : 0;
  }
}

}  // namespace vantage::models
