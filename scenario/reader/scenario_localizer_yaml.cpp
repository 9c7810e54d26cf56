#include <algorithm>

#include <fmt/format.h>

#include "core/time.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "scenario/reader/scenario_agents_yaml.hpp"
#include "scenario/reader/scenario_sections_yaml.hpp"

namespace vantage::scenario {
namespace {

constexpr std::size_t kLandmarksMax = 1000;
constexpr std::size_t kLocalizedRobotsMax = 50;
constexpr int kUnknownLandmarksMax = 200;
constexpr int kIdMax = 1'000'000;
constexpr std::int64_t kPosePeriodUs = 100'000;
constexpr std::size_t kOutagesMax = 1000;
constexpr double kOutageTimeMaxS = 1e6;

void read_sightings(Mapping& from, SightingSpec& sightings) {
  from.flag("range_is_depth", sightings.range_is_depth);
  from.number("range_scale", sightings.range_scale, from_to(0.1, 10.0));
  from.number("range_offset_m", sightings.range_offset_m, from_to(-10.0, 10.0));
  from.angle("axis", sightings.axis_rad, from_to(-180.0, 180.0));
  from.angle("bearing_offset", sightings.bearing_offset_rad, from_to(-180.0, 180.0));
  from.number("forward_m", sightings.forward_m, from_to(-10.0, 10.0));
  from.number("stamp_delay_s", sightings.stamp_delay_s, from_to(0.0, 0.2));
}

void read_drive(Mapping& from, DriveSpec& drive) {
  from.number("delay_s", drive.delay_s, from_to(0.0, 2.0));
  from.number("lag_s", drive.lag_s, from_to(0.0, 10.0));
  from.number("speed_scale", drive.speed_scale, from_to(0.1, 10.0));
  from.number("turn_scale", drive.turn_scale, from_to(0.1, 10.0));
  from.number("turn_bias_radps", drive.turn_bias_radps, from_to(-1.0, 1.0));
}

void read_odometry_noise(Mapping& from, OdometryNoiseSpec& noise) {
  from.number("turn_sigma_rad_per_sqrt_s", noise.turn_sigma_rad_per_sqrt_s, at_least(0.0));
  from.number("turn_sigma_per_sqrt_rad", noise.turn_sigma_per_sqrt_rad, at_least(0.0));
  from.number("slide_sigma_per_sqrt_m", noise.slide_sigma_per_sqrt_m, at_least(0.0));
  from.number("turn_drift_radps", noise.turn_drift_radps, at_least(0.0));
  from.number("turn_drift_time_s", noise.turn_drift_time_s, above(0.0));
  from.number("speed_drift_share", noise.speed_drift_share, at_least(0.0));
  from.number("speed_drift_time_s", noise.speed_drift_time_s, above(0.0));
}

void read_sighting_noise(Mapping& from, SightingNoiseSpec& noise) {
  from.number("range_sigma_m", noise.range_sigma_m, above(0.0));
  from.number("range_sigma_per_m", noise.range_sigma_per_m, at_least(0.0));
  from.number("bearing_sigma_rad", noise.bearing_sigma_rad, above(0.0));
  from.number("across_sigma_m", noise.across_sigma_m, at_least(0.0));
  from.number("frame_bearing_sigma_rad", noise.frame_bearing_sigma_rad, at_least(0.0));
  from.number("teammate_sigma_m", noise.teammate_sigma_m, at_least(0.0));
}

/// Refuses an id that another landmark or robot has.
void check_id(Mapping& from, const LocalizerSpec& spec, int id) {
  const auto has_id = [&](const auto& each) { return each.id == id; };
  if (std::any_of(spec.landmarks.begin(), spec.landmarks.end(), has_id) ||
      std::any_of(spec.robots.begin(), spec.robots.end(), has_id)) {
    from.refuse("id",
                fmt::format("must be unique among landmarks and robots; {} is already used", id));
  }
}

void read_landmarks(Mapping& from, LocalizerSpec& spec) {
  const std::optional<Value> landmarks = from.find("landmarks");
  if (!landmarks) {
    return;
  }
  for (const Value& item : landmarks->items()) {
    if (spec.landmarks.size() == kLandmarksMax) {
      item.refuse(fmt::format("too many landmarks; at most {} are allowed", kLandmarksMax));
    }
    read_mapping({item}, [&](Mapping& one) {
      LandmarkSpec landmark;
      for (const char* key : {"id", "x_m", "y_m"}) {
        one.require(key);
      }
      one.integer("id", landmark.id, 0, kIdMax);
      one.number("x_m", landmark.position_m.x(), from_to(-kLengthMaxM, kLengthMaxM));
      one.number("y_m", landmark.position_m.y(), from_to(-kLengthMaxM, kLengthMaxM));
      check_id(one, spec, landmark.id);
      spec.landmarks.push_back(landmark);
    });
  }
}

void read_localized_robots(Mapping& from, const Scenario& scenario, LocalizerSpec& spec) {
  const std::optional<Value> robots = from.find_required("robots");
  if (!robots) {
    return;
  }
  for (const Value& item : robots->items()) {
    if (spec.robots.size() == kLocalizedRobotsMax) {
      item.refuse(fmt::format("too many robots; at most {} are allowed", kLocalizedRobotsMax));
    }
    read_mapping({item}, [&](Mapping& one) {
      LocalizedRobotSpec robot;
      one.require("name");
      one.require("id");
      one.text("name", robot.name);
      one.integer("id", robot.id, 0, kIdMax);
      one.section("sightings", [&](Mapping& each) { read_sightings(each, robot.sightings); });
      one.section("drive", [&](Mapping& each) { read_drive(each, robot.drive); });
      if (scenario.find_robot(robot.name) == nullptr) {
        one.refuse("name", "must be the name of one of the scenario's robots, is " + robot.name);
      }
      const auto has_name = [&](const auto& each) { return each.name == robot.name; };
      if (std::any_of(spec.robots.begin(), spec.robots.end(), has_name)) {
        one.refuse("name", "must be unique; an earlier entry is called " + robot.name);
      }
      check_id(one, spec, robot.id);
      spec.robots.push_back(robot);
    });
  }
}

void read_pose_safety(Mapping& from, PoseSafetySpec& safety) {
  from.flag("rovers_may_drive", safety.rovers_may_drive);
  from.number("sigma_hold_m", safety.sigma_hold_m, above_to(0.0, 10.0));
  from.number("sigma_stop_m", safety.sigma_stop_m, above_to(0.0, 10.0));
  from.number("margin_sigmas", safety.margin_sigmas, from_to(0.0, 10.0));
  if (!(safety.sigma_stop_m > safety.sigma_hold_m)) {
    from.refuse("sigma_stop_m", fmt::format("must be above sigma_hold_m ({}), but is {}",
                                            safety.sigma_hold_m, safety.sigma_stop_m));
  }
}

void read_odometer(Mapping& from, SimulatedOdometerSpec& odometer) {
  from.number("rate_hz", odometer.rate_hz, from_to(1.0, 200.0));
  from.number("noise_scale", odometer.noise_scale, from_to(0.0, 100.0));
  from.number("speed_scale", odometer.speed_scale, from_to(0.1, 10.0));
  from.number("turn_scale", odometer.turn_scale, from_to(0.1, 10.0));
  from.number("turn_bias_radps", odometer.turn_bias_radps, from_to(-1.0, 1.0));
  from.number("slips_per_min", odometer.slips_per_min, from_to(0.0, 600.0));
  from.number("slip_s", odometer.slip_s, above_to(0.0, 60.0));
  from.number("slip_share", odometer.slip_share, from_to(-1.0, 10.0));
}

void read_simulated_sightings(Mapping& from, SimulatedSightingsSpec& sightings) {
  from.number("rate_hz", sightings.rate_hz, above_to(0.0, 100.0));
  from.number("noise_scale", sightings.noise_scale, from_to(0.0, 100.0));
  from.number("range_min_m", sightings.range_min_m, from_to(0.01, kLengthMaxM));
  from.number("range_max_m", sightings.range_max_m, from_to(0.01, kLengthMaxM));
  from.angle("fov", sightings.fov_rad, above_to(0.0, 360.0));
  from.number("detection_probability", sightings.detection_probability, from_to(0.0, 1.0));
}

void read_outage(Mapping& from, MocapOutageSpec& outage) {
  from.flag("after_take_off", outage.after_take_off);
  from.number("from_s", outage.from_s, from_to(0.0, kOutageTimeMaxS));
  from.number("to_s", outage.to_s, above_to(0.0, kOutageTimeMaxS));
  if (!(outage.to_s > outage.from_s)) {
    from.refuse("to_s",
                fmt::format("must be above from_s ({}), but is {}", outage.from_s, outage.to_s));
  }
  from.section("area", [&](Mapping& area) { read_rectangle(area, outage.area.emplace()); });
}

void read_simulation(Mapping& from, LocalizerSimulationSpec& simulation) {
  from.section("odometry", [&](Mapping& each) { read_odometer(each, simulation.odometry); });
  from.section("sightings",
               [&](Mapping& each) { read_simulated_sightings(each, simulation.sightings); });
  const std::optional<Value> outages = from.find("mocap_withheld");
  if (!outages) {
    return;
  }
  for (const Value& item : outages->items()) {
    if (simulation.mocap_withheld.size() == kOutagesMax) {
      item.refuse(fmt::format("too many entries; at most {} are allowed", kOutagesMax));
    }
    MocapOutageSpec outage;
    read_mapping({item}, [&](Mapping& one) { read_outage(one, outage); });
    simulation.mocap_withheld.push_back(outage);
  }
}

}  // namespace

std::optional<LocalizerSpec> read_localizer(Mapping& top, const Scenario& scenario) {
  LocalizerSpec spec;
  const bool is_there = top.section("localizer", [&](Mapping& from) {
    from.declare({"landmarks", "robots"});
    from.section("safety", [&](Mapping& each) { read_pose_safety(each, spec.safety); });
    from.section("simulation",
                 [&](Mapping& each) { read_simulation(each, spec.simulation.emplace()); });
    from.section("odometry_noise",
                 [&](Mapping& noise) { read_odometry_noise(noise, spec.odometry_noise); });
    from.section("sighting_noise",
                 [&](Mapping& noise) { read_sighting_noise(noise, spec.sighting_noise); });
    from.integer("unknown_landmarks_max", spec.unknown_landmarks_max, 0, kUnknownLandmarksMax);
    tolerate([&] { read_landmarks(from, spec); });
    tolerate([&] { read_localized_robots(from, scenario, spec); });
  });
  if (spec.simulation) {
    const std::int64_t step_us = from_seconds(scenario.planner.step_s).count();
    if (step_us % kPosePeriodUs != 0) {
      top.refuse("localizer",
                 fmt::format("simulation requires planner.step_s to be a multiple of 0.1 s, at "
                             "which poses are computed; is {}",
                             scenario.planner.step_s));
    }
  }
  return is_there ? std::optional(std::move(spec)) : std::nullopt;
}

std::optional<LocalizerSpec> localizer_of(const Scenario& scenario) {
  if (scenario.source_text.find("localizer") == std::string::npos) {
    return std::nullopt;  // the scenario has no such section, or was not read from a file
  }
  return parse_localizer(scenario.source_text, scenario.name);
}

int index_of(const LocalizerSpec& spec, const std::string& robot) {
  for (std::size_t i = 0; i < spec.robots.size(); ++i) {
    if (spec.robots[i].name == robot) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

}  // namespace vantage::scenario
