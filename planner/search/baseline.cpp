#include "planner/search/baseline.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

#include "core/check.hpp"
#include "core/index.hpp"
#include "planner/problem/motion_table.hpp"

namespace vantage::planner {
namespace {

// Searches depth first, with the children of each step in the order of `rank`. Backtracks from dead
// ends and ends in a leaf that can stop. The number of tries is bounded; if none succeeds, the
// round uses its fallback.
class Descent {
 public:
  using Rank = std::function<void(const Pose2& at, int depth, std::vector<int>& controls)>;

  Descent(const SearchProblem& problem, Rank rank)
      : problem_(problem),
        motion_(static_cast<int>(problem.controls.size()), problem.horizon_steps,
                static_cast<int>(problem.teammates.size())),
        rank_(std::move(rank)) {
    motion_.reset(problem);
  }

  SearchResult run() {
    SearchResult result;
    result.lower_bound = -std::numeric_limits<double>::infinity();
    result.has_terminal_value = !problem_.terminal.is_empty();
    result.found = descend(problem_.start, 0, -1, result);
    if (!result.found && motion_.can_stop_from_start()) {
      result.found = true;
      result.controls.clear();
      result.poses.assign(static_cast<std::size_t>(problem_.horizon_steps), problem_.start);
    }
    if (result.found) {
      result.moving_steps = static_cast<int>(result.controls.size());
      result.cost = score(problem_, result.poses);
    }
    result.work_nodes = result.nodes_generated;
    return result;
  }

 private:
  static constexpr std::int64_t kTriesMax = 5'000;

  bool descend(const Pose2& at, int depth, int control, SearchResult& result) {
    if (depth == problem_.horizon_steps) {
      return motion_.can_stop(at, control, depth);
    }
    std::vector<int> order(problem_.controls.size());
    std::iota(order.begin(), order.end(), 0);
    rank_(at, depth, order);
    const double cos_yaw = std::cos(at.yaw_rad);
    const double sin_yaw = std::sin(at.yaw_rad);
    for (const int c : order) {
      if (++result.nodes_generated > kTriesMax) {
        return false;
      }
      if (!motion_.is_free(at, cos_yaw, sin_yaw, c, depth)) {
        continue;
      }
      const Pose2 next = motion_.child(at, cos_yaw, sin_yaw, c);
      result.controls.push_back(c);
      result.poses.push_back(next);
      if (descend(next, depth + 1, c, result)) {
        return true;
      }
      result.controls.pop_back();
      result.poses.pop_back();
    }
    return false;
  }

  const SearchProblem& problem_;
  MotionTable motion_;
  Rank rank_;
};

// Plans through the waypoints from `next` on; advances `next` as they are reached.
SearchResult plan_through(const SearchProblem& problem,
                          const std::vector<Eigen::Vector2d>& waypoints, std::size_t& next) {
  // A waypoint counts as reached within this distance, about the smallest turning radius of typical
  // primitives.
  constexpr double kReached_m = 0.5;
  const auto aim = [&](const Pose2& at) {
    for (std::size_t tried = 0;
         tried < waypoints.size() && (waypoints[next] - at.position_m()).norm() < kReached_m;
         ++tried) {
      next = (next + 1) % waypoints.size();
    }
    return waypoints[next];
  };
  const auto rank = [&](const Pose2& at, int /*depth*/, std::vector<int>& controls) {
    const Eigen::Vector2d goal_m = aim(at);
    // Distance after this control and the best second one. Two controls suffice to turn around.
    const auto distance = [&](int c) {
      const Pose2 one = models::step_unicycle(at, problem.controls[index(c)], problem.step_s);
      double least = std::numeric_limits<double>::infinity();
      for (const models::UnicycleControl& second : problem.controls) {
        const Pose2 two = models::step_unicycle(one, second, problem.step_s);
        const Eigen::Vector2d to_goal_m = goal_m - two.position_m();
        const double off_rad =
            std::abs(wrap_to_pi(std::atan2(to_goal_m.y(), to_goal_m.x()) - two.yaw_rad));
        least = std::min(least, to_goal_m.norm() + 0.1 * off_rad);
      }
      return least;
    };
    std::vector<double> distances(controls.size());
    for (const int c : controls) {
      distances[index(c)] = distance(c);
    }
    std::stable_sort(controls.begin(), controls.end(),
                     [&](int a, int b) { return distances[index(a)] < distances[index(b)]; });
  };
  const std::size_t start = next;
  aim(problem.start);
  const std::size_t after_start = next;
  SearchResult result = Descent(problem, rank).run();
  next = result.moving_steps > 0 ? after_start : start;
  if (waypoints.size() > 1 && result.moving_steps == 0) {
    next = (next + 1) % waypoints.size();  // skip an unreachable waypoint
  }
  return result;
}

}  // namespace

const SearchResult& RandomWalk::plan(const SearchProblem& problem,
                                     const RandomWalkOptions& /*options*/,
                                     const Deadline& /*deadline*/) {
  std::mt19937_64 rng(problem.seed);
  result_ = Descent(problem, [&rng](const Pose2&, int, std::vector<int>& controls) {
              std::shuffle(controls.begin(), controls.end(), rng);
            }).run();
  result_.stop_reason = StopReason::kConverged;  // the search ended without a bound
  return result_;
}

std::vector<Eigen::Vector2d> lawn_mower_waypoints(const models::Rectangle& bounds, int index,
                                                  int count, double spacing_m, double margin_m) {
  const Eigen::Vector2d size_m = bounds.max_m - bounds.min_m;
  const int along = size_m.y() >= size_m.x() ? 1 : 0;  // strips are cut across the longer side
  const int across = 1 - along;
  const double strip_m = size_m(along) / count;
  const double low_m = bounds.min_m(along) + index * strip_m + margin_m;
  const double high_m = bounds.min_m(along) + (index + 1) * strip_m - margin_m;
  const int rows = std::max(1, static_cast<int>(std::ceil((high_m - low_m) / spacing_m)) + 1);
  std::vector<Eigen::Vector2d> there;
  for (int row = 0; row < rows; ++row) {
    const double at_m =
        rows == 1 ? 0.5 * (low_m + high_m) : low_m + (high_m - low_m) * row / (rows - 1);
    for (int end = 0; end < 2; ++end) {
      Eigen::Vector2d p;
      p(along) = at_m;
      p(across) =
          (row + end) % 2 == 0 ? bounds.min_m(across) + margin_m : bounds.max_m(across) - margin_m;
      there.push_back(p);
    }
  }
  std::vector<Eigen::Vector2d> loop = there;
  loop.insert(loop.end(), there.rbegin(), there.rend());
  return loop;
}

const SearchResult& LawnMower::plan(const SearchProblem& problem, const SweepShare& share,
                                    const Deadline& /*deadline*/) {
  constexpr double kRowsPerRange = 1.6;
  constexpr double kBesideWall_m = 0.25;  // distance to walls in addition to the clearance
  require(problem.world != nullptr, "lawn_mower: the problem must have a world");
  if (waypoints_.empty()) {
    const double range_m = problem.sensors.empty() ? 1.0 : problem.sensors.front().range_max_m;
    waypoints_ = lawn_mower_waypoints(problem.world->bounds, share.index, share.count,
                                      kRowsPerRange * range_m, problem.clearance_m + kBesideWall_m);
  }
  result_ = plan_through(problem, waypoints_, next_);
  result_.stop_reason = StopReason::kConverged;  // the search ended without a bound
  return result_;
}

}  // namespace vantage::planner
