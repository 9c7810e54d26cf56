#include "experiments/mapping/mapping_trial.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/check.hpp"
#include "core/uniform.hpp"
#include "experiments/team/team_task.hpp"
#include "models/mapping/beam_scan.hpp"
#include "planner/problem/motion_table.hpp"
#include "sim/random.hpp"

namespace vantage::experiments {
namespace {

using models::OccupancyBelief;
using planner::MapRoute;

constexpr double kStartSquare_m = 3.0;  // m; half the side of the start square of a team

std::vector<Pose2> draw_starts(const MappingSetup& setup, std::mt19937_64& random) {
  const models::Rectangle& bounds = setup.world.bounds;
  const double clear_m = setup.drive.radius_m + 0.3;
  const auto draw = [&](const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m) {
    return Pose2{uniform(random, low_m.x(), high_m.x()), uniform(random, low_m.y(), high_m.y()),
                 uniform(random, -kPi, kPi)};
  };
  std::vector<Pose2> starts;
  for (int tries = 0; static_cast<int>(starts.size()) < setup.robots; ++tries) {
    require(tries < 100'000, "the world has no room for the team to start in");
    const bool is_first = starts.empty();
    const Eigen::Vector2d side_m = Eigen::Vector2d::Constant(kStartSquare_m);
    const Pose2 start =
        is_first ? draw(bounds.min_m, bounds.max_m)
                 : draw(starts[0].position_m() - side_m, starts[0].position_m() + side_m);
    const bool is_apart = std::none_of(starts.begin(), starts.end(), [&](const Pose2& other) {
      return (other.position_m() - start.position_m()).norm() < 2.0 * clear_m;
    });
    if (is_apart && models::clearance_m(setup.world, start.position_m()) > clear_m) {
      starts.push_back(start);
    }
    if (tries % 1'000 == 999) {
      starts.clear();  // the position is too narrow for all robots
    }
  }
  return starts;
}

class MappingTrial {
 public:
  MappingTrial(const MappingSetup& setup, std::uint64_t seed)
      : setup_(setup),
        ground_(setup, seed),
        attacker_(sim::random_stream(seed, "mapping attack")),
        outcome_{{}, 0, 0, 0, 0.0, ground_.map(), ground_.map()} {}

  void plan() {
    models::BeamSensor planned = setup_.scanner;
    planned.beams = setup_.planned_beams;
    views_.emplace(ground_.map(), planned, setup_.views);
    drive_.emplace(ground_.map(), setup_.drive);
    search_.emplace(*views_, *drive_, setup_.search);
    routes_ = setup_.planner(*search_, ground_.poses(), setup_.attacks);
    stopped_.assign(routes_.size(), false);
    for (const MapRoute& route : routes_) {
      outcome_.nodes += route.nodes;
    }
  }

  void attack() {
    attacked_ = attacked_robots(setup_.attack, setup_.attacks, routes_, *search_, attacker_);
    if (setup_.attack == AttackKind::kPreviousPlans) {
      attacked_.swap(chosen_before_);
    }
    outcome_.beam_cells += views_->beam_cells();
  }

  void move(int step_of_plan) {
    const auto t = static_cast<std::size_t>(step_of_plan);
    for (std::size_t robot = 0; robot < routes_.size(); ++robot) {
      const std::vector<int>& controls = routes_[robot].controls;
      if (stopped_[robot] || t >= controls.size()) {
        continue;
      }
      const models::UnicycleControl& control =
          setup_.search.controls[static_cast<std::size_t>(controls[t])];
      if (!ground_.drive(robot, control)) {
        stopped_[robot] = true;
        ++outcome_.stopped;
      }
    }
  }

  void observe() { ground_.observe(attacked_); }

  void record() {
    outcome_.steps.push_back({ground_.map().entropy_nats(), ground_.poses(), attacked_});
    if (static_cast<int>(outcome_.steps.size()) == setup_.steps / 2 + 1) {
      outcome_.halfway = ground_.map();
    }
  }

  MappingOutcome outcome() {
    outcome_.map = ground_.map();
    outcome_.wrong_share = wrong_share();
    return outcome_;
  }

 private:
  [[nodiscard]] double wrong_share() const {
    const OccupancyBelief& map = ground_.map();
    int wrong = 0;
    int known = 0;
    for (int cell = 0; cell < map.geometry().size(); ++cell) {
      const double o = map.occupancy(cell);
      if (o > 0.1 && o < 0.9) {
        continue;
      }
      ++known;
      // A cell crossed by an obstacle's edge may be occupied or free.
      const double clearance_m = models::clearance_m(setup_.world, map.geometry().centre_m(cell));
      const double edge_m = 0.71 * map.geometry().resolution_m;
      wrong += (o < 0.5 && clearance_m < -edge_m) || (o > 0.5 && clearance_m > edge_m) ? 1 : 0;
    }
    return known == 0 ? 0.0 : static_cast<double>(wrong) / known;
  }

  const MappingSetup& setup_;
  MappedWorld ground_;
  std::mt19937_64 attacker_;
  // Data of the current plans.
  std::optional<planner::ViewTable> views_;
  std::optional<planner::DriveMap> drive_;
  std::optional<planner::MappingSearch> search_;
  std::vector<MapRoute> routes_;
  std::vector<bool> stopped_;  ///< true: stopped by the bumper, by robot
  std::vector<int> attacked_;
  std::vector<int> chosen_before_;  ///< for kPreviousPlans: robots chosen from the previous plans
  MappingOutcome outcome_;
};

}  // namespace

MappedWorld::MappedWorld(const MappingSetup& setup, std::uint64_t seed)
    : setup_(setup),
      noise_(sim::random_stream(seed, "mapping scan")),
      fusion_(setup.scanner, setup.inverse),
      map_(models::GridGeometry::covering(setup.world.bounds, setup.resolution_m),
           setup.clamp_log_odds) {
  std::mt19937_64 starts = sim::random_stream(seed, "mapping start");
  poses_ = draw_starts(setup, starts);
}

// The robot moves close to the obstacle. Otherwise its scans might never show the obstacle, and it
// would repeat the same attempt.
bool MappedWorld::drive(std::size_t robot, const models::UnicycleControl& control) {
  constexpr int kParts = 16;
  Pose2& pose = poses_[robot];
  const double step_s = setup_.search.step_s;
  int parts = kParts;
  while (parts > 0 && !planner::arc_is_clear(setup_.world, pose, control, step_s * parts / kParts,
                                             setup_.drive.radius_m)) {
    --parts;
  }
  const bool is_clear = parts == kParts;
  const int driven = is_clear ? kParts : std::max(0, parts - 1);
  pose = models::step_unicycle(pose, control, step_s * driven / kParts);
  return is_clear;
}

// All robots scan, so that an attack on one does not change the noise of the others.
void MappedWorld::observe(std::span<const int> attacked) {
  for (std::size_t robot = 0; robot < poses_.size(); ++robot) {
    const std::vector<double> ranges_m =
        models::beam_scan(setup_.world, setup_.scanner, poses_[robot], noise_);
    if (!std::binary_search(attacked.begin(), attacked.end(), static_cast<int>(robot))) {
      fusion_.fuse(poses_[robot], ranges_m, map_);
    }
  }
}

std::vector<MapRoute> plan_by_coordinate_descent(planner::MappingSearch& search,
                                                 std::span<const Pose2> starts, int /*attacks*/) {
  std::vector<int> order(starts.size());
  std::iota(order.begin(), order.end(), 0);
  return search.coordinate_descent(starts, order);
}

MappingOutcome run_mapping_trial(const MappingSetup& setup, std::uint64_t seed) {
  require(setup.robots >= 1 && setup.steps >= 1, "a mapping trial must have robots and steps");
  MappingTrial task(setup, seed);
  task.observe();  // scan at the start pose
  task.record();
  run_team_task(task, setup.steps, setup.search.horizon_steps);
  return task.outcome();
}

}  // namespace vantage::experiments
