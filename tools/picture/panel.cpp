#include "tools/picture/panel.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "tools/picture/map_layer.hpp"

namespace vantage::tools {
namespace {

constexpr std::string_view kBody = R"(font-size="13.5" fill="#202124")";
constexpr std::string_view kBodyEnd = R"(font-size="13.5" fill="#202124" text-anchor="end")";
constexpr std::string_view kHead = R"(font-size="15" font-weight="bold" fill="#202124")";
constexpr std::string_view kMutedEnd = R"(font-size="12.5" fill="#5f6368" text-anchor="end")";
constexpr std::string_view kMuted = R"(font-size="12.5" fill="#5f6368")";

constexpr std::size_t kTargetRowsMax = 12;
constexpr std::size_t kRobotRowsMax = 6;
constexpr double kTargetRow_px = 20.0;
constexpr double kLegendRow_px = 24.0;

std::string number_or_dash(const std::optional<double>& value, std::string_view format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "–";
}

double draw_target_table(Svg& svg, const Eigen::Vector2d& corner_px,
                         const models::Scenario& scenario, const logs::TrialSummary& summary) {
  const double x_px = corner_px.x();
  double y_px = corner_px.y() + 14.0;
  svg.text({x_px, y_px}, "Targets", kHead);
  y_px += 24.0;
  svg.text({x_px, y_px}, "name", kMuted);
  svg.text({x_px + 150.0, y_px}, "found", kMutedEnd);
  svg.text({x_px + 225.0, y_px}, "RMSE", kMutedEnd);
  svg.text({x_px + 325.0, y_px}, "entropy", kMutedEnd);
  y_px += 8.0;
  svg.line({x_px, y_px}, {x_px + 325.0, y_px}, "stroke=\"#dadce0\"");
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

class Legend {
 public:
  Legend(Svg& svg, const Eigen::Vector2d& corner_px) : svg_(svg), at_px_(corner_px) {
    svg_.text(at_px_ + Eigen::Vector2d(0, 14), "Legend", kHead);
    at_px_.y() += 36.0;
  }
  /// Centre of the next entry's symbol; writes its words.
  Eigen::Vector2d entry(std::string_view words) {
    svg_.text(at_px_ + Eigen::Vector2d(44, 4.5), words, kBody);
    const Eigen::Vector2d symbol_px = at_px_ + Eigen::Vector2d(16, 0);
    at_px_.y() += kLegendRow_px;
    return symbol_px;
  }

 private:
  Svg& svg_;
  Eigen::Vector2d at_px_;
};

void draw_legend(Svg& svg, const Eigen::Vector2d& corner_px, const models::Scenario& scenario) {
  const Eigen::Vector2d dx(14, 0);
  Legend legend(svg, corner_px);
  for (std::size_t i = 0; i < std::min(scenario.robots.size(), kRobotRowsMax); ++i) {
    const Eigen::Vector2d p_px = legend.entry(
        fmt::format("{}: driven track, {:g} s strong", scenario.robots[i].name, kRecent_s));
    svg.line(p_px - dx, p_px + dx,
             fmt::format("stroke=\"{}\" stroke-width=\"2.6\"", robot_colour(i)));
  }
  const std::string_view first = robot_colour(0);
  Eigen::Vector2d p_px = legend.entry("plan, and the hover that ends it");
  svg.line(p_px - dx, p_px + dx,
           fmt::format(R"(stroke="{}" stroke-width="2.2" stroke-dasharray="2 5" )"
                       R"(stroke-linecap="round")",
                       first));
  svg.circle(p_px + dx, 4.0,
             fmt::format("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"1.8\"", first));
  p_px = legend.entry("field of view");
  svg.circle(
      p_px, 9.0,
      fmt::format(R"(fill="{0}" fill-opacity="0.08" stroke="{0}" stroke-dasharray="4 3")", first));
  p_px = legend.entry("target: truth and its track");
  svg.line(p_px - dx, p_px + dx,
           fmt::format("stroke=\"{}\" stroke-width=\"1.5\"", kTruthTrackColour));
  svg.polygon({p_px + Eigen::Vector2d(0, -6), p_px + Eigen::Vector2d(6, 0),
               p_px + Eigen::Vector2d(0, 6), p_px + Eigen::Vector2d(-6, 0)},
              fmt::format("fill=\"{}\"", kTruthColour));
  p_px = legend.entry("team estimate, 2σ ellipse, error");
  svg.ellipse(p_px, {14, 8}, 0.0,
              fmt::format(R"(fill="{0}" fill-opacity="0.14" stroke="{0}" stroke-width="1.6")",
                          kEstimateColour));
  const std::string cross = fmt::format("stroke=\"{}\" stroke-width=\"2\"", kEstimateColour);
  svg.line(p_px - Eigen::Vector2d(4, 4), p_px + Eigen::Vector2d(4, 4), cross);
  svg.line(p_px - Eigen::Vector2d(4, -4), p_px + Eigen::Vector2d(4, -4), cross);
  const auto swatch = [&](std::string_view words, std::string_view colour) {
    const Eigen::Vector2d centre_px = legend.entry(words);
    svg.rectangle(centre_px - Eigen::Vector2d(14, 8), {28, 16},
                  fmt::format("fill=\"{}\" stroke=\"#bdc1c6\"", colour));
  };
  swatch("explored", kExploredColour);
  if (scenario.estimator.grid_memory_s > 0.0) {
    swatch(fmt::format("seen more than {:g} s ago", scenario.estimator.grid_memory_s),
           kStaleColour);
  }
  swatch("never seen", kUnexploredColour);
  if (!scenario.world.obstacles.empty()) {
    swatch("obstacle", kObstacleColour);
  }
}

}  // namespace

double panel_height_px(const models::Scenario& scenario) {
  constexpr double kHeads_px = 46.0 + 30.0 + 36.0;
  constexpr std::size_t kLegendRowsBesideRobots = 8;
  const std::size_t target_rows = std::min(scenario.targets.size(), kTargetRowsMax + 1);
  const std::size_t robot_rows = std::min(scenario.robots.size(), kRobotRowsMax);
  return kHeads_px + kTargetRow_px * static_cast<double>(target_rows) +
         kLegendRow_px * static_cast<double>(robot_rows + kLegendRowsBesideRobots);
}

void draw_header(Svg& svg, const Layout& layout, const logs::TrialSummary& summary) {
  const double x_px = layout.map_corner_px.x();
  svg.text({x_px, 34.0},
           fmt::format("{}: {} of {} targets found in {:.0f} s", summary.scenario,
                       summary.discovered, summary.targets, summary.duration_s),
           R"(font-size="22" font-weight="bold" fill="#202124")");
  svg.text({x_px, 60.0},
           fmt::format("{}, seed {} · RMSE {} · entropy {:.2f} nat · {} collisions · {} near "
                       "misses · least separation {} · {} of {} rounds late",
                       summary.algorithm, summary.seed, number_or_dash(summary.rmse_m, "{:.2f} m"),
                       summary.entropy_nats, summary.collisions, summary.separation_violations,
                       number_or_dash(summary.min_separation_m, "{:.2f} m"), summary.rounds_late,
                       summary.rounds),
           R"(font-size="14" fill="#3c4043")");
}

void draw_panel(Svg& svg, const Layout& layout, const models::Scenario& scenario,
                const logs::TrialSummary& summary) {
  const double table_end_px = draw_target_table(svg, layout.panel_corner_px, scenario, summary);
  draw_legend(svg, {layout.panel_corner_px.x(), table_end_px + 30.0}, scenario);
}

}  // namespace vantage::tools
