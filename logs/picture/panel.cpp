#include "logs/picture/panel.hpp"

#include <algorithm>
#include <initializer_list>
#include <string>

#include <fmt/format.h>

#include "logs/picture/map_layer.hpp"

namespace vantage::logs {
namespace {

constexpr std::string_view kBody = R"(font-size="13.5" fill="#202124")";
constexpr std::string_view kBodyEnd = R"(font-size="13.5" fill="#202124" text-anchor="end")";
constexpr std::string_view kHead = R"(font-size="15" font-weight="bold" fill="#202124")";
constexpr std::string_view kMutedEnd = R"(font-size="12.5" fill="#5f6368" text-anchor="end")";
constexpr std::string_view kMuted = R"(font-size="12.5" fill="#5f6368")";

constexpr std::size_t kTargetRowsMax = 12;
constexpr std::size_t kRobotColumns = 4;
constexpr double kRobotColumn_px = 86.0;
constexpr double kTargetRow_px = 20.0;
constexpr double kLegendRow_px = 24.0;

std::string number_or_dash(const std::optional<double>& value, std::string_view format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "–";
}

struct Column {
  double x_px;  ///< px; right end of the column, from the table's left end
  const char* head;
};

/// Draws a table's title, column heads and line. Returns the y position of the first row.
double draw_table_head(Svg& svg, const Eigen::Vector2d& corner_px, const char* title,
                       const char* names, std::initializer_list<Column> columns) {
  const double x_px = corner_px.x();
  double y_px = corner_px.y() + 14.0;
  svg.text({x_px, y_px}, title, kHead);
  y_px += 24.0;
  svg.text({x_px, y_px}, names, kMuted);
  for (const Column& column : columns) {
    svg.text({x_px + column.x_px, y_px}, column.head, kMutedEnd);
  }
  y_px += 8.0;
  svg.line({x_px, y_px}, {x_px + 325.0, y_px}, "stroke=\"#dadce0\"");
  return y_px;
}

double draw_target_table(Svg& svg, const Eigen::Vector2d& corner_px,
                         const scenario::Scenario& scenario, const logs::TrialSummary& summary) {
  const double x_px = corner_px.x();
  double y_px = draw_table_head(svg, corner_px, "Targets", "name",
                                {{150.0, "found"}, {225.0, "RMSE"}, {325.0, "entropy"}});
  const std::size_t rows =
      std::min({scenario.targets.size(), summary.discovery_time_s.size(), kTargetRowsMax});
  for (std::size_t i = 0; i < rows; ++i) {
    y_px += kTargetRow_px;
    svg.text({x_px, y_px}, scenario.targets[i].name, kBody);
    svg.text({x_px + 150.0, y_px}, number_or_dash(summary.discovery_time_s[i], "{:.1f} s"),
             kBodyEnd);
    svg.text({x_px + 225.0, y_px}, number_or_dash(summary.rmse_per_target_m[i], "{:.2f} m"),
             kBodyEnd);
    svg.text({x_px + 325.0, y_px}, fmt::format("{:.2f} nat", summary.entropy_per_target_nats[i]),
             kBodyEnd);
  }
  if (scenario.targets.size() > rows) {
    y_px += kTargetRow_px;
    svg.text({x_px, y_px}, fmt::format("and {} more", scenario.targets.size() - rows), kMuted);
  }
  return y_px;
}

bool is_mapping(const scenario::Scenario& scenario) {
  return scenario.planner.objective == scenario::PlanObjective::kMapping;
}

double draw_map_table(Svg& svg, const Eigen::Vector2d& corner_px,
                      const scenario::Scenario& scenario, const Scene& scene,
                      const logs::TrialSummary& summary) {
  const double x_px = corner_px.x();
  double y_px = draw_table_head(svg, corner_px, "Maps", "as known by", {{225.0, "entropy"}});
  const auto row = [&](const std::string& name, const std::optional<double>& entropy_nats,
                       const std::string& note) {
    y_px += kTargetRow_px;
    svg.text({x_px, y_px}, name, kBody);
    svg.text({x_px + 225.0, y_px}, number_or_dash(entropy_nats, "{:.0f} nat"), kBodyEnd);
    svg.text({x_px + 325.0, y_px}, note,
             fmt::format(R"(font-size="13.5" text-anchor="end" fill="{}")", role_colour("jammed")));
  };
  for (std::size_t i = 0; i < std::min(scenario.robots.size(), kTargetRowsMax - 1); ++i) {
    const std::string& name = scenario.robots[i].name;
    const auto found = scene.map_entropies_nats.find(name);
    row(name, found == scene.map_entropies_nats.end() ? std::nullopt : std::optional(found->second),
        scene.jammed.contains(name) ? "jammed" : "");
  }
  row("mean", summary.map_entropy_nats, "");
  return y_px;
}

class Legend {
 public:
  Legend(Svg& svg, const Eigen::Vector2d& corner_px) : svg_(svg), at_px_(corner_px) {
    svg_.text(at_px_ + Eigen::Vector2d(0, 14), "Legend", kHead);
    at_px_.y() += 36.0;
  }
  /// Writes the text of appearance.json for `glyph`, followed by `more`. Returns the centre of the
  /// entry's symbol.
  Eigen::Vector2d entry(const char* glyph, std::string_view more = "") {
    svg_.text(at_px_ + Eigen::Vector2d(44, 4.5),
              fmt::format("{}{}", logs::appearance().glyphs.at(glyph), more), kBody);
    const Eigen::Vector2d symbol_px = at_px_ + Eigen::Vector2d(16, 0);
    at_px_.y() += kLegendRow_px;
    return symbol_px;
  }
  /// Draws all robots, several per row.
  void robots(const std::vector<scenario::RobotSpec>& robots) {
    for (std::size_t i = 0; i < robots.size(); ++i) {
      const auto column = static_cast<double>(i % kRobotColumns);
      const auto row = static_cast<double>(i / kRobotColumns);
      const Eigen::Vector2d p_px =
          at_px_ + Eigen::Vector2d(10.0 + kRobotColumn_px * column, kTargetRow_px * row);
      draw_robot(svg_, p_px, 0.0, 6.5, robot_colour(i), robot_core_colour(i));
      svg_.text(p_px + Eigen::Vector2d(16, 4.5), robots[i].name, kBody);
    }
    at_px_.y() +=
        kTargetRow_px * static_cast<double>((robots.size() + kRobotColumns - 1) / kRobotColumns) +
        6.0;
  }

