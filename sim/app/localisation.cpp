#include "sim/app/localisation.hpp"

#include <algorithm>

#include "bus/convert/channels.hpp"
#include "core/index.hpp"

namespace vantage::sim {
namespace {

/// Returns 1/rate, rounded down to whole steps of the world, but at least one step.
Duration period_of(double rate_hz) {
  const std::int64_t step_us = WorldSimulation::kStep.count();
  const std::int64_t steps = from_seconds(1.0 / rate_hz).count() / step_us;
  return Duration{std::max<std::int64_t>(steps, 1) * step_us};
}

Time next_multiple(Time time, Duration period) {
  return from_utime((to_utime(time) / period.count() + 1) * period.count());
}

}  // namespace

SimulatedLocalisation::SimulatedLocalisation(bus::Bus& bus, const scenario::Scenario& scenario,
                                             const scenario::LocalizerSpec& spec, Time start)
    : bus_(bus),
      outage_(spec.simulation->mocap_withheld, scenario.robots, start),
      odometry_period_(period_of(spec.simulation->odometry.rate_hz)),
      sightings_period_(period_of(spec.simulation->sightings.rate_hz)),
      next_odometry_(next_multiple(start, odometry_period_)),
      // Sightings are offset by one odometry period, to lie between the localizers' time steps.
      next_sightings_(next_multiple(start, sightings_period_) + odometry_period_) {
  robots_.reserve(spec.robots.size());
  for (std::size_t i = 0; i < spec.robots.size(); ++i) {
    const std::string& name = spec.robots[i].name;
    robots_.push_back(
        {name, Odometer(spec.simulation->odometry, spec.odometry_noise, name, scenario.seed),
         LandmarkSensor(spec, static_cast<int>(i), scenario.world, scenario.seed),
         models::OnboardPose(scenario.find_robot(name)->start, start), std::nullopt});
    bus_.subscribe<models::PoseEstimate>(bus::pose_channel(name),
                                         [this, i](const models::PoseEstimate& estimate) {
                                           if (estimate.robot != robots_[i].name) {
                                             ++misaddressed_;
                                             return;
                                           }
                                           robots_[i].assumed.correct(estimate);
                                         });
  }
}

Time SimulatedLocalisation::next_instant() const {
  return std::min(next_odometry_, next_sightings_);
}

void SimulatedLocalisation::publish(Time instant, WorldSimulation& world) {
  if (instant != next_odometry_ && instant != next_sightings_) {
    return;
  }
  const models::TruthFrame truth = world.truth();
  outage_.update(truth);
  if (instant == next_odometry_) {
    publish_odometry(instant, truth, world);
    next_odometry_ += odometry_period_;
  }
  if (instant == next_sightings_) {
    for (Robot& robot : robots_) {
      models::SightingReport report;
      report.stamp.time = instant;
      report.robot = robot.name;
      report.sightings = robot.sensor.look(truth);
      bus_.publish(bus::sightings_channel(robot.name), std::move(report));
    }
    next_sightings_ += sightings_period_;
  }
}

void SimulatedLocalisation::publish_odometry(Time instant, const models::TruthFrame& truth,
                                             WorldSimulation& world) {
  for (Robot& robot : robots_) {
    const auto body = std::find_if(truth.bodies.begin(), truth.bodies.end(),
                                   [&](const auto& each) { return each.name == robot.name; });
    if (body == truth.bodies.end()) {
      continue;  // a real robot has its own odometer
    }
    const Pose2 pose = flatten(body->world_from_body);
    if (robot.last) {
      const double period_s = to_seconds(odometry_period_);
      models::OdometryReport report;
      report.stamp.time = instant;
      report.robot = robot.name;
      report.interval = odometry_period_;
      report.motion_body = robot.odometer.report(inverse(*robot.last) * pose, period_s);
      report.covariance = robot.odometer.covariance(report.motion_body, period_s);
      robot.assumed.move(instant, report.motion_body);
      bus_.publish(bus::odometry_channel(robot.name), std::move(report));
    }
    robot.last = pose;
    std::optional<Pose2> assumed_from_true;
    if (outage_.hides(pose.position_m(), instant)) {
      assumed_from_true = robot.assumed.world_from_body() * inverse(pose);
    }
    world.fly_by(robot.name, assumed_from_true);
  }
}

void SimulatedLocalisation::hide(models::MocapFrame& frame, const models::TruthFrame& truth) {
  outage_.update(truth);
  outage_.hide(frame, truth);
}

}  // namespace vantage::sim
