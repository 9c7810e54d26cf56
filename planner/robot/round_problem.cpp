#include "planner/robot/round_problem.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "models/belief/exploration.hpp"
#include "planner/robot/trajectory_tools.hpp"

namespace vantage::planner {
namespace {

// Returns a seed that differs for each robot and round, and is the same in every replay.
std::uint64_t draw_seed(std::uint64_t seed, std::size_t robot, std::int64_t round) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                         static_cast<std::uint32_t>(robot), static_cast<std::uint32_t>(round)};
  std::uint32_t words[2];
  sequence.generate(std::begin(words), std::end(words));
  return (std::uint64_t{words[1]} << 32U) | words[0];
}

// Returns the height between `one_m` and `two_m` that is nearest to `other_m`.
double nearest_height_m(double other_m, double one_m, double two_m) {
  return std::clamp(other_m, std::min(one_m, two_m), std::max(one_m, two_m));
}

// A driver reports 10 times per second. After this time without a status it is assumed to be dead.
constexpr double kStale_s = 0.5;

// Bodies other than robots are assumed to move at constant velocity for this time, then to stop.
constexpr double kPredicted_s = 3.0;
constexpr double kStationary_mps = 0.1;
constexpr double kFastest_mps = 4.0;  // a higher speed means that two bodies were confused

// Returns the height of a vehicle above the markers of a body, m; 0 if the markers are at the same
// height or higher. The space below the markers counts as occupied.
double gap_below_m(const scenario::RobotSpec& robot, const models::MocapBody& body) {
  return std::max(0.0, robot.height_m - body.world_from_body.translation_m.z());
}

// True if the robot must avoid the body. A body within the robot's own radius is part of its load
// and is not avoided.
bool is_in_the_way(const Workspace& workspace, std::size_t robot, const models::MocapFrame& frame,
                   const models::MocapBody& body) {
  const scenario::RobotSpec& spec = workspace.scenario().robots[robot];
  if (body.occluded || workspace.index_of(body.name) ||
      gap_below_m(spec, body) >= workspace.scenario().planner.separation_m) {
    return false;
  }
  const models::MocapBody* const own = frame.find(spec.name, robot);
  return own == nullptr || own->occluded ||
         (own->world_from_body.translation_m - body.world_from_body.translation_m).norm() >=
             spec.limits.radius_m;
}

// Minimum weight of a mixture component that is planned for separately.
constexpr double kComponentWeightMin = 1.0 / 32.0;

// True if a search can process this prior, that is, products of its entries stay finite.
bool is_searchable(const models::Gaussian& prior) {
  // limit of means (m, m/s) and of covariances (squares of these)
  constexpr double kLargest = 1e30;
  return prior.mean.cwiseAbs().maxCoeff() <= kLargest &&
         prior.covariance.cwiseAbs().maxCoeff() <= kLargest &&
         models::log_det(prior.covariance) >=
             -std::log(kLargest) * static_cast<double>(prior.mean.size());
}

template <class Container, class Value>
bool contains(const Container& container, const Value& value) {
  return std::find(container.begin(), container.end(), value) != container.end();
}

const models::MocapBody* seen_body(const PlanInputs& inputs, const std::string& robot,
                                   std::size_t hint) {
  const models::MocapBody* body = inputs.mocap ? inputs.mocap->find(robot, hint) : nullptr;
  return body != nullptr && !body->occluded ? body : nullptr;
}

/// Additional clearance to obstacles, in σ of the robot's estimated position. A position error in
/// one direction is larger with a probability of 0.3 %.
constexpr double kPoseSigmas = 3.0;
/// m; an increased clearance stays this much below the present distance to obstacles, so that the
/// start has feasible motions.
constexpr double kClearanceSlackM = 0.01;

/// Returns the largest 1σ of the robot's horizontal position; 0 if motion capture sees the robot.
double pose_sigma_m(const PlanInputs& inputs, const std::string& robot) {
  const auto pose = inputs.poses.find(robot);
  if (pose == inputs.poses.end()) {
    return 0.0;
  }
  const Eigen::Matrix3d& P = pose->second.covariance;
  const double mean = 0.5 * (P(0, 0) + P(1, 1));
  return std::sqrt(mean + std::hypot(0.5 * (P(0, 0) - P(1, 1)), P(0, 1)));
}

