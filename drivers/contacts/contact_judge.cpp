#include "drivers/contacts/contact_judge.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "models/exchange/counts.hpp"

namespace vantage::drivers {
namespace {

std::vector<models::CollisionMonitor::Body> bodies_of(const scenario::Scenario& scenario) {
  std::vector<models::CollisionMonitor::Body> out;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    out.push_back({robot.name, robot.limits.radius_m, true});
  }
  for (const scenario::TargetSpec& target : scenario.targets) {
    out.push_back({target.name, target.radius_m, false});
  }
  return out;
}

}  // namespace

ContactJudge::ContactJudge(const scenario::Scenario& scenario)
    : monitor_(scenario.world, bodies_of(scenario), scenario.planner.separation_m) {
  for (const scenario::RobotSpec& robot : scenario.robots) {
    bodies_.emplace(robot.name, bodies_.size());
    robots_.emplace(robot.name, Flown{});
    other_radius_m_ = std::max(other_radius_m_, robot.limits.radius_m);
    if (robot.device != scenario::DeviceSource::kReal) {
      simulated_.insert(robot.name);
    }
  }
  for (const scenario::TargetSpec& target : scenario.targets) {
    bodies_.emplace(target.name, bodies_.size());
    targets_.insert(target.name);
  }
  named_ = bodies_.size();
}

void ContactJudge::on_status(const models::VehicleStatus& status) {
  const auto found = robots_.find(status.robot);
  if (found == robots_.end()) {
    return;
  }
  Flown& robot = found->second;
  const bool is_killed = status.state == models::FlightState::kKilled;
  if (is_killed && !robot.is_killed) {
    robot.killed_at = status.stamp.time;
  }
  robot.is_killed = is_killed;
  // A robot that was killed on the ground does not fall.
  robot.is_flying = is_killed ? robot.is_flying : status.state != models::FlightState::kIdle;
}

void ContactJudge::on_truth(const models::TruthFrame& truth) {
  for (const models::TruthBody& body : truth.bodies) {
    if (targets_.contains(body.name)) {
      simulated_.insert(body.name);
    }
  }
}

bool ContactJudge::is_simulated(const std::string& body) const { return simulated_.contains(body); }

bool ContactJudge::is_in_flight(const std::string& body, Time now) const {
  const auto found = robots_.find(body);
  return found != robots_.end() && found->second.is_flying &&
         (!found->second.is_killed || now - found->second.killed_at <= kFall);
}

bool ContactJudge::counts(const models::CollisionReport& contact) const {
  const bool is_flown = is_in_flight(contact.body_a, contact.stamp.time) ||
                        is_in_flight(contact.body_b, contact.stamp.time);
  const bool is_of_two = bodies_.contains(contact.body_b);
  const bool is_real =
      !is_simulated(contact.body_a) || (is_of_two && !is_simulated(contact.body_b));
  return is_flown && is_real;
}

void ContactJudge::place(const models::MocapFrame& frame) {
  constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
  centres_m_.assign(bodies_.size(), Eigen::Vector3d::Constant(kUnseen));
  for (const models::MocapBody& body : frame.bodies) {
    auto found = bodies_.find(body.name);
    if (found == bodies_.end()) {
      if (bodies_.size() >= named_ + kOthersMax) {
        ++others_left_out_;
        continue;
      }
      found = bodies_.emplace(body.name, bodies_.size()).first;
      monitor_.add({body.name, other_radius_m_, true});
      centres_m_.push_back(Eigen::Vector3d::Constant(kUnseen));
    }
    if (!body.occluded) {
      centres_m_[found->second] = body.world_from_body.translation_m;
    }
  }
}

std::vector<models::CollisionReport> ContactJudge::on_frame(const models::MocapFrame& frame,
                                                            Time now) {
  const bool is_same_run = has_last_ && frame.stamp.run_id == last_run_;
  clocks_set_ += clock_.on_frame(frame, now) ? 0 : 1;
  const Time captured = clock_.captured();
  if (is_same_run && captured <= last_captured_) {
    ++out_of_order_;
    return {};
  }
  if (has_last_ && (!is_same_run || captured - last_captured_ > kGapMax)) {
    ++gaps_;
    monitor_.forget_motion();
  }
  last_run_ = frame.stamp.run_id;
  last_captured_ = captured;
  has_last_ = true;
  place(frame);
  new_contacts_.clear();
  monitor_.update(captured, centres_m_, new_contacts_);
  std::vector<models::CollisionReport> out;
  std::copy_if(new_contacts_.begin(), new_contacts_.end(), std::back_inserter(out),
               [this](const models::CollisionReport& contact) { return counts(contact); });
  return out;
}

std::vector<models::NamedCount> ContactJudge::counters() const {
  return models::nonzero({{"contacts.gaps", gaps_},
                          {"contacts.frames_out_of_order", out_of_order_},
                          {"contacts.clocks_set", clocks_set_},
                          {"contacts.bodies_left_out", others_left_out_},
                          {"contacts.judges_differ", monitor_.disagreements()}});
}

}  // namespace vantage::drivers
