#include "python/task/mapping_task.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "experiments/mapping/mapping_worlds.hpp"
#include "python/task/observation.hpp"

namespace vantage::python {
namespace {

experiments::MappingSetup setup_of(const MappingTaskSpec& spec) {
  require(spec.world == "pillars" || spec.world == "corridors",
          fmt::format("world: must be one of pillars, corridors, got {}", spec.world));
  require(spec.side_m >= 8.0 && spec.side_m <= 64.0,
          fmt::format("side_m: must be ≥ 8 and ≤ 64, got {}", spec.side_m));
  require(spec.patch_cells >= 1 && spec.patch_cells <= 256,
          fmt::format("patch_cells: must be ≥ 1 and ≤ 256, got {}", spec.patch_cells));
  experiments::MappingSetup setup;
  setup.world = spec.world == "pillars" ? experiments::square_obstacles_world(spec.side_m)
                                        : experiments::corridor_world(spec.side_m);
  setup.robots = spec.robots;
  return setup;
}

}  // namespace

MappingTask::MappingTask(const MappingTaskSpec& spec)
    : TeamTask(spec.robots, spec.episode_steps, spec.jammer), spec_(spec), setup_(setup_of(spec)) {}

std::vector<ObservationPart> MappingTask::observation_parts() const {
  return {{"self", {kSelfEntries}},
          {"teammates", {robots() - 1, kTeammateEntries}},
          {"map", {spec_.patch_cells, spec_.patch_cells}}};
}

int MappingTask::observation_size() const {
  return kSelfEntries + kTeammateEntries * (robots() - 1) + spec_.patch_cells * spec_.patch_cells;
}

void MappingTask::on_reset(std::uint64_t seed) {
  ground_.emplace(setup_, seed);
  const models::OccupancyBelief& map = ground_->map();
  const auto cells = static_cast<std::size_t>(map.geometry().size());
  cell_log_odds_.assign(cells, 0.0);
  cell_nats_.assign(cells, map.entropy_nats(0));
  entropy_nats_ = map.entropy_nats(0) * static_cast<double>(cells);
  update_beliefs();
}

double MappingTask::on_step(std::span<const std::int64_t> actions) {
  const double before_nats = entropy_nats_;
  for (std::size_t robot = 0; robot < actions.size(); ++robot) {
    ground_->drive(robot, setup_.search.controls[index(actions[robot])]);
  }
  update_beliefs();
  return before_nats - entropy_nats_;
}

void MappingTask::update_beliefs() {
  attacked_.clear();
  for (int robot = 0; robot < robots(); ++robot) {
    if (jammed()[index(robot)] != 0) {
      attacked_.push_back(robot);
    }
  }
  ground_->observe(attacked_);
  for (std::size_t robot = 0; robot < seen().size(); ++robot) {
    seen()[robot] += learn_around(robot);
  }
}

double MappingTask::learn_around(std::size_t robot) {
  const models::OccupancyBelief& map = ground_->map();
  const models::GridGeometry& grid = map.geometry();
  const Eigen::Vector2d at_m = ground_->poses()[robot].position_m() - grid.origin_m;
  // A hit marks the cell at up to 2 σ beyond the measured range, which itself has noise.
  const double reach_m = setup_.scanner.range_max_m + 3.0 * setup_.scanner.sigma_m;
  const auto cell_of = [&](double along_m, int count) {
    return std::clamp(static_cast<int>(std::floor(along_m / grid.resolution_m)), 0, count - 1);
  };
  double learnt_nats = 0.0;
  for (int row = cell_of(at_m.y() - reach_m, grid.rows);
       row <= cell_of(at_m.y() + reach_m, grid.rows); ++row) {
    for (int column = cell_of(at_m.x() - reach_m, grid.columns);
         column <= cell_of(at_m.x() + reach_m, grid.columns); ++column) {
      const int cell = row * grid.columns + column;
      const auto at = index(cell);
      if (map.log_odds(cell) == cell_log_odds_[at]) {
        continue;
      }
      cell_log_odds_[at] = map.log_odds(cell);
      const double nats = map.entropy_nats(cell);
      learnt_nats += cell_nats_[at] - nats;
      cell_nats_[at] = nats;
    }
  }
  entropy_nats_ -= learnt_nats;
  return learnt_nats;
}

void MappingTask::observe(int robot, std::span<float> out) const {
  const auto self = index(robot);
  const auto head = static_cast<std::size_t>(kSelfEntries + kTeammateEntries * (robots() - 1));
  ObservationWriter writer(out);
  const std::vector<Pose2>& poses = ground_->poses();
  add_team(writer, setup_.world.bounds, poses, self, jammed()[self] != 0);
  const models::OccupancyBelief& map = ground_->map();
  const models::GridGeometry& grid = map.geometry();
  const Eigen::Vector2d at_m = poses[self].position_m() - grid.origin_m;
  const int middle_column = static_cast<int>(std::floor(at_m.x() / grid.resolution_m));
  const int middle_row = static_cast<int>(std::floor(at_m.y() / grid.resolution_m));
  const int side = spec_.patch_cells;
  float* cell_out = &out[head];
  for (int i = 0; i < side; ++i) {
    const int row = middle_row - side / 2 + i;
    for (int j = 0; j < side; ++j) {
      const int column = middle_column - side / 2 + j;
      const bool is_inside = row >= 0 && row < grid.rows && column >= 0 && column < grid.columns;
      *cell_out++ = is_inside
                        ? static_cast<float>(2.0 * map.occupancy(row * grid.columns + column) - 1.0)
                        : 1.0F;
    }
  }
}

}  // namespace vantage::python