// Builder of the problem of one round.
class Builder {
 public:
  Builder(Workspace& workspace, std::size_t robot, const PlanInputs& inputs)
      : workspace_(workspace),
        scenario_(workspace.scenario()),
        robot_(robot),
        spec_(scenario_.robots[robot]),
        inputs_(inputs) {}

  RoundProblem build(std::size_t robot, const models::Trajectory& committed,
                     const std::vector<int>& robots_without_sensing) {
    begin(robot, committed);
    if (scenario_.planner.objective == scenario::PlanObjective::kMapping) {
      add_map();
    } else if (inputs_.belief) {
      add_targets(*inputs_.belief);
      add_landmarks(*inputs_.belief);
    }
    add_teammates(robots_without_sensing);
    add_waiting_positions();
    add_bodies();
    round_.search.fixed_information = fixed_information(round_.search, round_.teammates);
    add_tour();
    return std::move(round_);
  }

 private:
  void begin(std::size_t robot, const models::Trajectory& committed);
  void add_map();
  void add_targets(const models::RobotBelief& belief);
  /// Returns one target per component of a mixture; empty if the belief is a single Gaussian.
  template <class Then>
  [[nodiscard]] std::vector<SearchTarget> components_of(int target_id, const Then& then) const;
  void add_landmarks(const models::RobotBelief& belief);
  /// True if unexplored regions are the landmarks and stops of the tour.
  [[nodiscard]] bool has_regions() const {
    return scenario_.planner.tour.horizon_s > 0.0 && scenario_.planner.tour.region_m > 0.0;
  }
  /// Adds a landmark for each unexplored region. In all regions together, `undiscovered` targets
  /// are expected.
  void add_regions(const models::VisibilityGrid& grid, double undiscovered);
  void add_teammates(const std::vector<int>& robots_without_sensing);
  void add_waiting_positions();
  void add_bodies();
  /// Plans the tour beyond the horizon. Without communication the teammates' visits do not count,
  /// because the robot does not receive what they measure.
  void add_tour();
  /// Returns a straight motion from the observed position, at the velocity computed from the two
  /// frames.
  [[nodiscard]] models::Trajectory motion_of(const models::MocapBody& body, std::size_t hint) const;
  /// True if a teammate is farther from its plan than flight safety allows.
  [[nodiscard]] bool is_off_plan(const scenario::RobotSpec& robot,
                                 const models::MocapBody& body) const;
  /// True if a teammate at `place` is within the neighbourhood.
  [[nodiscard]] bool is_near(const Pose2& place) const;

  Workspace& workspace_;
  const scenario::Scenario& scenario_;
  std::size_t robot_;  ///< index
  const scenario::RobotSpec& spec_;
  const PlanInputs& inputs_;
  RoundProblem round_;
  TourRegions regions_;
};

void Builder::begin(std::size_t robot, const models::Trajectory& committed) {
  const scenario::PlannerSpec& planner = scenario_.planner;
  SearchProblem& problem = round_.search;
  problem.start_time = inputs_.slot.activation;
  problem.start = committed.start;
  problem.start_speed_mps = models::at(committed, committed.start_time).control.speed_mps;
  problem.height_m = spec_.height_m;
  problem.controls = spec_.primitives;
  problem.horizon_steps = planner.horizon_steps;
  problem.step_s = planner.step_s;
  problem.sensors = {spec_.sensor};
  problem.cost = CostKind::kLogDet;
  problem.world = &scenario_.world;
  problem.field = &workspace_.field();
  problem.clearance_m = spec_.limits.radius_m + planner.obstacle_margin_m;
  if (const double sigma_m = pose_sigma_m(inputs_, spec_.name); sigma_m > 0.0) {
    const double free_m =
        models::clearance_m(scenario_.world, problem.start.position_m()) - kClearanceSlackM;
    problem.clearance_m = std::max(problem.clearance_m,
                                   std::min(problem.clearance_m + kPoseSigmas * sigma_m, free_m));
  }
  // Both vehicles may be off their plans by the tolerance at the same time.
  problem.separation_m = planner.separation_m + 2.0 * planner.tracking_tolerance_m;
  problem.separation_from_above = planner.separation_from_above;
  problem.brake_mps2 = spec_.limits.brake_mps2;
  problem.seed = draw_seed(scenario_.seed, robot, inputs_.slot.round);
}

void Builder::add_map() {
  if (!inputs_.map) {
    return;
  }
  const models::GridGeometry ground = models::map_geometry(scenario_.world, scenario_.mapping);
  if (inputs_.map->grid == ground && std::ssize(inputs_.map->team_looks) == ground.size()) {
    round_.looks = inputs_.map->team_looks;
  } else {
    ++round_.unusable_maps;
  }
}

