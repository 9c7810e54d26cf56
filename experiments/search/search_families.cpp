#include "experiments/search/search_families.hpp"

#include <cmath>
#include <memory>
#include <random>

#include "core/uniform.hpp"
#include "experiments/mapping/landmark_problem.hpp"

namespace vantage::experiments {
namespace {

using planner::OwnedProblem;
using planner::SearchProblem;
using planner::SearchTarget;

std::mt19937_64 random_of(std::uint64_t family, std::uint64_t seed) {
  return std::mt19937_64(0x9E3779B97F4A7C15U * (seed + 1) + family);
}

int draw_integer(std::mt19937_64& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<std::uint64_t>(high - low + 1));
}

models::SensorModel sensor_of(models::SensorKind kind, double range_max_m, double fov_deg) {
  models::SensorModel sensor;
  sensor.kind = kind;
  sensor.range_max_m = range_max_m;
  sensor.range_min_m = 0.1;
  sensor.fov_rad = radians(fov_deg);
  sensor.range_sigma_m = 0.15;
  sensor.bearing_sigma_rad = radians(5.0);
  return sensor;
}

OwnedProblem empty_problem(const Eigen::Vector2d& half_m, int horizon_steps) {
  OwnedProblem owned;
  owned.world = std::make_unique<models::World>();
  owned.world->bounds = {-half_m, half_m};
  owned.problem.world = owned.world.get();
  owned.problem.horizon_steps = horizon_steps;
  owned.problem.controls = models::standard_primitives();
  owned.problem.clearance_m = 0.25;
  return owned;
}

void add_field(OwnedProblem& owned, double resolution_m) {
  owned.field = std::make_unique<models::DistanceField>(*owned.world, resolution_m);
  owned.problem.field = owned.field.get();
}

void add_mover(SearchProblem& problem, std::mt19937_64& random, const Eigen::Vector2d& at_m,
               double speed_mps, double variance_m2) {
  SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 0.001}, {}};
  const double vx_mps = uniform(random, -speed_mps, speed_mps);
  target.prior.mean =
      Eigen::Vector4d(at_m.x(), at_m.y(), vx_mps, uniform(random, -speed_mps, speed_mps));
  target.prior.covariance = Eigen::Vector4d(variance_m2, variance_m2, 0.1, 0.1).asDiagonal();
  problem.targets.push_back(target);
}

Eigen::Vector2d draw_position(std::mt19937_64& random, const Eigen::Vector2d& half_m) {
  const double x_m = uniform(random, -half_m.x(), half_m.x());
  return {x_m, uniform(random, -half_m.y(), half_m.y())};
}

// Returns a position with the clearance to obstacles and walls.
Eigen::Vector2d draw_free(std::mt19937_64& random, const models::World& world, double clearance_m) {
  while (true) {
    const Eigen::Vector2d at_m = draw_position(random, world.bounds.max_m);
    if (models::clearance_m(world, at_m) > clearance_m) {
      return at_m;
    }
  }
}

OwnedProblem draw_dense(std::uint64_t seed) {
  std::mt19937_64 random = random_of(1, seed);
  OwnedProblem owned = empty_problem({32.0, 32.0}, 12);
  add_field(owned, 0.2);
  owned.problem.sensors = {sensor_of(models::SensorKind::kRangeBearing, 10.0, 94.0)};
  const int targets = draw_integer(random, 9, 25);
  for (int m = 0; m < targets; ++m) {
    add_mover(owned.problem, random, draw_position(random, {14.0, 14.0}), 0.5, 1.0);
  }
  return owned;
}

OwnedProblem draw_sparse(std::uint64_t seed) {
  std::mt19937_64 random = random_of(2, seed);
  OwnedProblem owned = empty_problem({32.0, 32.0}, draw_integer(random, 12, 30));
  add_field(owned, 0.2);
  owned.problem.sensors = {sensor_of(models::SensorKind::kRangeBearing, 10.0, 94.0)};
  const int targets = draw_integer(random, 1, 5);
  for (int m = 0; m < targets; ++m) {
    add_mover(owned.problem, random, draw_position(random, {28.0, 28.0}), 0.5, 1.0);
  }
  return owned;
}

// Adds a wall from a to b along one axis, with a door of 1.6 m.
void add_wall_with_door(models::World& world, std::mt19937_64& random, Eigen::Vector2d a_m,
                        Eigen::Vector2d b_m) {
  constexpr double kHalf_m = 0.15;
  constexpr double kDoor_m = 1.6;
  const Eigen::Vector2d along = (b_m - a_m).normalized();
  const double length_m = (b_m - a_m).norm();
  const double door_m = uniform(random, 1.0, length_m - 1.0 - kDoor_m);
  const Eigen::Vector2d across = kHalf_m * Eigen::Vector2d(along.y(), along.x());
  const auto add = [&](double from_m, double to_m) {
    world.obstacles.push_back({{a_m + from_m * along - across, a_m + to_m * along + across}, 10.0});
  };
  add(0.0, door_m);
  add(door_m + kDoor_m, length_m);
}

