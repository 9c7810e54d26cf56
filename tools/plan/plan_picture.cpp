#include <cmath>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "models/plan/plan.hpp"
#include "tools/picture/layout.hpp"
#include "tools/picture/map_layer.hpp"
#include "tools/picture/svg.hpp"
#include "tools/plan/plan_report.hpp"

namespace vantage::tools {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr std::string_view kPathColour = "#0072B2";

// Covariance of one target after the last step, and the way its mean is predicted to go.
struct Course {
  Points mean_m;
  Eigen::Matrix2d before_m2;
  Eigen::Matrix2d after_m2;
};

Course course_of(const planner::SearchProblem& problem, const planner::SearchTarget& target,
                 const std::vector<Pose2>& poses) {
  const models::StateMatrix A = target.model.transition(problem.step_s);
  const models::StateMatrix W = target.model.process_noise(problem.step_s);
  models::Gaussian belief = target.prior;
  Course course;
  course.mean_m.emplace_back(belief.mean.head<2>());
  course.before_m2 = belief.covariance.topLeftCorner<2, 2>();
  for (const Pose2& pose : poses) {
    belief = models::predict(belief, A, W);
    const models::PositionVector mean_m = belief.mean.head(2);
    models::PositionMatrix M = models::PositionMatrix::Zero(2, 2);
    if (models::line_of_sight(*problem.world, pose.position_m(), mean_m.head<2>())) {
      for (const models::SensorModel& sensor : problem.sensors) {
        M += models::information(sensor, {pose, problem.height_m}, mean_m);
      }
    }
    belief.covariance = models::update_covariance(belief.covariance, M);
    course.mean_m.emplace_back(mean_m.head<2>());
  }
  course.after_m2 = belief.covariance.topLeftCorner<2, 2>();
  return course;
}

void draw_ellipse(Svg& svg, const Layout& layout, const Eigen::Vector2d& mean_m,
                  const Eigen::Matrix2d& covariance_m2, std::string_view style) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance_m2);
  const Eigen::Vector2d half_px =
      2.0 * layout.px_per_m * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  // The page's y axis points down, so a counter-clockwise angle turns negative.
  const double angle_deg =
      -degrees(std::atan2(axes.eigenvectors()(1, 0), axes.eigenvectors()(0, 0)));
  svg.ellipse(layout.page_from_world(mean_m), half_px, angle_deg, style);
}

void draw_target(Svg& svg, const Layout& layout, const Course& course) {
  draw_ellipse(svg, layout, course.mean_m.front(), course.before_m2,
               fmt::format(R"(class="prior" fill="none" stroke="{}" stroke-width="1.2" )"
                           R"(stroke-dasharray="4 4")",
                           kTruthTrackColour));
  Points way_px;
  for (const Eigen::Vector2d& mean_m : course.mean_m) {
    way_px.push_back(layout.page_from_world(mean_m));
  }
  svg.polyline(way_px,
               fmt::format(R"(fill="none" stroke="{}" stroke-width="1.4")", kEstimateColour));
  draw_ellipse(svg, layout, course.mean_m.back(), course.after_m2,
               fmt::format(R"(class="target" fill="{0}" fill-opacity="0.12" stroke="{0}" )"
                           R"(stroke-width="1.6")",
                           kEstimateColour));
  svg.circle(way_px.back(), 2.5, fmt::format("fill=\"{}\"", kEstimateColour));
}

void draw_path(Svg& svg, const Layout& layout, const planner::SearchProblem& problem,
               const planner::SearchResult& result) {
  constexpr int kPieces = 16;
  Points path_px{layout.page_from_world(problem.start.position_m())};
  Pose2 from = problem.start;
  for (std::size_t t = 0; t < result.controls.size(); ++t) {
    const auto& control = problem.controls[static_cast<std::size_t>(result.controls[t])];
    for (int k = 1; k <= kPieces; ++k) {
      const Pose2 at = models::step_unicycle(from, control, problem.step_s * k / kPieces);
      path_px.push_back(layout.page_from_world(at.position_m()));
    }
    from = result.poses[t];
  }
  svg.polyline(path_px, fmt::format(R"(class="plan" fill="none" stroke="{}" stroke-width="2.4" )"
                                    R"(stroke-linejoin="round")",
                                    kPathColour));
  const auto mark = [&](const Pose2& pose, std::string_view style) {
    const Eigen::Vector2d at_px = layout.page_from_world(pose.position_m());
    const Eigen::Vector2d ahead(std::cos(pose.yaw_rad), -std::sin(pose.yaw_rad));
    const Eigen::Vector2d aside(-ahead.y(), ahead.x());
    svg.polygon({at_px + 8.0 * ahead, at_px - 5.0 * ahead + 5.0 * aside, at_px - 3.0 * ahead,
                 at_px - 5.0 * ahead - 5.0 * aside},
                style);
  };
  for (std::size_t t = 0; t < result.controls.size(); ++t) {
    mark(result.poses[t], fmt::format(R"(fill="{}" stroke="#ffffff")", kPathColour));
  }
  mark(problem.start, fmt::format(R"(class="start" fill="#ffffff" stroke="{}")", kPathColour));
}

}  // namespace

std::string draw_plan_picture(const PlanningProblem& planning, const PlanOutcome& outcome) {
  const planner::SearchProblem& problem = planning.problem;
  const Layout layout(planning.world->bounds, 120.0);
  models::Scenario scenario;
  scenario.world = *planning.world;
  Svg svg(layout.page_size_px.x(), layout.page_size_px.y());
  svg.open_clip(layout.map_corner_px, layout.map_size_px);
  draw_ground(svg, layout, scenario, {});
  for (const Pose2& pose : outcome.result.poses) {
    for (const models::SensorModel& sensor : problem.sensors) {
      draw_view(svg, layout, sensor, pose, kPathColour);
    }
  }
  for (const planner::SearchTarget& target : problem.targets) {
    draw_target(svg, layout, course_of(problem, target, outcome.result.poses));
  }
  draw_path(svg, layout, problem, outcome.result);
  svg.close_group();
  draw_axes(svg, layout, *planning.world);
  svg.text({layout.map_corner_px.x(), 40.0}, planning.name.empty() ? outcome.source : planning.name,
           R"(font-size="22" font-weight="bold" fill="#202124")");
  double y_px = layout.panel_corner_px.y() + 14.0;
  for (const std::string& line : to_lines(planning, outcome)) {
    constexpr std::size_t kShown = 60;
    svg.text({layout.panel_corner_px.x(), y_px},
             line.size() <= kShown ? line : line.substr(0, kShown) + "…",
             R"(font-size="12.5" fill="#202124" xml:space="preserve")");
    y_px += 20.0;
  }
  return svg.str();
}

}  // namespace vantage::tools
