#include "estimator/app/node.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "bus/convert/channels.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::estimator {

namespace {

constexpr std::size_t kMeasurementsWaitingPerRobot = 64;
constexpr std::size_t kPosesKept = 256;
constexpr std::size_t kPartialBeliefsPerRobot = 8;
/// Maximum number of cells by which a teammate's grid may exceed this robot's grid. With a
/// neighbourhood, the grids of robots differ in size.
constexpr int kGridCellsMore = 10'000;

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
  if (scenario.network.budget_kbitps > 0.0 && filter_.spec().communication_range_m > 0.0) {
    sender_.emplace(filter_.spec());
  }
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
        bus_.unsubscribe(bus::compact_belief_channel(teammate).name);
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
  if (sender_) {
    bus_.subscribe<models::CompactBelief>(
        bus::compact_belief_channel(teammate),
        [this, teammate](const auto& m) { on_compact_belief(teammate, m); });
    return;
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

void EstimatorNode::on_compact_belief(const std::string& teammate,
                                      const models::CompactBelief& belief) {
  if (belief.robot != teammate) {
    ++misaddressed_;
    return;
  }
  // A short message can announce a large grid, so the size is checked before the memory is used.
  if (belief.grid.size() > filter_.grid().geometry().size() + kGridCellsMore) {
    ++grids_too_large_;
    return;
  }
  auto parts = models::expand(belief);
  if (!parts) {
    return;  // from_wire() has refused and counted such a message
  }
  if (partial_.size() ==
      kPartialBeliefsPerRobot * std::max<std::size_t>(1, filter_.spec().team.size())) {
    partial_.erase(partial_.begin());
    ++beliefs_overflowed_;
  }
  partial_.push_back({name_of(bus::compact_belief_channel(teammate).name, belief.stamp),
                      std::make_shared<const models::RobotBelief>(std::move(*parts))});
}

void EstimatorNode::send_compact_belief(const models::RobotBelief& own,
                                        const StepMaterial& material) {
  const double range_m = filter_.spec().communication_range_m;
  const auto is_in_range = [&](const models::Viewpoint& theirs) {
    return distance_m(theirs, own.viewpoint) <= range_m;
  };
  for (const auto& belief : material.beliefs) {
    if (is_in_range(belief.content->viewpoint)) {
      sender_->receive(*belief.content);
    }
  }
  std::vector<int> observed;
  for (const auto& look : material.measurements) {
    if (look.content->robot == robot_ || is_in_range(look.content->viewpoint)) {
      for (const models::Detection& detection : look.content->detections) {
        observed.push_back(detection.target_id);
      }
    }
  }
  const auto channel = bus::compact_belief_channel(robot_);
  if (auto parts = sender_->select(own, observed, bus_.air_left(channel.name))) {
    bus_.publish(channel, std::move(*parts));
  }
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
  const auto later_beliefs =
      std::stable_partition(partial_.begin(), partial_.end(),
                            [&](const auto& each) { return each.content->stamp.time <= t; });
  material.beliefs.insert(material.beliefs.end(), std::make_move_iterator(partial_.begin()),
                          std::make_move_iterator(later_beliefs));
  partial_.erase(partial_.begin(), later_beliefs);
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
  if (sender_) {
    send_compact_belief(made, material);
  }
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
                               {"viewpoint_unknown", viewpoint_unknown_},
                               {"beliefs_overflowed", beliefs_overflowed_},
                               {"grids_too_large", grids_too_large_},
                               {"beliefs_unsendable", sender_ ? sender_->unsendable() : 0}});
  if (map_) {
    const std::vector<models::NamedCount> of_map = map_->counters();
    all.insert(all.end(), of_map.begin(), of_map.end());
  }
  return all;
}

}  // namespace vantage::estimator