// Nine rooms of 8 × 8 m with doors.
OwnedProblem draw_rooms(std::uint64_t seed) {
  std::mt19937_64 random = random_of(3, seed);
  OwnedProblem owned = empty_problem({12.0, 12.0}, 24);
  for (const double wall_m : {-4.0, 4.0}) {
    for (const double from_m : {-12.0, -4.0, 4.0}) {
      add_wall_with_door(*owned.world, random, {wall_m, from_m}, {wall_m, from_m + 8.0});
      add_wall_with_door(*owned.world, random, {from_m, wall_m}, {from_m + 8.0, wall_m});
    }
  }
  add_field(owned, 0.05);
  SearchProblem& problem = owned.problem;
  const Eigen::Vector2d start_m = draw_free(random, *owned.world, 1.0);
  problem.start = {start_m.x(), start_m.y(), uniform(random, -kPi, kPi)};
  problem.sensors = {sensor_of(models::SensorKind::kRangeBearing, 5.0, 94.0)};
  const int targets = draw_integer(random, 3, 12);
  for (int m = 0; m < targets; ++m) {
    add_mover(problem, random, draw_free(random, *owned.world, 0.3), 0.1, 1.0);
  }
  return owned;
}

// Four corridors of 40 m that are connected alternately at their ends.
OwnedProblem draw_corridors(std::uint64_t seed) {
  std::mt19937_64 random = random_of(4, seed);
  OwnedProblem owned = empty_problem({20.0, 7.0}, 48);
  const auto add_wall = [&](double x_min_m, double x_max_m, double y_m) {
    owned.world->obstacles.push_back({{{x_min_m, y_m - 0.15}, {x_max_m, y_m + 0.15}}, 10.0});
  };
  add_wall(-20.0, 17.5, -3.5);
  add_wall(-17.5, 20.0, 0.0);
  add_wall(-20.0, 17.5, 3.5);
  add_field(owned, 0.05);
  SearchProblem& problem = owned.problem;
  const Eigen::Vector2d start_m = draw_free(random, *owned.world, 1.0);
  problem.start = {start_m.x(), start_m.y(), random() % 2 == 0 ? 0.0 : kPi};
  problem.sensors = {sensor_of(models::SensorKind::kRangeBearing, 5.0, 94.0)};
  const int targets = draw_integer(random, 2, 10);
  for (int m = 0; m < targets; ++m) {
    add_mover(problem, random, draw_free(random, *owned.world, 0.3), 0.05, 1.0);
  }
  return owned;
}

OwnedProblem draw_bearings(std::uint64_t seed) {
  std::mt19937_64 random = random_of(5, seed);
  OwnedProblem owned = empty_problem({32.0, 32.0}, draw_integer(random, 12, 24));
  add_field(owned, 0.2);
  owned.problem.sensors = {sensor_of(models::SensorKind::kBearing, 15.0, 94.0)};
  owned.problem.sensors[0].range_min_m = 0.5;
  const int targets = draw_integer(random, 1, 9);
  for (int m = 0; m < targets; ++m) {
    SearchTarget target{{models::TargetKind::kRandomWalk, 2, 0.01}, {}};
    target.prior.mean = draw_position(random, {18.0, 18.0});
    target.prior.covariance = 4.0 * Eigen::Matrix2d::Identity();
    owned.problem.targets.push_back(target);
  }
  return owned;
}

// Steps of 1 s, so that 120 steps are two minutes.
OwnedProblem draw_long(std::uint64_t seed) {
  std::mt19937_64 random = random_of(6, seed);
  OwnedProblem owned = empty_problem({100.0, 100.0}, draw_integer(random, 30, 120));
  owned.problem.step_s = 1.0;
  add_field(owned, 0.5);
  owned.problem.sensors = {sensor_of(models::SensorKind::kRangeBearing, 20.0, 360.0)};
  const int targets = draw_integer(random, 5, 25);
  for (int m = 0; m < targets; ++m) {
    add_mover(owned.problem, random, draw_position(random, {90.0, 90.0}), 0.1, 9.0);
  }
  return owned;
}

}  // namespace

const std::vector<SearchFamily>& search_families() {
  static const std::vector<SearchFamily> families = {
      {"tracking-dense", "9 to 25 moving targets within 14 m, 6 s", draw_dense},
      {"tracking-sparse", "1 to 5 moving targets within 28 m, 6 to 15 s", draw_sparse},
      {"landmarks", "mapping of six landmarks by ranges between three boxes, 6 s",
       random_start_problem},
      {"rooms", "3 to 12 targets in nine rooms with doors, 12 s", draw_rooms},
      {"corridors", "2 to 10 targets in four connected corridors of 40 m, 24 s", draw_corridors},
      {"bearing-only", "1 to 9 random walks, bearings only, 6 to 12 s", draw_bearings},
      {"long", "5 to 25 moving targets in 200 × 200 m, 30 to 120 s", draw_long},
  };
  return families;
}

}  // namespace vantage::experiments
