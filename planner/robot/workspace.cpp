#include "planner/robot/workspace.hpp"

#include <algorithm>

namespace vantage::planner {
namespace {

constexpr double kFieldResolution_m = 0.05;
constexpr double kFieldCells_max = 500.0;  // maximum number of cells along the longer side

SearchCapacity capacity_for(const scenario::Scenario& scenario) {
  SearchCapacity capacity;
  capacity.targets_max = static_cast<int>(scenario.targets.size() + components_max(scenario)) +
                         std::max(0, scenario.planner.exploration.landmarks_max);
  capacity.horizon_max = scenario.planner.horizon_steps;
  // Three entries per robot (its plan, its position on the ground, and its hover or future flight
  // position), plus the bodies.
  capacity.teammates_max = static_cast<int>(3 * scenario.robots.size() + kBodiesMax);
  capacity.motion_steps_max = motion_steps_max(scenario.planner, scenario.robots);
  return capacity;
}

double field_resolution_m(const models::World& world) {
  const double longer_m = (world.bounds.max_m - world.bounds.min_m).maxCoeff();
  return std::max(kFieldResolution_m, longer_m / kFieldCells_max);
}

AlgorithmOptions options_of(const scenario::Scenario& scenario, int robot_index) {
  const scenario::PlannerSpec& planner = scenario.planner;
  AlgorithmOptions options;
  options.epsilon = planner.epsilon_initial;
  options.delta_m = planner.delta_initial_m;
  options.yaw_weight_m_per_rad = planner.yaw_weight_m_per_rad;
  options.weight = 2.5;  // for wastar, as in the dissertation's library
  options.sweep = {robot_index, static_cast<int>(scenario.robots.size())};
  return options;
}

}  // namespace

std::size_t components_max(const scenario::Scenario& scenario) {
  constexpr std::size_t kComponentsPerTarget = 8;  // equals Samples::kPartsMax
  constexpr std::size_t kComponentsTotal = 256;
  const bool has_mixtures =
      scenario.estimator.samples ||
      std::any_of(scenario.robots.begin(), scenario.robots.end(),
                  [](const auto& robot) { return !robot.detection.detects_ids; });
  return has_mixtures
             ? std::min((kComponentsPerTarget - 1) * scenario.targets.size(), kComponentsTotal)
             : 0;
}

Workspace::Workspace(const scenario::Scenario& scenario)
    : scenario_(scenario), field_(scenario.world, field_resolution_m(scenario.world)) {
  for (std::size_t i = 0; i < scenario_.robots.size(); ++i) {
    indices_.emplace(scenario_.robots[i].name, i);
  }
}

std::optional<std::size_t> Workspace::index_of(const std::string& robot) const {
  const auto found = indices_.find(robot);
  return found == indices_.end() ? std::nullopt : std::optional(found->second);
}

ReducedValueIteration& Workspace::reduced() {
  return reduced_ ? *reduced_ : reduced_.emplace(capacity_for(scenario_));
}

TourPlanner& Workspace::tours() {
  return tours_ ? *tours_ : tours_.emplace(capacity_for(scenario_).targets_max);
}

const models::VisibilityGrid& Workspace::ground(const models::GridGeometry& part,
                                                const std::vector<std::int64_t>& last_seen_utime) {
  if (!(ground_.geometry() == part)) {
    ground_ = models::VisibilityGrid(scenario_.world, part, scenario_.estimator.grid_memory_s);
  }
  ground_.set_last_seen(last_seen_utime);
  return ground_;
}

std::unique_ptr<Search> Workspace::make_search(int robot_index) const {
  return algorithm_called(scenario_.planner.algorithm)
      .make(capacity_for(scenario_), options_of(scenario_, robot_index));
}

Search& Workspace::search() {
  if (!search_) {
    search_ = make_search(0);
  }
  return *search_;
}

void Workspace::prefault() {
  if (search_) {
    search_->prefault();
  }
  if (reduced_) {
    reduced_->prefault();
  }
}

}  // namespace vantage::planner
