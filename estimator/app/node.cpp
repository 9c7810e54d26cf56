#include "estimator/app/node.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "bus/convert/channels.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::estimator {

namespace {

constexpr std::size_t kMeasurementsWaitingPerRobot = 64;
constexpr std::size_t kPosesKept = 256;

/// Returns the last instant kτ ≤ `t`.
Time instant_before(Time t, Duration step) {
  const std::int64_t utime = to_utime(t);
  const std::int64_t step_us = step.count();
  const std::int64_t behind = ((utime % step_us) + step_us) % step_us;
  return from_utime(utime - behind);
}

}  // namespace

EstimatorNode::EstimatorNode(bus::Bus& bus, const bus::Clock& clock,
                             const scenario::Scenario& scenario, const std::string& robot,
                             BeliefOverride belief_override)
    : bus_(bus),
      clock_(clock),
      filter_(filter_spec(scenario, robot)),
      belief_override_(std::move(belief_override)),
      robot_(robot),
      mocap_index_(static_cast<std::size_t>(scenario.find_robot(robot) - scenario.robots.data())),
      step_(from_seconds(scenario.planner.step_s)),
      lag_(step_ / 10),
      lag_max_(step_ / 6) {
  next_instant_ = instant_before(clock.now() - lag_, step_) + step_;
  subscribe_measurements(robot_);
  bus_.subscribe<models::MocapFrame>(bus::kVicon, [this](const auto& frame) {
    neighbours_->on_frame(frame);
    on_mocap(frame);
  });
  neighbours_.emplace(
      scenario, robot_, [this](const std::string& teammate) { subscribe_teammate(teammate); },
      [this](const std::string& teammate) {
        bus_.unsubscribe(bus::measurement_channel(teammate).name);
        bus_.unsubscribe(bus::belief_channel(teammate).name);
        newest_.erase(teammate);
      });
  if (scenario.planner.objective == scenario::PlanObjective::kMapping) {
    map_.emplace(bus, scenario, robot);
  }
}

std::string EstimatorNode::name() const { return "ESTIMATOR_" + robot_; }

void EstimatorNode::subscribe_measurements(const std::string& sender) {
  bus_.subscribe_shared<models::RobotMeasurement>(
      bus::measurement_channel(sender),
      [this, sender](const auto&, const auto& look) { on_measurement(sender, look); });
}

void EstimatorNode::subscribe_teammate(const std::string& teammate) {
  if (filter_.spec().communication_range_m > 0.0) {
    subscribe_measurements(teammate);
  }
  bus_.subscribe_shared<models::RobotBelief>(
      bus::belief_channel(teammate),
      [this, teammate](const auto&, const auto& m) { on_belief(teammate, m); });
}

void EstimatorNode::on_measurement(const std::string& sender,
                                   const std::shared_ptr<const models::RobotMeasurement>& look) {
  if (look->robot != sender) {
    ++misaddressed_;
    return;
  }
  if (measurements_.size() ==
      kMeasurementsWaitingPerRobot * std::max<std::size_t>(1, filter_.spec().team.size())) {
    measurements_.pop_front();
    ++looks_overflowed_;
  }
  measurements_.push_back({name_of(bus::measurement_channel(sender).name, look->stamp), look});
  if (sender == robot_ && look->stamp.time > last_own_measurement_) {
    last_own_measurement_ = look->stamp.time;
    last_own_measurement_received_ = clock_.now();
  }
}

void EstimatorNode::on_mocap(const models::MocapFrame& frame) {
  const auto pose = own_pose(frame, robot_, mocap_index_);
  if (!pose) {
    return;
  }
  if (poses_.size() == kPosesKept) {
    poses_.pop_front();
  }
  poses_.push_back(
      {name_of(bus::kVicon.name, frame.stamp), std::make_shared<const OwnPose>(*pose)});
}

void EstimatorNode::on_belief(const std::string& teammate,
                              const std::shared_ptr<const models::RobotBelief>& belief) {
  if (belief->robot != teammate) {
    ++misaddressed_;
    return;
  }
  newest_[teammate] = {name_of(bus::belief_channel(teammate).name, belief->stamp), belief};
}

StepMaterial EstimatorNode::gather(Time t) {
  StepMaterial material;
  std::deque<NamedMessage<models::RobotMeasurement>> later;
  for (auto& look : measurements_) {
    if (look.content->stamp.time <= t) {
      material.measurements.push_back(std::move(look));
    } else {
      later.push_back(std::move(look));
    }
  }
  measurements_ = std::move(later);
  if (!has_viewpoint(material.measurements, robot_, t, step_)) {
    for (const auto& pose : poses_) {
      if (pose.content->time <= t && pose.content->time > t - step_) {
        material.pose = pose;
      }
    }
    viewpoint_unknown_ += material.pose ? 0 : 1;
  }
  for (const auto& [teammate, belief] : newest_) {
    material.beliefs.push_back(belief);
  }
  return material;
}

Time EstimatorNode::next_tick() const {
  const Time soonest = next_instant_ + lag_;
  const Time latest = next_instant_ + lag_max_;
  const Duration since_measurement = next_instant_ - last_own_measurement_;
  if (since_measurement >= 2 * step_) {
    return soonest;  // no observation of the last instant arrived: do not wait
  }
  const bool is_awaited = since_measurement >= step_;
  return is_awaited ? latest
                    : std::clamp(last_own_measurement_received_ + step_ / 100, soonest, latest);
}

void EstimatorNode::tick(Time now) {
  if (now < next_tick()) {
    return;
  }
  const Time t = instant_before(now - lag_, step_);
  instants_missed_ += (t - next_instant_) / step_;
  next_instant_ = t + step_;
  const StepMaterial material = gather(t);
  models::RobotBelief made = make_step(filter_, t, steps_++, material);
  if (belief_override_) {
    made.targets = belief_override_(t, material.measurements);
  } else if (const auto mixture = mixture_of(filter_, made)) {
    bus_.publish(bus::mixture_channel(robot_), *mixture);
  }
  made = bus_.publish(bus::belief_channel(robot_), std::move(made));
  if (map_) {
    map_->step(made);
  }

  // Counts a stale belief once, then drops it, so that a silent teammate's last message is not
  // kept.
  const Duration age_max = from_seconds(filter_.spec().belief_age_max_s);
  std::erase_if(newest_,
                [&](const auto& entry) { return t - entry.second.content->stamp.time > age_max; });
}

std::vector<models::NamedCount> EstimatorNode::counters() const {
  std::vector<models::NamedCount> all = filter_.counters().named();
  models::append_nonzero(all, {{"looks_overflowed", looks_overflowed_},
                               {"misaddressed", misaddressed_},
                               {"viewpoint_unknown", viewpoint_unknown_}});
  if (map_) {
    const std::vector<models::NamedCount> of_map = map_->counters();
    all.insert(all.end(), of_map.begin(), of_map.end());
  }
  return all;
}

}  // namespace vantage::estimator
