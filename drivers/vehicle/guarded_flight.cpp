#include "drivers/vehicle/guarded_flight.hpp"

#include "models/exchange/counts.hpp"

namespace vantage::drivers {
namespace {

constexpr double kSeenS = 0.1;  // s; maximum age of a pose that may correct a set-point

}  // namespace

GuardedFlight::GuardedFlight(const scenario::Scenario& scenario, const std::string& robot,
                             const SafetyLimits& limits)
    : guard_(scenario, robot, limits),
      tracker_(robot, 2.0 * limits.vehicle.speed_max_mps),
      vehicle_(limits.vehicle),
      robot_(robot) {}

bool GuardedFlight::accept_pose(const models::MocapFrame& frame, Time now) {
  if (!guard_.on_mocap(frame, now)) {
    return false;  // the guard counts rejected frames
  }
  // Poses that flight safety rejects are neither used for steering nor sent to the vehicle.
  const PoseVerdict judged = guard_.pose_verdict();
  if (judged != PoseVerdict::kAccepted && judged != PoseVerdict::kAbsent &&
      judged != PoseVerdict::kStuck) {
    ++poses_refused_;
    return false;
  }
  const BodyVerdict verdict =
      tracker_.update(frame, guard_.captured(), now, !is_airborne(orders_.state));
  poses_unseen_ += verdict == BodyVerdict::kUnseen ? 1 : 0;
  poses_refused_ += verdict != BodyVerdict::kUnseen && verdict != BodyVerdict::kTaken ? 1 : 0;
  return verdict == BodyVerdict::kTaken;
}

bool GuardedFlight::may_send_setpoint(Time now) const {
  return now - last_setpoint_ >= kSetpointSpacing;
}

void GuardedFlight::on_plan(const models::RobotPlan& plan, Time now) {
  if (plan.robot == robot_) {
    static_cast<void>(guard_.on_plan(plan, now));  // the guard counts rejected plans
  } else {
    guard_.on_teammate_plan(plan, now);
  }
}

double GuardedFlight::update_orders(Time now) {
  const double elapsed_s = to_seconds(now - last_setpoint_);
  last_setpoint_ = now;
  next_setpoint_ = now + kSetpointPeriod + kPoseGrace;
  orders_ = guard_.tick(now);
  has_changed_ = has_changed_ || orders_.changed;
  return elapsed_s;
}

void GuardedFlight::request_end(bool is_hurried) {
  guard_.on_end_request();
  is_hurried_ = is_hurried_ || is_hurried;
  next_setpoint_ = Time{};  // the next tick decides, without waiting for a set-point
}

std::optional<BodyState> GuardedFlight::seen_body(Time now) const {
  const auto age = tracker_.age(now);
  return age && to_seconds(*age) < kSeenS ? tracker_.state() : std::nullopt;
}

bool GuardedFlight::is_below(double height_m) const {
  return tracker_.state() &&
         tracker_.state()->world_from_body.translation_m.z() - ground_m_.value_or(0.0) < height_m;
}

void GuardedFlight::append_counters(std::vector<models::NamedCount>& counters,
                                    std::string_view prefix) const {
  for (models::NamedCount& counter : guard_.counters()) {
    counters.push_back(std::move(counter));
  }
  const std::string name(prefix);
  models::append_nonzero(counters, {{name + ".poses_unseen", poses_unseen_},
                                    {name + ".poses_refused", poses_refused_}});
}

}  // namespace vantage::drivers
