#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "logs/picture/map_layer.hpp"
#include "models/mapping/cell_counts.hpp"

namespace vantage::logs {
namespace {

// Draws runs of equal cells in a row as one rectangle, because a field may have 65 000 cells.
void draw_cells(Svg& svg, const Layout& layout, const Scene& scene, double memory_s) {
  const models::GridGeometry& grid = scene.grid;
  const auto kind_of = [&](int index) {
    const std::int64_t seen = scene.last_seen_utime[static_cast<std::size_t>(index)];
    if (seen == models::VisibilityGrid::kNeverSeen) {
      return 0;
    }
    const bool fresh = memory_s <= 0.0 || to_seconds(scene.time - from_utime(seen)) <= memory_s;
    return fresh ? 2 : 1;
  };
  svg.open_group(R"(shape-rendering="crispEdges" class="explored")");
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns;) {
      const int kind = kind_of(row * grid.columns + column);
      int end = column + 1;
      while (end < grid.columns && kind_of(row * grid.columns + end) == kind) {
        ++end;
      }
      if (kind > 0) {
        const Eigen::Vector2d top_left_m =
            grid.origin_m + grid.resolution_m * Eigen::Vector2d(column, row + 1);
        const Eigen::Vector2d size_px =
            layout.px_per_m * grid.resolution_m * Eigen::Vector2d(end - column, 1.0);
        svg.rectangle(
            layout.page_from_world(top_left_m), size_px,
            fmt::format("fill=\"{}\"", kind == 2 ? role_colour("seen") : role_colour("stale")));
      }
      column = end;
    }
  }
  svg.close_group();
}

/// Number of shades of the occupancy. With few shades, many neighbouring cells are equal and can be
/// drawn as one rectangle.
constexpr int kShades = 8;

int mixed(int from, int to, double share) {
  return static_cast<int>(std::lround(from + (to - from) * share));
}

// Returns the colour of an occupancy in [0, 1], mixed from the colours of free, unseen and occupied
// ground.
std::string occupancy_colour(double p) {
  const auto channel = [](std::string_view colour, std::size_t i) {
    return std::stoi(std::string(colour.substr(1 + 2 * i, 2)), nullptr, 16);
  };
  const std::string_view from = role_colour(p < 0.5 ? "free" : "unseen");
  const std::string_view to = role_colour(p < 0.5 ? "unseen" : "occupied");
  const double share = p < 0.5 ? 2.0 * p : 2.0 * p - 1.0;
  return fmt::format("#{:02x}{:02x}{:02x}", mixed(channel(from, 0), channel(to, 0), share),
                     mixed(channel(from, 1), channel(to, 1), share),
                     mixed(channel(from, 2), channel(to, 2), share));
}

void draw_map(Svg& svg, const Layout& layout, const models::RobotMap& map,
              const models::MappingSpec& spec) {
  const models::OccupancyBelief belief = models::belief_of(map.grid, map.team_looks, spec);
  const auto shade_of = [&](int index) {
    return static_cast<int>(std::lround(belief.occupancy(index) * kShades));
  };
  svg.open_group(R"(shape-rendering="crispEdges" class="map")");
  for (int row = 0; row < map.grid.rows; ++row) {
    for (int column = 0; column < map.grid.columns;) {
      const int shade = shade_of(row * map.grid.columns + column);
      int end = column + 1;
      while (end < map.grid.columns && shade_of(row * map.grid.columns + end) == shade) {
        ++end;
      }
      const Eigen::Vector2d top_left_m =
          map.grid.origin_m + map.grid.resolution_m * Eigen::Vector2d(column, row + 1);
      const Eigen::Vector2d size_px =
          layout.px_per_m * map.grid.resolution_m * Eigen::Vector2d(end - column, 1.0);
      svg.rectangle(layout.page_from_world(top_left_m), size_px,
                    fmt::format("fill=\"{}\"", occupancy_colour(1.0 * shade / kShades)));
      column = end;
    }
  }
  svg.close_group();
}

