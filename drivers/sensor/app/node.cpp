#include "drivers/sensor/app/node.hpp"

#include <algorithm>
#include <utility>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "drivers/sensor/pose_noise.hpp"
#include "models/exchange/counts.hpp"
#include "scenario/reader/localizer_yaml.hpp"

namespace vantage::drivers {
namespace {

// Maximum gap between two frames for interpolation.
constexpr Duration kGapMax{200'000};
constexpr Duration kIdle = std::chrono::seconds(1);
// Interval over which the velocity of a target is computed. A shorter one would amplify the noise
// of motion capture: 1 mm per frame is 14 mm/s over 0.1 s, but 140 mm/s over 10 ms.
constexpr Duration kVelocityBase{100'000};
constexpr Duration kVelocityBaseMax{300'000};
constexpr std::size_t kTruthFramesKept = 20;

}  // namespace

SensorNode::SensorNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                       const std::string& robot, MeasureFunction measure)
    : bus_(bus),
      clock_(clock),
      robot_(robot),
      measure_(std::move(measure)),
      position_dim_(scenario.estimator.target_model.position_dim),
      step_(from_seconds(scenario.planner.step_s)),
      next_tick_(clock.now() + kIdle) {
  require(step_ > Duration{0}, "planner: step_s must be positive");
  const scenario::RobotSpec* const spec = scenario.find_robot(robot);
  require(spec != nullptr, "robot " + robot + " is not in the scenario");
  sensor_ = spec->sensor;
  if (!measure_) {
    PoseSensor pose_sensor(scenario, robot);
    keeps_recent_ = pose_sensor.measures_velocity();
    measure_ = [this, sensor = std::move(pose_sensor)](const models::MocapFrame& frame,
                                                       bool jammed) {
      return sensor.measure(frame, jammed, earlier_frame(frame.stamp.time));
    };
  }
  if (scenario.planner.objective == scenario::PlanObjective::kMapping) {
    scanner_.emplace(scenario, robot);
  }
  const auto localizer = scenario::localizer_of(scenario);
  if (localizer && localizer->simulation && scenario::index_of(*localizer, robot) >= 0) {
    bus_.subscribe<models::TruthFrame>(
        bus::kTruth, [this](const models::TruthFrame& truth) { on_truth(truth); });
    bus_.subscribe<models::PoseEstimate>(
        bus::pose_channel(robot),
        [this](const models::PoseEstimate& estimate) { on_pose(estimate); });
  } else {
    bus_.subscribe_shared<models::MocapFrame>(
        bus::kVicon, [this](const auto& /*name*/, const auto& frame) { on_frame(frame); });
  }
  bus_.subscribe<models::AttackNotice>(bus::kAttack, [this](const models::AttackNotice& attack) {
    jam_watch_.on_notice(attack, clock_.now());
  });
}

void SensorNode::tick(Time now) { next_tick_ = now + kIdle; }

void SensorNode::on_frame(const std::shared_ptr<const models::MocapFrame>& received) {
  const auto shared = mocap_clock_.on_our_clock(received, clock_.now());
  const models::MocapFrame& frame = *shared;
  if (last_ && frame.stamp.run_id != last_->stamp.run_id) {
    ++mocap_restarts_;
    last_.reset();
    recent_.clear();
  }
  if (last_ && frame.stamp.time <= last_->stamp.time) {
    ++frames_out_of_order_;
    return;
  }
  // Computes the newest kτ up to this frame, and the number of instants kτ since the last frame.
  const std::int64_t step_us = step_.count();
  const std::int64_t newest = to_utime(frame.stamp.time) / step_us;
  const Time instant = from_utime(newest * step_us);
  const std::int64_t passed = last_ ? newest - to_utime(last_->stamp.time) / step_us : 0;
  const models::InputRef this_ref = models::ref_to(bus::kVicon.name, frame.stamp);
  if (instant == frame.stamp.time) {
    publish(frame, {this_ref});
    steps_without_frames_ += std::max<std::int64_t>(0, passed - 1);
  } else if (passed > 0 && frame.stamp.time - last_->stamp.time <= kGapMax) {
    publish(interpolate(*last_, frame, instant),
            {models::ref_to(bus::kVicon.name, last_->stamp), this_ref});
    steps_without_frames_ += passed - 1;
  } else {
    steps_without_frames_ += passed;
  }
  last_ = shared;
  if (keeps_recent_) {
    keep(shared);
  }
}

void SensorNode::on_truth(const models::TruthFrame& truth) {
  if (!truth_.empty() && truth.stamp.time <= truth_.back()->stamp.time) {
    ++frames_out_of_order_;
    return;
  }
  auto frame = std::make_shared<models::MocapFrame>();
  frame->stamp = truth.stamp;
  frame->bodies.reserve(truth.bodies.size());
  for (const models::TruthBody& body : truth.bodies) {
    frame->bodies.push_back({body.name, body.world_from_body});
  }
  if (truth_.size() == kTruthFramesKept) {
    truth_.pop_front();
  }
  truth_.push_back(frame);
  if (keeps_recent_) {
    keep(truth_.back());
  }
}

void SensorNode::on_pose(const models::PoseEstimate& estimate) {
  if (estimate.robot != robot_) {
    ++misaddressed_;
    return;
  }
  const Time t = estimate.stamp.time;
  if (to_utime(t) % step_.count() != 0) {
    return;
  }
  if (estimate.source == models::PoseSource::kNone) {
    ++steps_without_own_pose_;
    return;
  }
  const auto frame = std::find_if(truth_.begin(), truth_.end(),
                                  [t](const auto& each) { return each->stamp.time == t; });
  if (frame == truth_.end()) {
    ++steps_without_frames_;
    return;
  }
  publish(**frame,
          {models::ref_to(bus::kTruth.name, (*frame)->stamp),
           models::ref_to(bus::pose_channel(robot_).name, estimate.stamp)},
          &estimate);
}

void SensorNode::keep(const std::shared_ptr<const models::MocapFrame>& frame) {
  recent_.push_back(frame);
  // All later instants are after this frame minus one step. Keeps the newest frame that is old
  // enough for all of them, and all newer frames.
  while (recent_.size() > 1 && recent_[1]->stamp.time + kVelocityBaseMax < frame->stamp.time) {
    recent_.pop_front();
  }
}

const models::MocapFrame* SensorNode::earlier_frame(Time time) const {
  const models::MocapFrame* found = nullptr;
  for (const auto& each : recent_) {
    const Duration age = time - each->stamp.time;
    if (age >= kVelocityBase && age <= kVelocityBaseMax) {
      found = each.get();
    }
  }
  return found;
}

void SensorNode::publish(const models::MocapFrame& frame, std::vector<models::InputRef> inputs,
                         const models::PoseEstimate* assumed) {
  const models::AttackNotice* const attack = jam_watch_.notice_for(robot_, clock_.now());
  const bool jammed = attack != nullptr;
  std::optional<models::RobotMeasurement> seen = measure_(frame, jammed);
  if (!seen) {
    ++steps_without_own_pose_;
    return;
  }
  if (assumed != nullptr) {
    assume_pose(sensor_, position_dim_, *assumed, *seen);
  }
  if (const models::MocapFrame* const earlier = earlier_frame(frame.stamp.time)) {
    const std::string& channel = assumed != nullptr ? bus::kTruth.name : bus::kVicon.name;
    inputs.push_back(models::ref_to(channel, earlier->stamp));
  }
  if (jammed) {
    inputs.push_back(models::ref_to(bus::kAttack.name, attack->stamp));
  }
  if (scanner_) {
    models::RangeScan scan = scanner_->scan(seen->stamp.time, seen->viewpoint, jammed);
    scan.inputs = inputs;
    bus_.publish(bus::scan_channel(robot_), std::move(scan));
  }
  seen->inputs = std::move(inputs);
  bus_.publish(bus::measurement_channel(robot_), std::move(*seen));
}

std::vector<models::NamedCount> SensorNode::counters() const {
  return models::nonzero({{"sensor.steps_without_frames", steps_without_frames_},
                          {"sensor.steps_without_own_pose", steps_without_own_pose_},
                          {"sensor.frames_out_of_order", frames_out_of_order_},
                          {"sensor.mocap_restarts", mocap_restarts_},
                          {"sensor.misaddressed", misaddressed_}});
}

}  // namespace vantage::drivers