void Builder::add_targets(const models::RobotBelief& belief) {
  const models::TargetModel& model = scenario_.estimator.target_model;
  const double ahead_s = to_seconds(inputs_.slot.activation - belief.stamp.time);
  const double step_s = scenario_.planner.step_s;
  std::size_t planned = 0;
  // number of components in addition to one per target
  std::size_t room = components_max(scenario_);
  for (const models::TargetBelief& target : belief.targets) {
    const auto gaussian = target.information.vector.size() == model.dim() && ahead_s >= 0.0
                              ? models::to_gaussian(target.information)
                              : std::nullopt;
    const double unseen_s = std::max(0.0, to_seconds(belief.stamp.time - target.last_seen));
    const auto then = [&](const models::Gaussian& now) -> SearchTarget {
      return {model.as_planned((unseen_s + ahead_s) / step_s, step_s),
              models::predict_unseen(now, model, ahead_s, unseen_s, step_s)};
    };
    const std::optional<SearchTarget> whole =
        gaussian ? std::optional(then(*gaussian)) : std::nullopt;
    if (!whole || !is_searchable(whole->prior) || planned >= scenario_.targets.size()) {
      ++round_.unusable_beliefs;
      continue;
    }
    ++planned;
    const std::vector<SearchTarget> parts = components_of(target.target_id, then);
    if (parts.size() > 1 && parts.size() - 1 <= room) {
      room -= parts.size() - 1;
      round_.search.targets.insert(round_.search.targets.end(), parts.begin(), parts.end());
    } else {
      round_.search.targets.push_back(*whole);
    }
  }
}

template <class Then>
std::vector<SearchTarget> Builder::components_of(int target_id, const Then& then) const {
  std::vector<SearchTarget> parts;
  if (!inputs_.mixture || !is_of_belief(*inputs_.mixture, *inputs_.belief)) {
    return parts;
  }
  const auto& mixtures = inputs_.mixture->targets;
  const auto found = std::lower_bound(
      mixtures.begin(), mixtures.end(), target_id,
      [](const models::TargetMixture& each, int id) { return each.target_id < id; });
  if (found == mixtures.end() || found->target_id != target_id) {
    return parts;
  }
  for (const models::Component& component : found->components) {
    if (component.belief.mean.size() != scenario_.estimator.target_model.dim()) {
      return {};
    }
    const SearchTarget part = then(component.belief);
    if (component.weight >= kComponentWeightMin && is_searchable(part.prior)) {
      parts.push_back(part);
    }
  }
  return parts;
}

void Builder::add_landmarks(const models::RobotBelief& belief) {
  const models::ExplorationSpec& exploration = scenario_.planner.exploration;
  const bool are_found = belief.targets.size() >= scenario_.targets.size();
  if (exploration.landmarks_max <= 0 || (exploration.until_found && are_found)) {
    return;
  }
  const auto whole =
      models::GridGeometry::covering(scenario_.world.bounds, scenario_.estimator.grid_resolution_m);
  const bool is_one_grid = scenario_.network.neighbourhood_m > 0.0
                               ? whole.cell_offset_of(belief.grid).has_value()
                               : belief.grid == whole;
  if (!is_one_grid || std::ssize(belief.last_seen_utime) != belief.grid.size()) {
    ++round_.unusable_beliefs;
    return;
  }
  const models::VisibilityGrid& grid = workspace_.ground(belief.grid, belief.last_seen_utime);
  const models::TargetModel still{models::TargetKind::kStatic, 2, 0.0};
  if (has_regions()) {
    add_regions(grid, std::max(0.0, static_cast<double>(scenario_.targets.size()) -
                                        static_cast<double>(belief.targets.size())));
    return;
  }
  for (const models::Gaussian& landmark : models::exploration_landmarks(
           grid, exploration, round_.search.start.position_m(), inputs_.slot.activation)) {
    round_.search.targets.push_back({still, landmark});
  }
}

bool Builder::is_near(const Pose2& place) const {
  const double neighbourhood_m = scenario_.network.neighbourhood_m;
  return neighbourhood_m <= 0.0 ||
         (place.position_m() - round_.search.start.position_m()).norm() <= neighbourhood_m;
}

