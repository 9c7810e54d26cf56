#include "localizer/app/pose_step.hpp"

#include <algorithm>
#include <utility>

#include "core/check.hpp"
#include "models/exchange/counts.hpp"
#include "scenario/reader/localizer_yaml.hpp"

namespace vantage::localizer {
namespace {

// Smallest 1σ of a pose from motion capture. Poses of a static body have correlated errors.
constexpr double kFixSigmaM = 0.001;
constexpr double kFixSigmaRad = 0.002;

scenario::LocalizerSpec spec_of(const scenario::Scenario& scenario, const std::string& robot) {
  auto spec = scenario::localizer_of(scenario);
  require(spec.has_value(), scenario.name + ": the scenario has no section `localizer`");
  require(scenario::index_of(*spec, robot) >= 0,
          scenario.name + ": robot " + robot + " is not in localizer.robots");
  return *std::move(spec);
}

}  // namespace

PoseSteps::PoseSteps(const scenario::Scenario& scenario, const std::string& robot)
    : spec_(spec_of(scenario, robot)),
      robot_(scenario::index_of(spec_, robot)),
      localizer_(spec_, robot_) {
  const double position_sigma_m = std::max(scenario.mocap.position_sigma_m, kFixSigmaM);
  const double yaw_sigma_rad = std::max(scenario.mocap.yaw_sigma_rad, kFixSigmaRad);
  const Eigen::Vector3d sigma(position_sigma_m, position_sigma_m, yaw_sigma_rad);
  fix_covariance_ = sigma.cwiseAbs2().asDiagonal();
}

void PoseSteps::add(const models::OdometryReport& odometry, Time limit) {
  if (odometry.stamp.time > limit) {
    ++too_new_;
    return;
  }
  localizer_.add_odometry(odometry);
}

void PoseSteps::add(const models::PoseEstimate& estimate, Time limit) {
  // Sightings are in ascending order.
  if (estimate.stamp.time > limit ||
      (!estimate.sightings.empty() && estimate.sightings.back().time > limit)) {
    ++too_new_;
    return;
  }
  localizer_.add_teammate(estimate);
}

void PoseSteps::add(const models::SightingReport& report, Time limit) {
  if (!report.sightings.empty() && report.sightings.back().time > limit) {
    ++too_new_;
    return;
  }
  const scenario::LocalizedRobotSpec& own = spec_.robots[static_cast<std::size_t>(robot_)];
  corrected_ = report.sightings;
  for (models::Sighting& sighting : corrected_) {
    sighting.time -= from_seconds(own.sightings.stamp_delay_s);
  }
  localizer_.add_sightings(corrected_);
}

void PoseSteps::add(const models::MocapFrame& frame, Time limit) {
  if (frame.stamp.time > limit) {
    ++too_new_;
    return;
  }
  for (std::size_t robot = 0; robot < spec_.robots.size(); ++robot) {
    const models::MocapBody* const body = frame.find(spec_.robots[robot].name, robot);
    if (body != nullptr && !body->occluded) {
      localizer_.add_fix(static_cast<int>(robot), frame.stamp.time,
                         {flatten(body->world_from_body), fix_covariance_});
    }
  }
}

models::PoseEstimate PoseSteps::step(Time t, std::int64_t step,
                                     const std::vector<PoseInput>& inputs) {
  models::PoseEstimate made;
  for (const PoseInput& input : inputs) {
    std::visit([&](const auto& content) { add(*content, t + kAheadMax); }, input.content);
    made.inputs.push_back(input.ref);
  }
  localizer_.advance_to(t);
  localizer_.write_message(made);
  made.step = step;
  if (step % kExchangeEvery != 0) {
    made.increments.clear();
    made.sightings.clear();
  }
  return made;
}

std::vector<std::string> PoseSteps::teammates() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < spec_.robots.size(); ++i) {
    if (static_cast<int>(i) != robot_) {
      names.push_back(spec_.robots[i].name);
    }
  }
  return names;
}

bool PoseSteps::sees_a_robot(const models::MocapFrame& frame) const {
  return std::any_of(spec_.robots.begin(), spec_.robots.end(), [&](const auto& robot) {
    const models::MocapBody* const body = frame.find(robot.name);
    return body != nullptr && !body->occluded;
  });
}

std::vector<models::NamedCount> PoseSteps::counters() const {
  const InputCounts& inputs = localizer_.counts();
  const FilterCounts& filter = localizer_.team().counts();
  return models::nonzero({{"localizer.sightings_late", inputs.late_sightings},
                          {"localizer.sightings_lost", inputs.lost_sightings},
                          {"localizer.increments_missing", inputs.missing_increments},
                          {"localizer.inputs_refused", inputs.refused},
                          {"localizer.inputs_too_new", too_new_},
                          {"localizer.fixes_late", inputs.late_fixes},
                          {"localizer.sightings_rejected", filter.rejected},
                          {"localizer.sightings_unknown", filter.unknown},
                          {"localizer.sightings_unplaced", filter.unplaced},
                          {"localizer.slips", filter.slips}});
}

}  // namespace vantage::localizer
