#include "experiments/mapping/mapping_rows.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "experiments/sweep/sample.hpp"
#include "models/world/grid.hpp"

namespace vantage::experiments {
namespace {

constexpr const char* kShades = "0123456789abcdefghijklmnopqrstuvwxyz";
constexpr int kShadeMax = 35;

char shade_of(double occupancy) {
  return kShades[std::clamp(static_cast<int>(std::lround(kShadeMax * occupancy)), 0, kShadeMax)];
}

// Returns the cells of a row as the numbers of a gnuplot matrix.
std::string matrix_line(const std::string& cells) {
  std::string line;
  for (const char cell : cells) {
    const int shade = cell <= '9' ? cell - '0' : cell - 'a' + 10;
    line += fmt::format("{:.3f} ", static_cast<double>(shade) / kShadeMax);
  }
  return line + "\n";
}

std::string truth_text(const models::World& world, double resolution_m) {
  const models::OccupancyGrid grid = models::rasterise(world, resolution_m);
  std::string text;
  for (int row = 0; row < grid.geometry.rows; ++row) {
    std::string cells;
    for (int column = 0; column < grid.geometry.columns; ++column) {
      const int cell = row * grid.geometry.columns + column;
      cells += grid.occupied[static_cast<std::size_t>(cell)] != 0 ? 'z' : '0';
    }
    text += matrix_line(cells);
  }
  return text;
}

}  // namespace

void add_map_rows(UnitRows& rows, const std::string& name, const models::OccupancyBelief& map) {
  for (int row = 0; row < map.geometry().rows; ++row) {
    std::string cells;
    for (int column = 0; column < map.geometry().columns; ++column) {
      cells += shade_of(map.occupancy(row * map.geometry().columns + column));
    }
    rows.tables["maps"].push_back(fmt::format("{},{},{}", name, row, cells));
  }
}

void add_path_rows(UnitRows& rows, const MappingOutcome& outcome) {
  for (std::size_t robot = 0; robot < outcome.steps.front().poses.size(); ++robot) {
    for (std::size_t t = 0; t < outcome.steps.size(); ++t) {
      const MappingStep& step = outcome.steps[t];
      const bool is_attacked =
          std::binary_search(step.attacked.begin(), step.attacked.end(), static_cast<int>(robot));
      rows.tables["ways"].push_back(fmt::format("{},{},{:.3f},{:.3f},{}", robot, t,
                                                step.poses[robot].x_m, step.poses[robot].y_m,
                                                is_attacked ? 1 : 0));
    }
  }
}

std::map<std::string, std::string> map_files(const Tables& tables,
                                             const std::map<std::string, models::World>& worlds,
                                             const SettingCells& setting_cells) {
  std::map<std::string, std::string> files;
  for (const auto& [name, world] : worlds) {
    files[name + "_truth.txt"] = truth_text(world, MappingSetup{}.resolution_m);
  }
  for (const Record& record : tables.at("maps")) {
    if (record.unit.trial == 0) {
      const std::string world = cells_of(setting_cells(record.unit.setting)).front();
      files[world + "_" + record.cells[0] + ".txt"] += matrix_line(record.cells[2]);
    }
  }
  for (const Record& record : tables.at("ways")) {
    if (record.unit.trial == 0) {
      const std::string world = cells_of(setting_cells(record.unit.setting)).front();
      std::string& file = files[world + "_ways.txt"];
      if (record.cells[1] == "0" && !file.empty()) {
        file += "\n\n";  // separates two robots
      }
      file += fmt::format("{} {} {} {}\n", record.cells[1], record.cells[2], record.cells[3],
                          record.cells[4]);
    }
  }
  return files;
}

std::string entropy_curves(const Tables& tables, const SettingCells& setting_cells) {
  std::map<std::pair<std::size_t, int>, Sample> curves;
  for (const Record& record : tables.at("entropy")) {
    curves[{record.unit.setting, static_cast<int>(record.number(0))}].add(record.number(1));
  }
  std::string text = "world,attack,attacks,variant,planner,step,entropy_nats,ci95\n";
  for (const auto& [at, entropy_nats] : curves) {
    text += fmt::format("{},{},{:.3f},{:.3f}\n", setting_cells(at.first), at.second,
                        entropy_nats.mean(), entropy_nats.half_interval());
  }
  return text;
}

}  // namespace vantage::experiments