void Builder::add_teammates(const std::vector<int>& robots_without_sensing) {
  for (std::size_t i = 0; i < scenario_.robots.size(); ++i) {
    const scenario::RobotSpec& robot = scenario_.robots[i];
    if (&robot == &spec_) {
      continue;
    }
    FixedTeammate teammate;
    teammate.robot = i;
    teammate.sensor = robot.sensor;
    teammate.jammed = contains(robots_without_sensing, static_cast<int>(i)) ||
                      (inputs_.attack && contains(inputs_.attack->jammed, robot.name));
    const auto plan = inputs_.team_plans.find(robot.name);
    if (plan != inputs_.team_plans.end()) {
      teammate.trajectory = plan->second.trajectory;
    } else {
      // Without a received plan, the teammate is assumed to hover at its observed position, or at
      // its start in the scenario.
      const models::MocapBody* body = seen_body(inputs_, robot.name, i);
      const Pose2 pose = body != nullptr ? flatten(body->world_from_body) : robot.start;
      if (!is_near(pose)) {
        continue;
      }
      teammate.trajectory = hover_at(pose, robot.height_m, inputs_.slot.activation);
    }
    round_.search.teammates.push_back(teammate.trajectory);
    round_.teammates.push_back(std::move(teammate));
  }
}

// Adds the positions of teammates that do not follow plans, are off their plan, or have a status
// older than kStale_s. For a teammate without any status, adds only the position on the ground;
// add_teammates() has added the flight position.
void Builder::add_waiting_positions() {
  for (std::size_t i = 0; i < scenario_.robots.size(); ++i) {
    const scenario::RobotSpec& robot = scenario_.robots[i];
    const auto status = inputs_.team_statuses.find(robot.name);
    const bool has_status = status != inputs_.team_statuses.end();
    const models::FlightState state =
        has_status ? status->second.state : models::FlightState::kIdle;
    const models::MocapBody* const body = seen_body(inputs_, robot.name, i);
    if (&robot == &spec_ || body == nullptr) {
      continue;
    }
    const bool is_stale =
        has_status && to_seconds(inputs_.slot.begin - status->second.stamp.time) > kStale_s;
    const bool is_lost = is_stale || is_off_plan(robot, *body);
    if (state == models::FlightState::kFollow && !is_lost) {
      continue;
    }
    // The teammate's plan, if any, is also avoided: the teammate may begin to follow it at any
    // time.
    const Pose2 place = flatten(body->world_from_body);
    if (!has_status && !is_near(place)) {
      continue;
    }
    const double here_m = body->world_from_body.translation_m.z();
    double height_m = robot.height_m;
    if (is_lost && state != models::FlightState::kIdle) {  // the autopilot may land the vehicle
      height_m = nearest_height_m(spec_.height_m, 0.0, here_m);
    } else if (state == models::FlightState::kHold) {  // the vehicle may be climbing
      height_m = nearest_height_m(spec_.height_m, here_m, robot.height_m);
    } else if (state == models::FlightState::kLand) {
      height_m = nearest_height_m(spec_.height_m, 0.0, here_m);
    } else if (here_m < 0.5 * robot.height_m) {  // the robot is on the ground, but may take off
      round_.search.teammates.push_back(hover_at(place, here_m, inputs_.slot.activation));
    }
    if (has_status) {
      round_.search.teammates.push_back(hover_at(place, height_m, inputs_.slot.activation));
    }
  }
}

bool Builder::is_off_plan(const scenario::RobotSpec& robot, const models::MocapBody& body) const {
  const auto plan = inputs_.team_plans.find(robot.name);
  if (plan == inputs_.team_plans.end()) {
    return false;
  }
  const models::Trajectory& way = plan->second.trajectory;
  const Time seen = inputs_.mocap->stamp.time;
  const double until_start_s = std::max(0.0, to_seconds(way.start_time - seen));
  const double allowed_m =
      4.0 * scenario_.planner.tracking_tolerance_m + until_start_s * robot.limits.speed_max_mps;
  const Pose2 planned = models::at(way, std::max(seen, way.start_time)).world_from_body;
  return (planned.position_m() - flatten(body.world_from_body).position_m()).norm() > allowed_m;
}

