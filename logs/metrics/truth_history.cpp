#include "logs/metrics/truth_history.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/world/world.hpp"

namespace vantage::logs {

void TruthHistory::add(const models::TruthFrame& frame) {
  if (!frames_.empty() && frame.stamp.time <= frames_.back().time) {
    ++frames_ignored_;
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
  for (auto a = after.robots.begin(); a != after.robots.end(); ++a) {
    for (auto b = std::next(a); b != after.robots.end(); ++b) {
      const auto a_before = before.robots.find(a->first);
      const auto b_before = before.robots.find(b->first);
      const bool both = a_before != before.robots.end() && b_before != before.robots.end();
      const Eigen::Vector3d& a0 = both ? a_before->second : a->second;
      const Eigen::Vector3d& b0 = both ? b_before->second : b->second;
      const double distance_m = models::closest_approach_m(a0, a->second, b0, b->second);
      min_separation_m_ = std::min(min_separation_m_, distance_m);
    }
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