double tick_spacing_m(double extent_m) {
  for (const double spacing_m : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    if (extent_m / spacing_m <= 9.0) {
      return spacing_m;
    }
  }
  return 100.0;
}

}  // namespace

void draw_ground(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const Scene& scene) {
  svg.rectangle(layout.map_corner_px, layout.map_size_px,
                fmt::format("fill=\"{}\"", role_colour("unseen")));
  if (scene.grid.size() > 0 && std::ssize(scene.last_seen_utime) == scene.grid.size()) {
    draw_cells(svg, layout, scene, scenario.estimator.grid_memory_s);
  }
  if (scene.map && scene.map->grid.size() == std::ssize(scene.map->team_looks)) {
    draw_map(svg, layout, *scene.map, scenario.mapping);
  }
  for (const models::Region& region : scenario.world.regions) {
    const models::Rectangle& r = region.footprint;
    svg.rectangle(
        layout.page_from_world({r.min_m.x(), r.max_m.y()}), layout.px_per_m * (r.max_m - r.min_m),
        fmt::format(R"(class="region" fill="{}" fill-opacity="0.25")", role_colour("region")));
  }
  for (const models::Obstacle& obstacle : scenario.world.obstacles) {
    const models::Rectangle& r = obstacle.footprint;
    svg.rectangle(layout.page_from_world({r.min_m.x(), r.max_m.y()}),
                  layout.px_per_m * (r.max_m - r.min_m),
                  fmt::format(R"(class="obstacle" fill="{}" {}stroke="{}" stroke-width="1.2")",
                              role_colour("obstacle"),
                              scene.map ? "fill-opacity=\"0\" stroke-dasharray=\"5 3\" " : "",
                              role_colour("wall")));
  }
}

void draw_axes(Svg& svg, const Layout& layout, const models::World& world) {
  const Eigen::Vector2d extent_m = world.bounds.max_m - world.bounds.min_m;
  const double spacing_m = tick_spacing_m(extent_m.maxCoeff());
  const double bottom_px = layout.map_corner_px.y() + layout.map_size_px.y();
  const double right_px = layout.map_corner_px.x() + layout.map_size_px.x();
  constexpr std::string_view kGrid = R"(stroke="#000000" stroke-opacity="0.06")";
  constexpr std::string_view kBelow = R"(text-anchor="middle" font-size="13" fill="#5f6368")";
  constexpr std::string_view kBeside = R"(text-anchor="end" font-size="13" fill="#5f6368")";
  const Eigen::Vector2d& min_m = world.bounds.min_m;
  for (double x_m = std::ceil(min_m.x() / spacing_m) * spacing_m;
       x_m <= world.bounds.max_m.x() + 1e-9; x_m += spacing_m) {
    const double x_px = layout.page_from_world({x_m, min_m.y()}).x();
    svg.line({x_px, layout.map_corner_px.y()}, {x_px, bottom_px}, kGrid);
    svg.text({x_px, bottom_px + 19.0}, fmt::format("{:g}", x_m), kBelow);
  }
  for (double y_m = std::ceil(min_m.y() / spacing_m) * spacing_m;
       y_m <= world.bounds.max_m.y() + 1e-9; y_m += spacing_m) {
    const double y_px = layout.page_from_world({min_m.x(), y_m}).y();
    svg.line({layout.map_corner_px.x(), y_px}, {right_px, y_px}, kGrid);
    svg.text({layout.map_corner_px.x() - 8.0, y_px + 4.5}, fmt::format("{:g}", y_m), kBeside);
  }
  svg.text({layout.map_corner_px.x() + 0.5 * layout.map_size_px.x(), bottom_px + 40.0}, "x (m)",
           kBelow);
  svg.text({16.0, layout.map_corner_px.y() - 10.0}, "y (m)", R"(font-size="13" fill="#5f6368")");
  svg.rectangle(layout.map_corner_px, layout.map_size_px,
                R"(class="bounds" fill="none" stroke="#3c4043" stroke-width="1.8")");
}

}  // namespace vantage::logs
