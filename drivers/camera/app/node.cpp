#include "drivers/camera/app/node.hpp"

#include <cstdio>
#include <utility>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "core/utf8.hpp"
#include "drivers/sensor/pose_sensor.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kPoll{5'000};

const scenario::RobotSpec& robot_of(const scenario::Scenario& scenario, const std::string& robot) {
  const scenario::RobotSpec* const found = scenario.find_robot(robot);
  require(found != nullptr, "robot " + robot + " is not in the scenario");
  return *found;
}

}  // namespace

CameraNode::CameraNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                       const scenario::CameraSpec& spec, const models::CameraModel& camera,
                       std::unique_ptr<camera::TagDetector> detector,
                       std::unique_ptr<camera::ImageSource> source)
    : bus_(bus),
      clock_(clock),
      robot_(spec.robot),
      period_(from_seconds(spec.rate_hz > 0.0 ? 1.0 / spec.rate_hz : scenario.planner.step_s)),
      observer_(spec, camera, robot_of(scenario, spec.robot).sensor,
                scenario.estimator.target_model.position_dim),
      detector_(std::move(detector)),
      source_(std::move(source)),
      next_tick_(clock.now() + kPoll) {
  require(period_ > Duration{0}, "camera: rate_hz must be at most 1000");
  bus_.subscribe_shared<models::MocapFrame>(
      bus::kVicon, [this](const auto& /*name*/, const auto& frame) { on_frame(frame); });
  bus_.subscribe<models::AttackNotice>(bus::kAttack, [this](const models::AttackNotice& attack) {
    jam_watch_.on_notice(attack, clock_.now());
  });
}

void CameraNode::on_frame(const std::shared_ptr<const models::MocapFrame>& received) {
  frames_.add(mocap_clock_.on_our_clock(received, clock_.now()));
  work(clock_.now());
}

void CameraNode::tick(Time now) {
  next_tick_ = now + kPoll;
  work(now);
}

void CameraNode::work(Time now) {
  while (const std::optional<camera::CapturedImage> captured = source_->next(now)) {
    process(*captured, now);
  }
  if (clock_.is_real_time() && source_->status() != status_) {
    status_ = source_->status();
    std::fprintf(stderr, "vantage-camera: %s: %s\n", robot_.c_str(), printable(status_).c_str());
  }
  while (!waiting_.empty()) {
    const Waiting& first = waiting_.front();
    if (!frames_.reaches(first.time) && now - first.time <= kAgeMax) {
      return;
    }
    const Waiting seen = std::move(waiting_.front());
    waiting_.pop_front();
    publish(seen, now);
  }
}

void CameraNode::process(const camera::CapturedImage& captured, Time now) {
  ++images_;
  if (captured.image.width != observer_.camera().width ||
      captured.image.height != observer_.camera().height) {
    ++wrong_size_;
    return;
  }
  const Duration age = now - captured.time;
  if (age > kAgeMax || age < -kEarlyMax) {
    ++(age > kAgeMax ? late_ : early_);
    return;
  }
  if (last_image_ && captured.time <= *last_image_) {
    ++out_of_order_;
    return;
  }
  last_image_ = captured.time;
  const std::int64_t period = to_utime(captured.time + period_ / 10) / period_.count();
  if (period == last_period_) {
    return;
  }
  last_period_ = period;
  if (waiting_.size() == kWaitingMax) {
    waiting_.pop_front();
    ++overflowed_;
  }
  waiting_.push_back({captured.time, observer_.observe(detector_->detect(captured.image))});
  processing_.add(clock_.now() - now);
}

void CameraNode::publish(const Waiting& seen, Time now) {
  std::optional<FrameHistory::Found> found = frames_.at(seen.time);
  const models::AttackNotice* const attack = jam_watch_.notice_for(robot_, now);
  std::optional<models::RobotMeasurement> out =
      found ? empty_measurement(found->frame, robot_, attack != nullptr) : std::nullopt;
  if (!out) {
    ++without_pose_;
    return;
  }
  out->inputs = std::move(found->inputs);
  if (attack != nullptr) {
    out->inputs.push_back(models::ref_to(bus::kAttack.name, attack->stamp));
  } else {
    observer_.add_targets(seen.tags, found->frame.find(robot_)->world_from_body, *out);
  }
  bus_.publish(bus::measurement_channel(robot_), std::move(*out));
}

std::vector<models::NamedCount> CameraNode::counters() const {
  const camera::TagCounts& tags = observer_.counts();
  const camera::SourceCounts source = source_->counts();
  std::vector<models::NamedCount> out =
      models::nonzero({{"camera.images_late", late_},
                       {"camera.images_early", early_},
                       {"camera.images_out_of_order", out_of_order_},
                       {"camera.images_of_wrong_size", wrong_size_},
                       {"camera.images_undecodable", source.undecodable},
                       {"camera.images_unstamped", source.unstamped},
                       {"camera.images_lost", source.lost},
                       {"camera.images_overflowed", overflowed_},
                       {"camera.images_without_pose", without_pose_},
                       {"camera.interruptions", source.interruptions},
                       {"camera.tags_unknown", tags.unknown},
                       {"camera.tags_misread", tags.misread},
                       {"camera.tags_duplicate", tags.duplicate},
                       {"camera.tags_at_border", tags.at_border},
                       {"camera.tags_bad_fit", tags.bad_fit},
                       {"camera.tags_ambiguous", tags.ambiguous},
                       {"camera.tags_out_of_view", tags.out_of_view}});
  if (clock_.is_real_time()) {
    models::append_latency(out, "camera.processing", processing_);
  }
  return out;
}

}  // namespace vantage::drivers
