#include "drivers/vicon/vrpn_trackers.hpp"

#include <algorithm>
#include <cstdlib>

#include "core/angle.hpp"
#include "wire/vicon/rotation.hpp"

namespace vantage::drivers::vicon {
namespace {

/// Longest interval that can be a tracker's period; a longer interval is a loss of tracking.
constexpr std::int64_t kStepMax_us = 250'000;
/// µs; a leader with unknown period is replaced after this time without a report.
constexpr std::int64_t kUnknownSilence_us = 100'000;
constexpr int kApartReports = 3;
constexpr int kTogetherReports = 1'000;

bool is_near(std::int64_t a_us, std::int64_t b_us) {
  return std::abs(a_us - b_us) <= VrpnTrackers::kSameFrame_us;
}

bool is_zero(const wire::vicon::VrpnPose& pose) {
  const Eigen::Vector4d& q = pose.quaternion_xyzw;
  return pose.position_m.isZero(0.0) && (q.isZero(0.0) || q.head<3>().isZero(0.0));
}

Eigen::Quaterniond rotation_of(const wire::vicon::VrpnPose& pose) {
  const Eigen::Vector4d& q = pose.quaternion_xyzw;
  return Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized();
}

/// Returns the pose of a body that moved from `before` to `last`, extrapolated beyond `last` by
/// `share` of that motion.
wire::vicon::VrpnPose extrapolated(const wire::vicon::VrpnPose& before,
                                   const wire::vicon::VrpnPose& last, double share) {
  wire::vicon::VrpnPose out = last;
  out.position_m = last.position_m + share * (last.position_m - before.position_m);
  const Eigen::AngleAxisd turn(rotation_of(before).conjugate() * rotation_of(last));
  double angle_rad = turn.angle();  // rad; angle of the shorter rotation
  angle_rad -= angle_rad > kPi ? 2.0 * kPi : 0.0;
  out.quaternion_xyzw =
      (rotation_of(last) * Eigen::AngleAxisd(share * angle_rad, turn.axis())).coeffs();
  return out;
}

}  // namespace

std::int64_t VrpnTrackers::Tracker::period_us() const {
  if (steps < kSteps) {
    return 0;
  }
  auto sorted = steps_us;
  std::nth_element(sorted.begin(), sorted.begin() + kSteps / 2, sorted.end());
  return sorted[kSteps / 2];
}

void VrpnTrackers::Tracker::note(std::int64_t stamp_us, const wire::vicon::VrpnPose& pose) {
  const std::int64_t step_us = stamp_us - last.stamp_us;
  if (reports > 0 && step_us > 0 && step_us <= kStepMax_us) {
    steps_us[steps++ % kSteps] = step_us;
  }
  before = last;
  last = {stamp_us, pose};
  ++reports;
}

void VrpnTrackers::place(SeenBody& body, const wire::vicon::VrpnPose& pose, bool is_y_up) {
  const Eigen::Vector4d& q = pose.quaternion_xyzw;
  set_pose(body, pose.position_m, wire::vicon::rotation_from_xyzw(q.x(), q.y(), q.z(), q.w()),
           is_zero(pose), is_y_up);
}

void VrpnTrackers::clear() {
  trackers_.clear();
  leader_ = 0;
}

VrpnTrackers::Tracker& VrpnTrackers::tracker_of(const std::string& name) {
  const auto known = std::find_if(trackers_.begin(), trackers_.end(),
                                  [&](const Tracker& each) { return each.name == name; });
  if (known != trackers_.end()) {
    return *known;
  }
  trackers_.emplace_back().name = name;
  return trackers_.back();
}

void VrpnTrackers::lead(const Tracker& tracker) {
  leader_ = static_cast<std::size_t>(&tracker - trackers_.data());
  for (Tracker& each : trackers_) {
    each.apart = 0;
    each.together = 0;
    each.is_held = false;
  }
}

void VrpnTrackers::choose_leader(const Tracker& reporter) {
  const Tracker& leader = trackers_[leader_];
  const std::int64_t period_us = leader.period_us();
  const std::int64_t silent_us = reporter.last.stamp_us - leader.last.stamp_us;
  const bool is_silent = silent_us > (period_us > 0 ? 5 * period_us / 2 : kUnknownSilence_us);
  const bool is_slower =
      reporter.period_us() > 0 && period_us > 0 && 3 * reporter.period_us() < 2 * period_us;
  if (is_silent || is_slower) {
    lead(reporter);
  }
}

bool VrpnTrackers::take(const std::string& name, std::int64_t stamp_us,
                        const wire::vicon::VrpnPose& pose) {
  Tracker& tracker = tracker_of(name);
  tracker.note(stamp_us, pose);
  if (&tracker != &trackers_[leader_]) {
    choose_leader(tracker);
  }
  const Tracker& leader = trackers_[leader_];
  if (&tracker == &leader) {
    return false;
  }
  // The reports of one instant may arrive in any order.
  const bool is_together =
      is_near(stamp_us, leader.last.stamp_us) ||
      (tracker.reports > 1 && (is_near(tracker.before.stamp_us, leader.last.stamp_us) ||
                               is_near(tracker.before.stamp_us, leader.before.stamp_us)));
  tracker.apart = is_together ? 0 : tracker.apart + 1;
  tracker.together = is_together ? tracker.together + 1 : 0;
  const bool is_slower = tracker.period_us() > 0 && leader.period_us() > 0 &&
                         2 * tracker.period_us() > 3 * leader.period_us();
  // A new leader with unknown period may vanish again, so no other tracker is held because of this
  // leader.
  if ((tracker.apart >= kApartReports && leader.period_us() > 0) || is_slower) {
    tracker.is_held = true;
  } else if (tracker.together >= kTogetherReports) {
    tracker.is_held = false;
  }
  return tracker.is_held;
}

void VrpnTrackers::add_held(std::int64_t stamp_us, SeenFrame& frame) const {
  for (const Tracker& tracker : trackers_) {
    if (!tracker.is_held || frame.has(tracker.name)) {
      continue;
    }
    constexpr std::int64_t kSlack_us = 2'000;
    const std::int64_t age_us = stamp_us - tracker.last.stamp_us;
    const std::int64_t step_us = tracker.last.stamp_us - tracker.before.stamp_us;
    if (std::abs(age_us) > 3 * tracker.period_us() / 2 + kSlack_us) {
      continue;
    }
    const bool is_moving = tracker.reports > 1 && step_us > 0 && step_us <= kStepMax_us &&
                           !is_zero(tracker.last.pose) && !is_zero(tracker.before.pose);
    SeenBody& body = frame.add();
    body.name = tracker.name;
    place(body,
          is_moving ? extrapolated(tracker.before.pose, tracker.last.pose,
                                   static_cast<double>(age_us) / static_cast<double>(step_us))
                    : tracker.last.pose,
          is_y_up_);
  }
}

std::vector<BodyRate> VrpnTrackers::rates() const {
  std::vector<BodyRate> out;
  for (const Tracker& tracker : trackers_) {
    const std::int64_t period_us = tracker.period_us();
    out.push_back({tracker.name, period_us > 0 ? 1e6 / static_cast<double>(period_us) : 0.0});
  }
  return out;
}

}  // namespace vantage::drivers::vicon
