#include "planner/mapping/mapping_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.hpp"
#include "models/world/world.hpp"

namespace vantage::planner {
namespace {

Eigen::Vector3d on_ground(const Pose2& pose) { return {pose.x_m, pose.y_m, 0.0}; }

}  // namespace

std::vector<models::UnicycleControl> mapping_primitives() {
  std::vector<models::UnicycleControl> primitives;
  for (const double speed_mps : {0.0, 1.0, 2.0}) {
    for (const double yaw_rate_radps : {0.0, 1.0, -1.0, 2.0, -2.0}) {
      primitives.push_back({speed_mps, yaw_rate_radps});
    }
  }
  return primitives;
}

MappingSearch::MappingSearch(ViewTable& views, const DriveMap& drive,
                             const MappingSearchOptions& options)
    : views_(&views),
      drive_(&drive),
      options_(options),
      coverage_(views.belief().geometry().size()) {
  require(!options.controls.empty(), "a mapping search must have controls");
  require(options.horizon_steps >= 1 && options.step_s > 0.0,
          "a mapping search must have a step and a horizon");
  const models::GridGeometry& geometry = views.belief().geometry();
  farthest_m_ = geometry.resolution_m * (geometry.columns + geometry.rows);
}

bool MappingSearch::is_apart(const Pose2& from, const Pose2& to, std::size_t step) const {
  if (options_.separation_m <= 0.0) {
    return true;
  }
  return std::none_of(fixed_.begin(), fixed_.end(), [&](const MapRoute* route) {
    if (route == nullptr || route->poses.size() <= step) {
      return false;
    }
    const Pose2& theirs = step == 0 ? route->start : route->poses[step - 1];
    return models::closest_approach_m(on_ground(from), on_ground(to), on_ground(theirs),
                                      on_ground(route->poses[step])) < options_.separation_m;
  });
}

double MappingSearch::end_cost_nats(const Pose2& at) const {
  return options_.frontier_nats_per_m *
         std::min(farthest_m_, drive_->to_frontier_m(at.position_m()));
}

void MappingSearch::expand(const Pose2& at, double so_far_nats) {
  const std::size_t step = path_.poses.size();
  const bool is_last = step + 1 == static_cast<std::size_t>(options_.horizon_steps);
  for (std::size_t c = 0; c < options_.controls.size(); ++c) {
    const models::UnicycleControl& control = options_.controls[c];
    const Pose2 next = models::step_unicycle(at, control, options_.step_s);
    const BeamView& view = views_->view(next);
    const double end_nats = is_last ? end_cost_nats(next) : 0.0;
    if (is_last && so_far_nats + view.nats - end_nats <= best_worth_nats_) {
      continue;  // not even if nothing of the view were known already
    }
    if (!drive_->is_free(at, control, options_.step_s) || !is_apart(at, next, step)) {
      continue;
    }
    ++path_.nodes;
    const std::size_t mark = coverage_.mark();
    const double gain_nats = so_far_nats + coverage_.add(view, views_->options());
    path_.controls.push_back(static_cast<int>(c));
    path_.poses.push_back(next);
    if (!is_last) {
      expand(next, gain_nats);
    } else if (gain_nats - end_nats > best_worth_nats_) {
      best_worth_nats_ = gain_nats - end_nats;
      best_ = path_;
      best_.gain_nats = gain_nats;
    }
    path_.controls.pop_back();
    path_.poses.pop_back();
    coverage_.take_back(mark);
  }
}

double MappingSearch::cover(const MapRoute& route) {
  double gain_nats = 0.0;
  for (const Pose2& pose : route.poses) {
    gain_nats += coverage_.add(views_->view(pose), views_->options());
  }
  return gain_nats;
}

MapRoute MappingSearch::plan(const Pose2& start, std::span<const MapRoute* const> fixed) {
  for (const MapRoute* route : fixed) {
    if (route != nullptr) {
      cover(*route);
    }
  }
  fixed_ = fixed;
  path_ = {};
  path_.start = start;
  best_ = {};
  best_worth_nats_ = -std::numeric_limits<double>::infinity();
  expand(start, 0.0);
  if (best_.poses.empty()) {
    best_.poses.assign(static_cast<std::size_t>(options_.horizon_steps), start);
    best_.gain_nats = cover(best_);
  }
  best_.start = start;
  best_.nodes = path_.nodes;
  coverage_.take_back(0);
  fixed_ = {};
  return best_;
}

double MappingSearch::value(std::span<const MapRoute* const> routes) {
  double sum_nats = 0.0;
  for (const MapRoute* route : routes) {
    sum_nats += route == nullptr ? 0.0 : cover(*route);
  }
  coverage_.take_back(0);
  return sum_nats;
}

std::vector<MapRoute> MappingSearch::coordinate_descent(std::span<const Pose2> starts,
                                                        std::span<const int> order) {
  std::vector<MapRoute> routes(starts.size());
  std::vector<const MapRoute*> fixed;
  for (const int robot : order) {
    MapRoute& route = routes[static_cast<std::size_t>(robot)];
    route = plan(starts[static_cast<std::size_t>(robot)], fixed);
    fixed.push_back(&route);
  }
  return routes;
}

}  // namespace vantage::planner
