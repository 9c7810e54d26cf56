#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "core/index.hpp"
#include "logs/picture/layout.hpp"
#include "logs/picture/map_layer.hpp"
#include "logs/picture/svg.hpp"
#include "models/plan/plan.hpp"
#include "tools/plan/plan_report.hpp"

namespace vantage::tools {
namespace {

using Points = std::vector<Eigen::Vector2d>;

std::string_view path_colour() { return logs::robot_colour(0); }

// Predicted path of one target's mean, and its covariance before the first and after the last step.
struct Course {
  Points mean_m;
  Eigen::Matrix2d before_m2;
  Eigen::Matrix2d after_m2;
};

Course course_of(const planner::SearchProblem& problem, const planner::SearchTarget& target,
                 const std::vector<Pose2>& poses) {
  models::Gaussian belief = target.prior;
  Course course;
  course.mean_m.emplace_back(belief.mean.head<2>());
  course.before_m2 = belief.covariance.topLeftCorner<2, 2>();
  for (const Pose2& pose : poses) {
    belief = models::predict(belief, target.model, problem.step_s);
    const models::PositionVector mean_m = belief.mean.head(2);
    models::PositionMatrix M = models::PositionMatrix::Zero(2, 2);
    if (models::line_of_sight(*problem.world, pose.position_m(), mean_m.head<2>())) {
      for (const models::SensorModel& sensor : problem.sensors) {
        const models::Viewpoint from{pose, problem.height_m};
        if (models::measures_velocity(sensor) && target.model.has_velocity()) {
          belief.covariance = models::update_state_covariance(
              belief.covariance, models::state_information(sensor, from, belief.mean));
        } else {
          M += models::information(sensor, from, mean_m);
        }
      }
    }
    belief.covariance = models::update_covariance(belief.covariance, M);
    course.mean_m.emplace_back(mean_m.head<2>());
  }
  course.after_m2 = belief.covariance.topLeftCorner<2, 2>();
  return course;
}

void draw_ellipse(logs::Svg& svg, const logs::Layout& layout, const Eigen::Vector2d& mean_m,
                  const Eigen::Matrix2d& covariance_m2, std::string_view style) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance_m2);
  const Eigen::Vector2d half_px = logs::appearance().ellipse_radius() * layout.px_per_m *
                                  axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  // The page's y axis points down, so a counter-clockwise angle is negative.
  const double angle_deg =
      -degrees(std::atan2(axes.eigenvectors()(1, 0), axes.eigenvectors()(0, 0)));
  svg.ellipse(layout.page_from_world(mean_m), half_px, angle_deg, style);
}

void draw_target(logs::Svg& svg, const logs::Layout& layout, const Course& course) {
  draw_ellipse(svg, layout, course.mean_m.front(), course.before_m2,
               fmt::format(R"(class="prior" fill="none" stroke="{}" stroke-width="1.2" )"
                           R"(stroke-dasharray="4 4")",
                           logs::role_colour("fallback")));
  Points path_px;
  for (const Eigen::Vector2d& mean_m : course.mean_m) {
    path_px.push_back(layout.page_from_world(mean_m));
  }
  svg.polyline(path_px, fmt::format(R"(fill="none" stroke="{}" stroke-width="1.4")",
                                    logs::role_colour("estimate")));
  draw_ellipse(svg, layout, course.mean_m.back(), course.after_m2,
               fmt::format(R"(class="target" fill="{0}" fill-opacity="0.12" stroke="{0}" )"
                           R"(stroke-width="1.6")",
                           logs::role_colour("estimate")));
  svg.circle(path_px.back(), 2.5, fmt::format("fill=\"{}\"", logs::role_colour("estimate")));
}

