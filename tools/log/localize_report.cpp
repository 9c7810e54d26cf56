#include "tools/log/localize_report.hpp"

#include <fmt/format.h>

namespace vantage::tools {
namespace {

std::string row(const std::string& name, const localizer::ErrorFigures& figures) {
  return fmt::format("{:<14} {:>8.4f} {:>8.4f} {:>8.4f} {:>8.4f} {:>8}", name, figures.rmse,
                     figures.median, figures.p95, figures.max, figures.count);
}

nlohmann::ordered_json json_of(const localizer::ErrorFigures& figures) {
  return {{"rmse", figures.rmse},
          {"median", figures.median},
          {"p95", figures.p95},
          {"max", figures.max},
          {"count", figures.count}};
}

}  // namespace

std::vector<std::string> to_lines(const localizer::JudgeFigures& figures,
                                  const std::vector<std::string>& robots) {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:<14} {:>8} {:>8} {:>8} {:>8} {:>8}", "position, m", "RMSE",
                              "median", "p95", "max", "count"));
  for (std::size_t robot = 0; robot < robots.size(); ++robot) {
    lines.push_back(row(robots[robot], figures.robot_position_m[robot]));
  }
  lines.push_back(row("all robots", figures.position_m));
  lines.push_back(row("heading, rad", figures.yaw_rad));
  lines.push_back(fmt::format(
      "NEES of position {:.2f} (ideal 2), {:.1f} % inside the 95 % ellipse; of pose {:.2f} "
      "(ideal 3), {:.1f} % inside",
      figures.nees_position, 100.0 * figures.inside_position, figures.nees_pose,
      100.0 * figures.inside_pose));
  std::string placed = "first pose after, s:";
  for (std::size_t robot = 0; robot < robots.size(); ++robot) {
    const double after_s = figures.placed_after_s[robot];
    placed += after_s < 0.0 ? fmt::format(" {} never", robots[robot])
                            : fmt::format(" {} {:.1f}", robots[robot], after_s);
  }
  lines.push_back(placed);
  lines.push_back(fmt::format("instants without a pose: {}", figures.without_pose));
  if (figures.bytes_per_robot_s > 0.0) {
    lines.push_back(
        fmt::format("messages: {:.0f} bytes per second and robot", figures.bytes_per_robot_s));
  }
  const localizer::FilterCounts& filter = figures.filter;
  lines.push_back(fmt::format(
      "sightings of one filter: {} used, {} of them with less weight, {} rejected, {} with unknown "
      "ids, {} of robots without a pose; {} slips",
      filter.used, filter.weakened, filter.rejected, filter.unknown, filter.unplaced,
      filter.slips));
  if (filter.matched + filter.ambiguous + filter.unmatched > 0) {
    lines.push_back(fmt::format("sightings without id: {} assigned, {} ambiguous, {} of no body",
                                filter.matched, filter.ambiguous, filter.unmatched));
  }
  if (!figures.landmarks_m.empty()) {
    lines.push_back(fmt::format(
        "{} landmarks found: RMSE {:.4f} m if aligned like the robots' paths, {:.4f} m if "
        "aligned separately",
        figures.landmarks_m.size(), figures.landmarks_rmse_m, figures.landmarks_own_rmse_m));
  }
  return lines;
}

nlohmann::ordered_json to_json(const localizer::JudgeFigures& figures,
                               const std::vector<std::string>& robots) {
  nlohmann::ordered_json json;
  json["position_m"] = json_of(figures.position_m);
  for (std::size_t robot = 0; robot < robots.size(); ++robot) {
    nlohmann::ordered_json one = {{"robot", robots[robot]},
                                  {"position_m", json_of(figures.robot_position_m[robot])}};
    one["placed_after_s"] = figures.placed_after_s[robot] < 0.0
                                ? nlohmann::ordered_json()
                                : nlohmann::ordered_json(figures.placed_after_s[robot]);
    json["robots"].push_back(one);
  }
  json["heading_rad"] = json_of(figures.yaw_rad);
  json["nees_position"] = figures.nees_position;
  json["inside_95_position"] = figures.inside_position;
  json["nees_pose"] = figures.nees_pose;
  json["inside_95_pose"] = figures.inside_pose;
  json["without_pose"] = figures.without_pose;
  json["bytes_per_robot_s"] = figures.bytes_per_robot_s;
  json["sightings"] = {{"used", figures.filter.used},
                       {"weakened", figures.filter.weakened},
                       {"rejected", figures.filter.rejected},
                       {"unknown", figures.filter.unknown},
                       {"unplaced", figures.filter.unplaced}};
  json["slips"] = figures.filter.slips;
  json["without_id"] = {{"assigned", figures.filter.matched},
                        {"ambiguous", figures.filter.ambiguous},
                        {"of_no_body", figures.filter.unmatched}};
  json["landmarks"] = {{"found", figures.landmarks_m.size()},
                       {"rmse_m", figures.landmarks_rmse_m},
                       {"own_rmse_m", figures.landmarks_own_rmse_m}};
  return json;
}

}  // namespace vantage::tools