 private:
  Svg& svg_;
  Eigen::Vector2d at_px_;
};

// Long function: it draws the entries of the legend in order.
void draw_legend(Svg& svg, const Eigen::Vector2d& corner_px, const scenario::Scenario& scenario,
                 const Scene& scene) {
  const Eigen::Vector2d dx(14, 0);
  const std::string_view first = robot_colour(0);
  Legend legend(svg, corner_px);
  legend.robots(scenario.robots);
  Eigen::Vector2d p_px;
  if (!scene.jammed.empty()) {
    draw_robot(svg, legend.entry("jammed"), 0.0, 7.0, role_colour("jammed"), first);
  }
  p_px = legend.entry("trail", fmt::format(" {:g} s", recent_s()));
  svg.line(p_px - dx, p_px + dx, fmt::format("stroke=\"{}\" stroke-width=\"2.6\"", first));
  p_px = legend.entry("plan");
  svg.line(p_px - dx, p_px + dx,
           fmt::format(R"(stroke="{}" stroke-width="2.2" stroke-dasharray="2 5" )"
                       R"(stroke-linecap="round")",
                       first));
  svg.circle(p_px + dx, 4.0,
             fmt::format("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"1.8\"", first));
  p_px = legend.entry("view");
  svg.circle(
      p_px, 9.0,
      fmt::format(R"(fill="{0}" fill-opacity="0.08" stroke="{0}" stroke-dasharray="4 3")", first));
  if (!scenario.targets.empty()) {
    p_px = legend.entry("truth");
    svg.polygon({p_px + Eigen::Vector2d(0, -6), p_px + Eigen::Vector2d(6, 0),
                 p_px + Eigen::Vector2d(0, 6), p_px + Eigen::Vector2d(-6, 0)},
                fmt::format("fill=\"{}\"", role_colour("truth")));
    p_px = legend.entry("estimate");
    svg.ellipse(p_px, {14, 8}, 0.0,
                fmt::format(R"(fill="{0}" fill-opacity="0.14" stroke="{0}" stroke-width="1.6")",
                            role_colour("estimate")));
    const std::string cross =
        fmt::format("stroke=\"{}\" stroke-width=\"2\"", role_colour("estimate"));
    svg.line(p_px - Eigen::Vector2d(4, 4), p_px + Eigen::Vector2d(4, 4), cross);
    svg.line(p_px - Eigen::Vector2d(4, -4), p_px + Eigen::Vector2d(4, -4), cross);
  }
  const auto swatch = [&](const char* glyph, const char* role, std::string_view more = "") {
    const Eigen::Vector2d centre_px = legend.entry(glyph, more);
    svg.rectangle(centre_px - Eigen::Vector2d(14, 8), {28, 16},
                  fmt::format("fill=\"{}\" stroke=\"#bdc1c6\"", role_colour(role)));
  };
  if (scene.map) {
    swatch("occupied", "occupied");
    swatch("free", "free");
    swatch("unknown", "unseen");
  } else {
    swatch("seen", "seen");
    if (scenario.estimator.grid_memory_s > 0.0) {
      swatch("stale", "stale", fmt::format(" {:g} s", scenario.estimator.grid_memory_s));
    }
    swatch("unseen", "unseen");
  }
  if (!scenario.world.obstacles.empty()) {
    const Eigen::Vector2d centre_px = legend.entry("obstacle");
    svg.rectangle(centre_px - Eigen::Vector2d(14, 8), {28, 16},
                  scene.map ? fmt::format(R"(fill="none" stroke="{}" stroke-dasharray="5 3")",
                                          role_colour("wall"))
                            : fmt::format(R"(fill="{}" stroke="{}")", role_colour("obstacle"),
                                          role_colour("wall")));
  }
}

}  // namespace

double panel_height_px(const scenario::Scenario& scenario) {
  constexpr double kHeads_px = 46.0 + 30.0 + 36.0;
  constexpr std::size_t kLegendRowsBesideRobots = 10;
  const std::size_t rows = is_mapping(scenario)
                               ? std::min(scenario.robots.size() + 1, kTargetRowsMax)
                               : std::min(scenario.targets.size(), kTargetRowsMax + 1);
  const std::size_t robot_rows = (scenario.robots.size() + kRobotColumns - 1) / kRobotColumns;
  return kHeads_px + kTargetRow_px * static_cast<double>(rows + robot_rows) + 6.0 +
         kLegendRow_px * static_cast<double>(kLegendRowsBesideRobots);
}

void draw_header(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const logs::TrialSummary& summary, KeyNumbers numbers) {
  const double x_px = layout.map_corner_px.x();
  constexpr std::string_view kTitle = R"(font-size="22" font-weight="bold" fill="#202124")";
  constexpr std::string_view kNumbers = R"(font-size="14" fill="#3c4043")";
  const std::string found = is_mapping(scenario) ? "map after"
                                                 : fmt::format("{} of {} targets found in",
                                                               summary.discovered, summary.targets);
  const std::string known =
      is_mapping(scenario)
          ? fmt::format("map entropy {}", number_or_dash(summary.map_entropy_nats, "{:.0f} nat"))
          : fmt::format("RMSE {} · entropy {:.2f} nat", number_or_dash(summary.rmse_m, "{:.2f} m"),
                        summary.entropy_nats);
  if (numbers == KeyNumbers::kEstimate) {
    svg.text({x_px, 34.0}, fmt::format("{}: after {:g} s", summary.scenario, summary.duration_s),
             kTitle);
    svg.text({x_px, 60.0}, fmt::format("seed {} · {}", summary.seed, known), kNumbers);
    return;
  }
  svg.text({x_px, 34.0},
           fmt::format("{}: {} {:.0f} s", summary.scenario, found, summary.duration_s), kTitle);
  svg.text({x_px, 60.0},
           fmt::format("{}, seed {} · {} · {} collisions · {} near "
                       "misses · least separation {} · {} of {} rounds late",
                       summary.algorithm, summary.seed, known, summary.collisions,
                       summary.separation_violations,
                       number_or_dash(summary.min_separation_m, "{:.2f} m"), summary.rounds_late,
                       summary.rounds),
           kNumbers);
}

void draw_panel(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                const Scene& scene, const logs::TrialSummary& summary) {
  const double table_end_px =
      is_mapping(scenario) ? draw_map_table(svg, layout.panel_corner_px, scenario, scene, summary)
                           : draw_target_table(svg, layout.panel_corner_px, scenario, summary);
  draw_legend(svg, {layout.panel_corner_px.x(), table_end_px + 30.0}, scenario, scene);
}

}  // namespace vantage::logs