void draw_path(logs::Svg& svg, const logs::Layout& layout, const planner::SearchProblem& problem,
               const planner::SearchResult& result) {
  constexpr int kPieces = 16;
  Points path_px{layout.page_from_world(problem.start.position_m())};
  Pose2 from = problem.start;
  for (std::size_t t = 0; t < result.controls.size(); ++t) {
    const auto& control = problem.controls[index(result.controls[t])];
    for (int k = 1; k <= kPieces; ++k) {
      const Pose2 at = models::step_unicycle(from, control, problem.step_s * k / kPieces);
      path_px.push_back(layout.page_from_world(at.position_m()));
    }
    from = result.poses[t];
  }
  svg.polyline(path_px, fmt::format(R"(class="plan" fill="none" stroke="{}" stroke-width="2.4" )"
                                    R"(stroke-linejoin="round")",
                                    path_colour()));
  const auto mark = [&](const Pose2& pose, std::string_view style) {
    const Eigen::Vector2d at_px = layout.page_from_world(pose.position_m());
    const Eigen::Vector2d ahead(std::cos(pose.yaw_rad), -std::sin(pose.yaw_rad));
    const Eigen::Vector2d aside(-ahead.y(), ahead.x());
    svg.polygon({at_px + 8.0 * ahead, at_px - 5.0 * ahead + 5.0 * aside, at_px - 3.0 * ahead,
                 at_px - 5.0 * ahead - 5.0 * aside},
                style);
  };
  for (std::size_t t = 0; t < result.controls.size(); ++t) {
    mark(result.poses[t], fmt::format(R"(fill="{}" stroke="#ffffff")", path_colour()));
  }
  mark(problem.start, fmt::format(R"(class="start" fill="#ffffff" stroke="{}")", path_colour()));
}

constexpr std::string_view kHead = R"(font-size="15" font-weight="bold" fill="#202124")";
constexpr std::string_view kKey = R"(font-size="12.5" fill="#5f6368")";
constexpr std::string_view kBody = R"(font-size="12.5" fill="#202124")";
constexpr double kValue_px = 78.0;  // px; x position of values
constexpr double kRow_px = 20.0;
constexpr std::size_t kValueColumns = 40;  // number of characters that fit to the right of the keys

struct Row {
  std::string key;
  std::string value;
};

// Splits lines of to_lines() into key and value, and long values into several rows.
std::vector<Row> rows_of(const std::vector<std::string>& lines) {
  std::vector<Row> rows;
  for (const std::string& line : lines) {
    const std::size_t gap = line.find("  ");
    std::string key = gap == std::string::npos ? "" : line.substr(0, gap);
    std::string rest =
        gap == std::string::npos ? line : line.substr(line.find_first_not_of(' ', gap));
    while (rest.size() > kValueColumns) {
      std::size_t end = rest.rfind(' ', kValueColumns);
      end = end == std::string::npos || end == 0 ? kValueColumns : end;
      rows.push_back({key, rest.substr(0, end)});
      rest = rest.substr(std::min(rest.find_first_not_of(' ', end), rest.size()));
      key.clear();
    }
    rows.push_back({key, rest});
  }
  return rows;
}

double draw_numbers(logs::Svg& svg, const Eigen::Vector2d& corner_px,
                    const std::vector<Row>& rows) {
  double y_px = corner_px.y() + 14.0;
  svg.text({corner_px.x(), y_px}, "Plan", kHead);
  y_px += 4.0;
  for (const Row& row : rows) {
    y_px += kRow_px;
    svg.text({corner_px.x(), y_px}, row.key, kKey);
    svg.text({corner_px.x() + kValue_px, y_px}, row.value, kBody);
  }
  return y_px;
}

void draw_legend(logs::Svg& svg, const Eigen::Vector2d& corner_px, bool has_targets) {
  const Eigen::Vector2d dx(14, 0);
  Eigen::Vector2d at_px = corner_px + Eigen::Vector2d(0, 14);
  svg.text(at_px, "Legend", kHead);
  const auto entry = [&](const std::string& words) {
    at_px.y() += 24.0;
    svg.text(at_px + Eigen::Vector2d(44, 0), words, kBody);
    return Eigen::Vector2d(at_px + Eigen::Vector2d(16, -4.5));
  };
  Eigen::Vector2d p_px = entry("planned path, a mark at each step");
  svg.line(p_px - dx, p_px + dx, fmt::format("stroke=\"{}\" stroke-width=\"2.4\"", path_colour()));
  p_px = entry(logs::appearance().glyphs.at("view") + " at each step");
  svg.circle(p_px, 9.0,
             fmt::format(R"(fill="{0}" fill-opacity="0.08" stroke="{0}" stroke-dasharray="4 3")",
                         path_colour()));
  if (!has_targets) {
    return;
  }
  const std::string words = logs::appearance().ellipse_label();
  p_px = entry("target before the plan (prior), " + words + " ellipse");
  svg.ellipse(p_px, {14, 8}, 0.0,
              fmt::format(R"(fill="none" stroke="{}" stroke-width="1.2" stroke-dasharray="4 4")",
                          logs::role_colour("fallback")));
  p_px = entry("target after the plan (posterior), " + words + " ellipse");
  svg.ellipse(p_px, {14, 8}, 0.0,
              fmt::format(R"(fill="{0}" fill-opacity="0.12" stroke="{0}" stroke-width="1.6")",
                          logs::role_colour("estimate")));
  p_px = entry("predicted path of its mean");
  svg.line(p_px - dx, p_px + dx,
           fmt::format("stroke=\"{}\" stroke-width=\"1.4\"", logs::role_colour("estimate")));
}

}  // namespace

std::string draw_plan_picture(const PlanningProblem& planning, const PlanOutcome& outcome) {
  const planner::SearchProblem& problem = planning.problem;
  const std::vector<Row> rows = rows_of(to_lines(planning, outcome));
  const logs::Layout layout(planning.world->bounds,
                            kRow_px * static_cast<double>(rows.size()) + 190.0);
  scenario::Scenario scenario;
  scenario.world = *planning.world;
  logs::Svg svg(layout.page_size_px.x(), layout.page_size_px.y());
  svg.open_clip(layout.map_corner_px, layout.map_size_px);
  logs::draw_ground(svg, layout, scenario, {});
  // Views overlap; together they must not hide the walls.
  constexpr double kOpacity = 0.25;
  const double opacity =
      std::min(0.08, kOpacity / static_cast<double>(outcome.result.poses.size() + 1));
  for (const Pose2& pose : outcome.result.poses) {
    for (const models::SensorModel& sensor : problem.sensors) {
      logs::draw_view(svg, layout, sensor, pose, path_colour(), opacity);
    }
  }
  for (const planner::SearchTarget& target : problem.targets) {
    draw_target(svg, layout, course_of(problem, target, outcome.result.poses));
  }
  draw_path(svg, layout, problem, outcome.result);
  svg.close_group();
  logs::draw_axes(svg, layout, *planning.world);
  svg.text({layout.map_corner_px.x(), 40.0}, planning.name.empty() ? outcome.source : planning.name,
           R"(font-size="22" font-weight="bold" fill="#202124")");
  const double end_px = draw_numbers(svg, layout.panel_corner_px, rows);
  draw_legend(svg, {layout.panel_corner_px.x(), end_px + 26.0}, !problem.targets.empty());
  return svg.str();
}

}  // namespace vantage::tools
