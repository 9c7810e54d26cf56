#include "planner/tour/tour_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/check.hpp"

namespace vantage::planner {
namespace {

// Smaller improvements are rounding errors.
bool is_better(double gain, double than) { return gain > than + 1e-9 * (1.0 + std::abs(than)); }

}  // namespace

TourProblem::TourProblem(int stops_max, int robots_max, int samples)
    : stops_max_(stops_max), robots_max_(robots_max), samples_(samples) {
  demand(stops_max >= 0 && stops_max < 65'535 && robots_max >= 1 && samples >= 2,
         "tour: must have at most 65534 stops, at least one robot and at least two samples");
  travels_s_.reserve(index(stops_max) * index(stops_max));
  starts_s_.reserve(index(stops_max) * index(robots_max));
  gains_.reserve(index(stops_max) * index(samples));
}

void TourProblem::resize(int stops, int robots, double sample_s, double visit_s) {
  demand(stops >= 0 && stops <= stops_max_ && robots >= 1 && robots <= robots_max_,
         "tour: the numbers of stops and robots must be at most the capacity");
  demand(sample_s > 0.0 && std::isfinite(sample_s), "tour: sample_s must be > 0");
  demand(visit_s >= 0.0 && std::isfinite(visit_s), "tour: visit_s must be ≥ 0");
  stops_ = stops;
  robots_ = robots;
  sample_s_ = sample_s;
  per_sample_ = 1.0 / sample_s;
  visit_s_ = visit_s;
  travels_s_.assign(index(stops) * index(stops), 0.0);
  starts_s_.assign(index(stops) * index(robots), 0.0);
  gains_.assign(index(stops) * index(samples_), 0.0);
}

double gain_of_tour(const TourProblem& problem, int robot, std::span<const std::uint16_t> tour) {
  double sum = 0.0;
  double at_s = 0.0;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    at_s = i == 0 ? problem.start_s(robot, tour[0])
                  : at_s + problem.visit_s() + problem.travel_s(tour[i - 1], tour[i]);
    sum += problem.gain_at(tour[i], at_s);
  }
  return sum;
}

TourSolver::TourSolver(int stops_max, int robots_max)
    : stops_max_(index(stops_max)),
      tours_(index(stops_max) * index(robots_max)),
      counts_(index(robots_max)),
      sums_(index(robots_max)),
      order_(index(stops_max)),
      is_visited_(index(stops_max)),
      trial_(index(stops_max)),
      rest_(index(stops_max)) {}

double TourSolver::gain() const {
  return std::accumulate(sums_.begin(), sums_.begin() + problem_->robot_count(), 0.0);
}

double TourSolver::gain_of(int robot, std::span<const std::uint16_t> tour) {
  work_nodes_ += static_cast<std::int64_t>(tour.size()) + 1;
  return gain_of_tour(*problem_, robot, tour);
}

bool TourSolver::expired() { return deadline_->expired(work_nodes_); }

void TourSolver::set_tour(int robot, std::span<const std::uint16_t> tour) {
  std::copy(tour.begin(), tour.end(), begin(robot));
  counts_[index(robot)] = tour.size();
  sums_[index(robot)] = gain_of(robot, tour);
}

void TourSolver::solve(const TourProblem& problem, const Deadline& deadline) {
  demand(
      index(problem.stop_count()) <= stops_max_ && index(problem.robot_count()) <= counts_.size(),
      "tour: the numbers of stops and robots must be at most the capacity");
  problem_ = &problem;
  deadline_ = &deadline;
  work_nodes_ = 0;
  is_finished_ = false;
  std::fill(counts_.begin(), counts_.end(), std::size_t{0});
  std::fill(sums_.begin(), sums_.end(), 0.0);
  std::fill(is_visited_.begin(), is_visited_.end(), std::uint8_t{0});
  const auto end = order_.begin() + problem.stop_count();
  std::iota(order_.begin(), end, std::uint16_t{0});
  std::sort(order_.begin(), end, [&](std::uint16_t a, std::uint16_t b) {
    const double gain_a = problem.gain(a, 0);
    const double gain_b = problem.gain(b, 0);
    return gain_a > gain_b || (gain_a == gain_b && a < b);
  });
  insert_all();
  while (!expired()) {
    const bool has_reversed = reverse_parts();
    const bool has_transferred = transfer_parts();
    const double before = gain();
    insert_all();
    if (!has_reversed && !has_transferred && !is_better(gain(), before)) {
      is_finished_ = !expired();
      return;
    }
  }
}

void TourSolver::insert_all() {
  for (int i = 0; i < problem_->stop_count() && !expired(); ++i) {
    const std::uint16_t stop = order_[index(i)];
    if (is_visited_[stop] == 0 && insert(stop)) {
      is_visited_[stop] = 1;
    }
  }
}

