#include "localizer/fit/blind_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.hpp"
#include "localizer/fit/sighted_response.hpp"
#include "localizer/judge/judge.hpp"

namespace vantage::localizer {
namespace {

constexpr int kRoundsMax = 12;
constexpr double kSmallChange = 0.002;  // change at which the fit ends; scales, m, rad or s

/// Returns the largest change of any parameter.
double change_of(const scenario::LocalizedRobotSpec& from, const scenario::LocalizedRobotSpec& to) {
  const scenario::SightingSpec& a = from.sightings;
  const scenario::SightingSpec& b = to.sightings;
  const scenario::DriveSpec& c = from.drive;
  const scenario::DriveSpec& d = to.drive;
  // Delay and lag of a drive can replace each other, so only their sum is compared.
  return std::max(
      {std::abs(a.range_scale - b.range_scale), std::abs(a.range_offset_m - b.range_offset_m),
       std::abs(a.axis_rad - b.axis_rad), std::abs(a.bearing_offset_rad - b.bearing_offset_rad),
       std::abs(a.forward_m - b.forward_m), std::abs(c.delay_s + c.lag_s - d.delay_s - d.lag_s),
       std::abs(c.speed_scale - d.speed_scale), std::abs(c.turn_scale - d.turn_scale)});
}

}  // namespace

BlindFit fit_without_truth(scenario::LocalizerSpec& spec, Recording recording) {
  BlindFit fit;
  for (double change = 1.0; change > kSmallChange && fit.rounds < kRoundsMax; ++fit.rounds) {
    std::vector<TruePath> paths = smoothed_paths(spec, recording);
    fit.sensors.clear();
    fit.drives.clear();
    change = 0.0;
    for (std::size_t robot = 0; robot < recording.size(); ++robot) {
      scenario::LocalizedRobotSpec& one = spec.robots[robot];
      require(!paths[robot].empty(), "robot " + one.name +
                                         " does not find its start: it must see "
                                         "two landmarks within 20 s");
      recording[robot].truth = std::move(paths[robot]);
      const scenario::LocalizedRobotSpec before = one;
      fit.sensors.push_back(
          fit_sensor(spec.landmarks, recording[robot], before.sightings.stamp_delay_s));
      one.sightings = fit.sensors.back().sensor;
      fit.drives.push_back(fit_drive(
          recording[robot], sighted_response(spec.landmarks, one.sightings, recording[robot])));
      one.drive = fit.drives.back().drive;
      change = std::max(change, change_of(before, one));
    }
  }
  return fit;
}

}  // namespace vantage::localizer
