#include "planner/mapping/mapping_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/check.hpp"
#include "core/index.hpp"
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
          "a mapping search must have a positive step and horizon");
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
         std::min(farthest_m_, drive_->frontier_distance_m(at.position_m()));
}

bool MappingSearch::is_over() {
  path_.is_cut = path_.is_cut || deadline_->expired(path_.work_nodes);
  path_.work_nodes += path_.is_cut ? 0 : 1;
  return path_.is_cut;
}

bool MappingSearch::may_drive(const Pose2& from, int control, const Pose2& to,
                              std::size_t step) const {
  if (options_.may_drive) {
    return options_.may_drive(from, control, static_cast<int>(step));
  }
  return drive_->is_free(from, options_.controls[index(control)], options_.step_s) &&
         is_apart(from, to, step);
}

bool MappingSearch::may_end(const Pose2& at, int control, std::size_t steps) const {
  return !options_.may_end || options_.may_end(at, control, static_cast<int>(steps));
}

void MappingSearch::push(int control, const Pose2& to) {
  path_.controls.push_back(control);
  path_.poses.push_back(to);
}

void MappingSearch::pop(std::size_t mark) {
  path_.controls.pop_back();
  path_.poses.pop_back();
  coverage_.undo_to(mark);
}

MapRoute MappingSearch::greedy_route(const Pose2& start) {
  const std::size_t root = coverage_.mark();
  MapRoute route;
  route.start = start;
  Pose2 at = start;
  for (std::size_t step = 0; step < static_cast<std::size_t>(options_.horizon_steps); ++step) {
    const bool is_last = step + 1 == static_cast<std::size_t>(options_.horizon_steps);
    double best_nats = -std::numeric_limits<double>::infinity();
    int best_control = -1;
    for (int c = 0; c < static_cast<int>(options_.controls.size()) && !is_over(); ++c) {
      const Pose2 next = models::step_unicycle(at, options_.controls[index(c)], options_.step_s);
      if (!may_drive(at, c, next, step) || (is_last && !may_end(next, c, step + 1))) {
        continue;
      }
      const std::size_t mark = coverage_.mark();
      const double nats =
          coverage_.add(views_->view(next), views_->options()) - end_cost_nats(next);
      coverage_.undo_to(mark);
      if (nats > best_nats) {
        best_nats = nats;
        best_control = c;
      }
    }
    if (best_control < 0 || path_.is_cut) {
      coverage_.undo_to(root);
      return {};
    }
    at = models::step_unicycle(at, options_.controls[index(best_control)], options_.step_s);
    route.gain_nats += coverage_.add(views_->view(at), views_->options());
    route.controls.push_back(best_control);
    route.poses.push_back(at);
  }
  coverage_.undo_to(root);
  route.value_nats = route.gain_nats - end_cost_nats(at);
  return route;
}

void MappingSearch::offer_stop(int control, double gain_nats) {
  const Pose2& at = path_.poses.back();
  const double value_nats = gain_nats - end_cost_nats(at);
  const bool is_better =
      path_.poses.size() > stop_.controls.size() ||
      (path_.poses.size() == stop_.controls.size() && value_nats > stop_.value_nats);
  if (is_better && may_end(at, control, path_.poses.size())) {
    stop_ = path_;
    stop_.gain_nats = gain_nats;
    stop_.value_nats = value_nats;
  }
}

void MappingSearch::expand(const Pose2& at, double so_far_nats) {
  const std::size_t step = path_.poses.size();
  const bool is_last = step + 1 == static_cast<std::size_t>(options_.horizon_steps);
  for (int c = 0; c < static_cast<int>(options_.controls.size()); ++c) {
    if (is_over()) {
      return;
    }
    const Pose2 next = models::step_unicycle(at, options_.controls[index(c)], options_.step_s);
    const BeamView& view = views_->view(next);
    const double end_nats = is_last ? end_cost_nats(next) : 0.0;
    if (is_last && so_far_nats + view.nats - end_nats <= best_value_nats_) {
      continue;  // no improvement is possible, even if the complete view is new
    }
    if (!may_drive(at, c, next, step) || (is_last && !may_end(next, c, step + 1))) {
      continue;
    }
    ++path_.nodes;
    const std::size_t mark = coverage_.mark();
    const double gain_nats = so_far_nats + coverage_.add(view, views_->options());
    push(c, next);
    if (!is_last) {
      if (options_.may_end && best_.poses.empty()) {
        offer_stop(c, gain_nats);
      }
      expand(next, gain_nats);
    } else if (gain_nats - end_nats > best_value_nats_) {
      best_value_nats_ = gain_nats - end_nats;
      best_ = path_;
      best_.gain_nats = gain_nats;
      best_.value_nats = best_value_nats_;
    }
    pop(mark);
  }
}

double MappingSearch::cover(const MapRoute& route) {
  double gain_nats = 0.0;
  for (const Pose2& pose : route.poses) {
    gain_nats += coverage_.add(views_->view(pose), views_->options());
  }
  return gain_nats;
}

MapRoute MappingSearch::plan(const Pose2& start, std::span<const MapRoute* const> fixed,
                             const Deadline& deadline) {
  for (const MapRoute* route : fixed) {
    if (route != nullptr) {
      cover(*route);
    }
  }
  fixed_ = fixed;
  deadline_ = &deadline;
  path_ = {};
  path_.start = start;
  best_ = {};
  stop_ = {};
  best_value_nats_ = -std::numeric_limits<double>::infinity();
  MapRoute greedy = greedy_route(start);
  expand(start, 0.0);
  if (path_.is_cut && !greedy.poses.empty() && greedy.value_nats > best_value_nats_) {
    best_ = std::move(greedy);
  }
  if (best_.poses.empty()) {
    best_ = std::move(stop_);
    const Pose2 end = best_.poses.empty() ? start : best_.poses.back();
    best_.poses.resize(static_cast<std::size_t>(options_.horizon_steps), end);
    best_.gain_nats = cover(best_);
    best_.value_nats = best_.gain_nats - end_cost_nats(end);
  }
  best_.start = start;
  best_.nodes = path_.nodes;
  best_.work_nodes = path_.work_nodes;
  best_.is_cut = path_.is_cut;
  coverage_.undo_to(0);
  fixed_ = {};
  deadline_ = nullptr;
  return best_;
}

double MappingSearch::value(std::span<const MapRoute* const> routes) {
  double sum_nats = 0.0;
  for (const MapRoute* route : routes) {
    sum_nats += route == nullptr ? 0.0 : cover(*route);
  }
  coverage_.undo_to(0);
  return sum_nats;
}

std::vector<MapRoute> MappingSearch::coordinate_descent(std::span<const Pose2> starts,
                                                        std::span<const int> order) {
  std::vector<MapRoute> routes(starts.size());
  std::vector<const MapRoute*> fixed;
  for (const int robot : order) {
    MapRoute& route = routes[index(robot)];
    route = plan(starts[index(robot)], fixed);
    fixed.push_back(&route);
  }
  return routes;
}

}  // namespace vantage::planner
