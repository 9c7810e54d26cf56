#include "drivers/sensor/pose_sensor.hpp"

#include <algorithm>
#include <cstddef>
#include <random>
#include <utility>

#include "core/check.hpp"

namespace vantage::drivers {
namespace {

const scenario::RobotSpec& robot_of(const scenario::Scenario& scenario, const std::string& robot) {
  const scenario::RobotSpec* spec = scenario.find_robot(robot);
  require(spec != nullptr, "robot " + robot + " is not in the scenario");
  return *spec;
}

std::uint32_t low_word(std::uint64_t bits) { return static_cast<std::uint32_t>(bits); }
std::uint32_t high_word(std::uint64_t bits) { return static_cast<std::uint32_t>(bits >> 32U); }

}  // namespace

std::mt19937_64 noise_of(std::uint64_t seed, const std::string& robot, int stream, Time time) {
  const auto utime = static_cast<std::uint64_t>(to_utime(time));
  std::vector<std::uint32_t> words{low_word(seed), high_word(seed), low_word(utime),
                                   high_word(utime), static_cast<std::uint32_t>(stream)};
  for (const char letter : robot) {
    words.push_back(static_cast<unsigned char>(letter));
  }
  std::seed_seq sequence(words.begin(), words.end());
  return std::mt19937_64(sequence);
}

models::MocapFrame interpolate(const models::MocapFrame& before, const models::MocapFrame& after,
                               Time time) {
  const Duration gap = after.stamp.time - before.stamp.time;
  const double share =
      gap > Duration{0} ? to_seconds(time - before.stamp.time) / to_seconds(gap) : 0.0;
  models::MocapFrame between = after;
  between.stamp.time = time;
  for (std::size_t i = 0; i < between.bodies.size(); ++i) {
    models::MocapBody& body = between.bodies[i];
    const models::MocapBody* const old = before.find(body.name, i);
    if (old == nullptr || old->occluded) {
      body.occluded = true;
    }
    if (body.occluded) {
      continue;
    }
    const Pose3 from = old->world_from_body;
    body.world_from_body.translation_m =
        from.translation_m + share * (body.world_from_body.translation_m - from.translation_m);
    body.world_from_body.rotation = from.rotation.slerp(share, body.world_from_body.rotation);
  }
  return between;
}

PoseSensor::PoseSensor(const scenario::Scenario& scenario, const std::string& robot)
    : robot_(robot),
      sensor_(robot_of(scenario, robot).sensor),
      detection_(robot_of(scenario, robot).detection),
      world_(scenario.world),
      targets_(scenario.targets),
      position_dim_(scenario.estimator.target_model.position_dim),
      seed_(scenario.seed) {}

std::optional<Eigen::Vector2d> velocity_since(const models::MocapFrame& earlier,
                                              const models::MocapFrame& frame,
                                              const std::string& name,
                                              const Eigen::Vector2d& position_m) {
  const models::MocapBody* const body = earlier.find(name);
  const double passed_s = to_seconds(frame.stamp.time - earlier.stamp.time);
  if (body == nullptr || body->occluded || !(passed_s > 0.0)) {
    return std::nullopt;
  }
  return (position_m - body->world_from_body.translation_m.head<2>()) / passed_s;
}

std::optional<models::RobotMeasurement> empty_measurement(const models::MocapFrame& frame,
                                                          const std::string& robot, bool jammed) {
  const models::MocapBody* const self = frame.find(robot);
  if (self == nullptr || self->occluded) {
    return std::nullopt;
  }
  models::RobotMeasurement seen;
  seen.stamp.time = frame.stamp.time;
  seen.robot = robot;
  seen.viewpoint = {flatten(self->world_from_body), self->world_from_body.translation_m.z()};
  seen.jammed = jammed;
  return seen;
}

std::optional<models::RobotMeasurement> PoseSensor::measure(
    const models::MocapFrame& frame, bool jammed, const models::MocapFrame* earlier) const {
  std::optional<models::RobotMeasurement> seen = empty_measurement(frame, robot_, jammed);
  if (!seen || jammed) {
    return seen;
  }
  std::size_t next = 0;  // bodies have the scenario's order: continue at the next body
  for (const scenario::TargetSpec& target : targets_) {
    const models::MocapBody* const body = frame.find(target.name, next);
    next = body == nullptr ? next : static_cast<std::size_t>(body - frame.bodies.data()) + 1;
    if (body == nullptr || body->occluded) {
      continue;
    }
    const models::PositionVector position_m =
        body->world_from_body.translation_m.head(position_dim_);
    if (!models::in_view(sensor_, seen->viewpoint, position_m) ||
        !models::line_of_sight(world_, seen->viewpoint.world_from_body.position_m(),
                               position_m.head<2>())) {
      continue;
    }
    Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
    if (measures_velocity()) {
      const auto since = earlier == nullptr
                             ? std::nullopt
                             : velocity_since(*earlier, frame, target.name, position_m.head<2>());
      if (!since) {
        continue;
      }
      velocity_mps = *since;
    }
    std::mt19937_64 noise = noise_of(seed_, robot_, target.id, frame.stamp.time);
    const models::Measurement z =
        models::sample(sensor_, seen->viewpoint, position_m, noise, velocity_mps);
    if (std::uniform_real_distribution<double>()(noise) < detection_.detection_probability) {
      seen->detections.push_back({target.id, z});
    }
  }
  if (!detection_.detects_ids) {
    anonymize(*seen);
  }
  return seen;
}

void PoseSensor::anonymize(models::RobotMeasurement& seen) const {
  std::mt19937_64 noise = noise_of(seed_, robot_, kClutterStream, seen.stamp.time);
  for (const models::Measurement& z :
       models::sample_clutter(sensor_, seen.viewpoint, detection_.clutter_per_look, noise)) {
    seen.detections.push_back({models::kNoTargetId, z});
  }
  for (models::Detection& detection : seen.detections) {
    detection.target_id = models::kNoTargetId;
  }
  std::sort(seen.detections.begin(), seen.detections.end(), [](const auto& a, const auto& b) {
    const models::MeasurementVector& first = a.measurement.z;
    const models::MeasurementVector& second = b.measurement.z;
    return std::lexicographical_compare(first.begin(), first.end(), second.begin(), second.end());
  });
}

}  // namespace vantage::drivers