bool TourSolver::insert(std::uint16_t stop) {
  int best_robot = -1;
  std::size_t best_at = 0;
  double best_rise = 0.0;
  for (int robot = 0; robot < problem_->robot_count() && !expired(); ++robot) {
    const std::size_t count = counts_[index(robot)];
    const std::uint16_t* const tour = begin(robot);
    std::copy(tour, tour + count, trial_.begin() + 1);
    for (std::size_t at = 0; at <= count && !expired(); ++at) {
      if (at > 0) {
        trial_[at - 1] = tour[at - 1];
      }
      trial_[at] = stop;
      const double gain = gain_of(robot, {trial_.data(), count + 1});
      const double rise = gain - sums_[index(robot)];
      if (is_better(rise, best_rise)) {
        best_robot = robot;
        best_at = at;
        best_rise = rise;
      }
    }
  }
  if (best_robot < 0) {
    return false;
  }
  std::uint16_t* const tour = begin(best_robot);
  std::size_t& count = counts_[index(best_robot)];
  std::copy_backward(tour + best_at, tour + count, tour + count + 1);
  tour[best_at] = stop;
  ++count;
  sums_[index(best_robot)] = gain_of(best_robot, {tour, count});
  return true;
}

bool TourSolver::reverse_parts() {
  bool has_improved = false;
  for (int robot = 0; robot < problem_->robot_count(); ++robot) {
    const std::size_t count = counts_[index(robot)];
    for (std::size_t first = 0; first + 1 < count; ++first) {
      for (std::size_t last = first + 1; last < count; ++last) {
        if (expired()) {
          return has_improved;
        }
        std::uint16_t* const tour = begin(robot);
        std::copy(tour, tour + count, trial_.begin());
        std::reverse(trial_.begin() + static_cast<std::ptrdiff_t>(first),
                     trial_.begin() + static_cast<std::ptrdiff_t>(last) + 1);
        const double gain = gain_of(robot, {trial_.data(), count});
        if (is_better(gain, sums_[index(robot)])) {
          set_tour(robot, {trial_.data(), count});
          has_improved = true;
        }
      }
    }
  }
  return has_improved;
}

bool TourSolver::transfer_parts() {
  bool has_improved = false;
  for (std::size_t moved = 1; moved <= kMovedMax; ++moved) {
    for (int robot = 0; robot < problem_->robot_count(); ++robot) {
      for (std::size_t from = 0; from + moved <= counts_[index(robot)]; ++from) {
        if (expired()) {
          return has_improved;
        }
        has_improved = transfer(robot, from, moved) || has_improved;
      }
    }
  }
  return has_improved;
}

bool TourSolver::transfer(int robot, std::size_t from, std::size_t count) {
  std::array<std::uint16_t, kMovedMax> part{};
  const std::uint16_t* const tour = begin(robot);
  const std::size_t rest_count = counts_[index(robot)] - count;
  std::copy_n(tour + from, count, part.begin());
  std::copy(tour, tour + from, rest_.begin());
  std::copy(tour + from + count, tour + counts_[index(robot)],
            rest_.begin() + static_cast<std::ptrdiff_t>(from));
  const double rest_gain = gain_of(robot, {rest_.data(), rest_count});
  const double without = rest_gain - sums_[index(robot)];
  const bool is_removable = is_better(without, 0.0);
  int best_robot = -1;
  std::size_t best_at = 0;
  double best_rise = is_removable ? without : 0.0;
  for (int to = 0; to < problem_->robot_count(); ++to) {
    const std::uint16_t* const into = to == robot ? rest_.data() : begin(to);
    const std::size_t into_count = to == robot ? rest_count : counts_[index(to)];
    const double before =
        to == robot ? sums_[index(robot)] : sums_[index(robot)] + sums_[index(to)];
    for (std::size_t at = 0; at <= into_count && !expired(); ++at) {
      if (to == robot && at == from) {
        continue;  // the stop is already at this position
      }
      std::copy(into, into + at, trial_.begin());
      std::copy_n(part.begin(), count, trial_.begin() + static_cast<std::ptrdiff_t>(at));
      std::copy(into + at, into + into_count,
                trial_.begin() + static_cast<std::ptrdiff_t>(at + count));
      const double gain = gain_of(to, {trial_.data(), into_count + count});
      const double rise = (to == robot ? gain : gain + rest_gain) - before;
      if (is_better(rise, best_rise)) {
        best_robot = to;
        best_at = at;
        best_rise = rise;
      }
    }
  }
  if (best_robot < 0) {
    if (is_removable) {
      std::for_each(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](std::uint16_t stop) { is_visited_[stop] = 0; });
      set_tour(robot, {rest_.data(), rest_count});
    }
    return is_removable;
  }
  const bool stays = best_robot == robot;
  const std::uint16_t* const into = stays ? rest_.data() : begin(best_robot);
  const std::size_t into_count = stays ? rest_count : counts_[index(best_robot)];
  std::copy(into, into + best_at, trial_.begin());
  std::copy_n(part.begin(), count, trial_.begin() + static_cast<std::ptrdiff_t>(best_at));
  std::copy(into + best_at, into + into_count,
            trial_.begin() + static_cast<std::ptrdiff_t>(best_at + count));
  if (!stays) {
    set_tour(robot, {rest_.data(), rest_count});
  }
  set_tour(best_robot, {trial_.data(), into_count + count});
  return true;
}

}  // namespace vantage::planner