models::Trajectory Builder::motion_of(const models::MocapBody& body, std::size_t hint) const {
  const Eigen::Vector3d seen_m = body.world_from_body.translation_m;
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  const models::MocapBody* const before = inputs_.mocap_before->find(body.name, hint);
  const double since_s = to_seconds(inputs_.mocap->stamp.time - inputs_.mocap_before->stamp.time);
  if (before != nullptr && !before->occluded && since_s > 0.0) {
    velocity_mps = (seen_m - before->world_from_body.translation_m).head<2>() / since_s;
  }
  double speed_mps = velocity_mps.norm();
  speed_mps = speed_mps < kStationary_mps || speed_mps > kFastest_mps ? 0.0 : speed_mps;
  const double yaw_rad = speed_mps > 0.0 ? std::atan2(velocity_mps.y(), velocity_mps.x()) : 0.0;
  models::Trajectory motion =
      hover_at({seen_m.x(), seen_m.y(), yaw_rad}, std::min(spec_.height_m, seen_m.z()),
               inputs_.mocap->stamp.time);
  if (speed_mps > 0.0) {
    motion.segments = {{{speed_mps, 0.0}, kPredicted_s, 0.0}};
  }
  return motion;
}

// Adds the nearest bodies in the way.
void Builder::add_bodies() {
  if (!inputs_.mocap || !inputs_.mocap_before) {
    return;
  }
  const std::vector<models::MocapBody>& bodies = inputs_.mocap->bodies;
  std::vector<std::pair<double, std::size_t>> near_m;  // (distance, index in the frame)
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Pose2 place = flatten(bodies[i].world_from_body);
    if (is_in_the_way(workspace_, robot_, *inputs_.mocap, bodies[i]) && is_near(place)) {
      near_m.emplace_back((place.position_m() - round_.search.start.position_m()).norm(), i);
    }
  }
  std::sort(near_m.begin(), near_m.end());
  const std::size_t kept = std::min(near_m.size(), kBodiesMax);
  round_.bodies_dropped = static_cast<std::int64_t>(near_m.size() - kept);
  for (std::size_t k = 0; k < kept; ++k) {
    round_.search.teammates.push_back(motion_of(bodies[near_m[k].second], near_m[k].second));
  }
}

void Builder::add_regions(const models::VisibilityGrid& grid, double undiscovered) {
  const scenario::EstimatorSpec& estimator = scenario_.estimator;
  const models::ExplorationSpec& exploration = scenario_.planner.exploration;
  const models::TargetModel& model = estimator.target_model;
  SearchTarget& target = regions_.undiscovered;
  target.model = model.as_planned(0.0, scenario_.planner.step_s);
  target.prior.mean = models::StateVector::Zero(model.dim());
  target.prior.covariance = models::StateMatrix::Zero(model.dim(), model.dim());
  for (int i = 0; i < model.dim(); ++i) {
    const double sigma = i < model.position_dim ? estimator.undiscovered_position_sigma_m
                                                : estimator.prior_velocity_sigma_mps;
    target.prior.covariance(i, i) = sigma * sigma;
  }
  const models::TargetModel still{models::TargetKind::kStatic, 2, 0.0};
  const double sigma_m = exploration.landmark_sigma_m;
  for (const models::UnexploredRegion& region :
       models::unexplored_regions(grid, scenario_.planner.tour.region_m, exploration.landmarks_max,
                                  inputs_.slot.activation)) {
    regions_.regions.push_back(
        {static_cast<int>(round_.search.targets.size()), undiscovered * region.share});
    round_.search.targets.push_back(
        {still, {region.centre_m, sigma_m * sigma_m * Eigen::Matrix2d::Identity()}});
  }
}

void Builder::add_tour() {
  const scenario::TourSpec& tour = scenario_.planner.tour;
  if (tour.horizon_s <= 0.0 || round_.search.targets.empty()) {
    return;
  }
  const std::vector<FixedTeammate> none;
  const bool is_alone = scenario_.network.communication_range_m <= 0.0;
  workspace_.tours().plan(round_.search, is_alone ? none : round_.teammates, tour, regions_);
  round_.search.terminal = workspace_.tours().terminal_value();
}

}  // namespace

bool shows_bodies_in_the_way(const Workspace& workspace, std::size_t robot,
                             const models::MocapFrame& frame) {
  return std::any_of(frame.bodies.begin(), frame.bodies.end(), [&](const models::MocapBody& body) {
    return is_in_the_way(workspace, robot, frame, body);
  });
}

RoundProblem problem_of_round(Workspace& workspace, std::size_t robot, const PlanInputs& inputs,
                              const models::Trajectory& committed,
                              const std::vector<int>& robots_without_sensing) {
  return Builder(workspace, robot, inputs).build(robot, committed, robots_without_sensing);
}

}  // namespace vantage::planner
