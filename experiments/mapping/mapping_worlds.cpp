#include "experiments/mapping/mapping_worlds.hpp"

#include <utility>

namespace vantage::experiments {
namespace {

constexpr double kHeight_m = 3.0;

constexpr double kDrawn_m = 24.0;  // m; side of the square to which the box coordinates below refer

models::World scaled(models::World world, double side_m) {
  const double scale = side_m / kDrawn_m;
  for (models::Obstacle& obstacle : world.obstacles) {
    obstacle.footprint.min_m *= scale;
    obstacle.footprint.max_m *= scale;
  }
  world.bounds.max_m *= scale;
  return world;
}

void add_box(models::World& world, double x0_m, double y0_m, double x1_m, double y1_m) {
  world.obstacles.push_back({{{x0_m, y0_m}, {x1_m, y1_m}}, kHeight_m});
}

}  // namespace

models::World square_obstacles_world(double side_m) {
  models::World world{{{0.0, 0.0}, {kDrawn_m, kDrawn_m}}, kHeight_m, {}, {}};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double x_m = 2.27 + 5.8 * column + 0.31 * (row % 2);
      const double y_m = 2.13 + 5.8 * row + 0.37 * (column % 2);
      add_box(world, x_m, y_m, x_m + 2.0, y_m + 2.0);
    }
  }
  return scaled(std::move(world), side_m);
}

models::World corridor_world(double side_m) {
  models::World world{{{0.0, 0.0}, {kDrawn_m, kDrawn_m}}, kHeight_m, {}, {}};
  // A ring and a cross of corridors around four blocks; two are solid, two are rooms with a door.
  add_box(world, 2.53, 2.53, 10.61, 10.53);
  add_box(world, 13.39, 13.43, 21.47, 21.51);
  const double t_m = 0.43;  // m; wall thickness
  add_box(world, 13.39, 2.53, 21.47, 2.53 + t_m);
  add_box(world, 13.39, 10.13, 21.47, 10.53);
  add_box(world, 13.39, 2.53, 13.39 + t_m, 5.33);
  add_box(world, 13.39, 7.53, 13.39 + t_m, 10.53);
  add_box(world, 21.07, 2.53, 21.47, 10.53);
  add_box(world, 2.53, 13.43, 10.61, 13.43 + t_m);
  add_box(world, 2.53, 21.11, 10.61, 21.51);
  add_box(world, 2.53, 13.43, 2.53 + t_m, 21.51);
  add_box(world, 10.21, 13.43, 10.61, 16.43);
  add_box(world, 10.21, 18.63, 10.61, 21.51);
  // One obstacle in each room.
  add_box(world, 16.93, 5.77, 18.07, 7.17);
  add_box(world, 5.83, 16.67, 7.07, 18.03);
  return scaled(std::move(world), side_m);
}

}  // namespace vantage::experiments
