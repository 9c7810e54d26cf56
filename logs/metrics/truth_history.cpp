#include "logs/metrics/truth_history.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "models/world/world.hpp"

namespace vantage::logs {

void TruthHistory::add(const models::TruthFrame& frame) {
  if (!frames_.empty() && frame.stamp.time <= frames_.back().time) {
    return;
  }
  Frame next;
  next.time = frame.stamp.time;
  for (const models::TruthBody& body : frame.bodies) {
    if (body.target_id >= 0) {
      next.targets[body.target_id] = body.world_from_body.translation_m;
    } else {
      next.robots[body.name] = body.world_from_body.translation_m;
    }
  }
  approach(frames_.empty() ? next : frames_.back(), next);
  frames_.push_back(std::move(next));
  while (to_seconds(frames_.back().time - frames_.front().time) > memory_s_) {
    frames_.pop_front();
  }
}

void TruthHistory::approach(const Frame& before, const Frame& after) {
  constexpr double kRoundingM = 1e-6;
  std::vector<Eigen::Vector3d> to_m;
  std::vector<const Eigen::Vector3d*> from_m;  // null: robot absent from `before`
  double travelled_m = 0.0;
  for (const auto& [name, position_m] : after.robots) {
    const auto seen = before.robots.find(name);
    to_m.push_back(position_m);
    from_m.push_back(seen == before.robots.end() ? nullptr : &seen->second);
    travelled_m = std::max(travelled_m,
                           from_m.back() == nullptr ? 0.0 : (position_m - *from_m.back()).norm());
  }
  // Only pairs within this distance in the new frame can have been closer than the minimum.
  const double within_m = min_separation_m_ + 2.0 * travelled_m + kRoundingM;
  for (const auto& [i, j] : near_.find(to_m, within_m)) {
    const bool both = from_m[i] != nullptr && from_m[j] != nullptr;
    const double distance_m = models::closest_approach_m(both ? *from_m[i] : to_m[i], to_m[i],
                                                         both ? *from_m[j] : to_m[j], to_m[j]);
    min_separation_m_ = std::min(min_separation_m_, distance_m);
  }
}

std::optional<Eigen::Vector3d> TruthHistory::target_position_m(int target_id, Time time) const {
  const auto after = std::lower_bound(frames_.begin(), frames_.end(), time,
                                      [](const Frame& f, Time t) { return f.time < t; });
  if (after == frames_.end()) {
    return std::nullopt;
  }
  const auto end = after->targets.find(target_id);
  if (end == after->targets.end()) {
    return std::nullopt;
  }
  if (after->time == time) {
    return end->second;
  }
  if (after == frames_.begin()) {
    return std::nullopt;
  }
  const auto before = std::prev(after);
  const auto begin = before->targets.find(target_id);
  if (begin == before->targets.end()) {
    return std::nullopt;
  }
  const double share = to_seconds(time - before->time) / to_seconds(after->time - before->time);
  return begin->second + share * (end->second - begin->second);
}

std::optional<double> TruthHistory::min_separation_m() const {
  return std::isinf(min_separation_m_) ? std::nullopt : std::optional(min_separation_m_);
}

}  // namespace vantage::logs
