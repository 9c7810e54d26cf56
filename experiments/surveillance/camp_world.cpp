#include "experiments/surveillance/camp_world.hpp"

#include <array>

namespace vantage::experiments {
namespace {

constexpr double kLowest_m = 5.5;
constexpr double kApart_m = 1.0;
constexpr double kAboveRoof_m = 1.0;
constexpr double kTrunk_m = 1.5;  // m; edge of a tree's box, crown included

struct Building {
  double x_m, y_m, width_m, depth_m, height_m;  // x, y: minimum corner
};

constexpr std::array<Building, 15> kBuildings = {{
    {8.0, 70.0, 14.0, 8.0, 4.0},     // barracks, northern row
    {32.0, 70.0, 14.0, 8.0, 4.0},    //
    {56.0, 72.0, 14.0, 8.0, 4.0},    //
    {79.0, 69.0, 14.0, 8.0, 4.0},    //
    {103.0, 66.0, 10.0, 14.0, 6.0},  // hall
    {12.0, 46.0, 14.0, 8.0, 4.0},    // barracks, southern row
    {36.0, 47.0, 12.0, 8.0, 5.0},    //
    {88.0, 45.0, 14.0, 8.0, 5.0},    //
    {54.0, 24.0, 14.0, 9.0, 7.0},    // headquarters
    {82.0, 21.0, 14.0, 10.0, 5.0},   // mess
    {10.0, 20.0, 10.0, 14.0, 5.0},   // motor pool
    {33.0, 8.0, 10.0, 9.0, 6.0},     // workshop
    {64.0, 5.0, 8.0, 8.0, 3.0},      // store
    {104.0, 6.0, 7.0, 6.0, 3.0},     // gatehouse
    {108.0, 42.0, 4.0, 4.0, 9.0},    // water tower
}};

struct Tree {
  double x_m, y_m, height_m;  // x, y: centre
};

constexpr std::array<Tree, 24> kTrees = {{
    {5.0, 62.0, 8.0},  {17.0, 62.0, 9.0},  {29.0, 63.0, 8.0},   {41.0, 62.0, 10.0},
    {53.0, 64.0, 9.0}, {66.0, 63.0, 8.0},  {77.0, 61.0, 10.0},  {97.0, 61.0, 9.0},
    {5.0, 38.0, 9.0},  {28.0, 39.0, 8.0},  {44.0, 38.0, 10.0},  {56.0, 40.0, 8.0},
    {70.0, 41.0, 9.0}, {82.0, 38.0, 10.0}, {100.0, 37.0, 8.0},  {26.0, 26.0, 9.0},
    {42.0, 27.0, 8.0}, {74.0, 30.0, 10.0}, {104.0, 24.0, 9.0},  {22.0, 6.0, 8.0},
    {52.0, 11.0, 9.0}, {84.0, 8.0, 8.0},   {114.0, 56.0, 10.0}, {51.0, 84.0, 9.0},
}};

}  // namespace

models::World camp_world() {
  models::World world{{{0.0, 0.0}, {120.0, 90.0}}, 20.0, {}, {}};
  for (const Building& of : kBuildings) {
    world.obstacles.push_back(
        {{{of.x_m, of.y_m}, {of.x_m + of.width_m, of.y_m + of.depth_m}}, of.height_m});
  }
  for (const Tree& of : kTrees) {
    constexpr double kHalf_m = 0.5 * kTrunk_m;
    world.obstacles.push_back(
        {{{of.x_m - kHalf_m, of.y_m - kHalf_m}, {of.x_m + kHalf_m, of.y_m + kHalf_m}},
         of.height_m});
  }
  return world;
}

std::vector<models::PositionVector> camp_landmarks_m() {
  std::vector<models::PositionVector> landmarks_m;
  for (const Building& of : kBuildings) {
    landmarks_m.push_back(Eigen::Vector3d(of.x_m + 0.5 * of.width_m, of.y_m + 0.5 * of.depth_m,
                                          of.height_m + kAboveRoof_m));
  }
  return landmarks_m;
}

double camp_height_m(int robot) { return kLowest_m + kApart_m * robot; }

}  // namespace vantage::experiments
