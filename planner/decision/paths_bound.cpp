#include "planner/decision/paths_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/index.hpp"
#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

constexpr std::size_t kStatesMax = 1'700'000;
constexpr double kFloatRounding = 1e-5;  // relative rounding error of sums and reference in float

// Returns the lattice size of an iteration: coarse in the first iterations, in which Frank-Wolfe
// steps improve the bound most.
std::size_t states_of_turn(int turn) {
  constexpr std::size_t kStates[] = {100'000, 100'000, 300'000, 300'000, 300'000, 700'000};
  constexpr int kTurns = static_cast<int>(std::size(kStates));
  return turn < kTurns ? kStates[turn] : kStatesMax;
}

}  // namespace

PathsBound::PathsBound(int targets_max, int horizon_max)
    : cost_(targets_max, horizon_max),
      lattice_(targets_max, horizon_max, kStatesMax),
      beliefs_(targets_max, horizon_max) {}

// Long function: it contains the loop of iterations over all robots.
PathsBound::Answer PathsBound::of(std::span<const SearchProblem> problems,
                                  std::span<const int> robots, InformationMeasure measure,
                                  const Deadline& deadline) {
  Answer best{robots.empty() ? 0.0 : kInfinity, std::vector<double>(robots.size(), kInfinity), 0};
  if (robots.empty()) {
    return best;
  }
  std::vector<SearchProblem> own;
  for (const int robot : robots) {
    own.push_back(problems[index(robot)]);
    own.back().fixed_information.clear();
  }
  beliefs_.reset(own.front());
  cost_.reset(own.front(), beliefs_, measure);
  cost_.clear_reached();
  double unseen = 0.0;
  reference_.assign(cost_.reference_size(), 0.0F);
  looked_.resize(reference_.size());
  for (const SearchProblem& problem : own) {
    lattice_.reset(problem, beliefs_);
    if (lattice_.is_empty()) {
      return best;
    }
    lattice_.mark_reached(problem.start, 0, cost_);
    lattice_.begin(looked_.data());
    std::transform(reference_.begin(), reference_.end(), looked_.begin(), reference_.begin(),
                   std::plus<>());
  }
  if (measure == InformationMeasure::kLogDet) {
    for (int k = 1; k <= own.front().horizon_steps; ++k) {
      unseen += beliefs_.open_loop_cost(k);
    }
  }
  std::vector<double> parts(own.size());
  for (int turn = 0;; ++turn) {
    double least = -unseen;  // lower bound of the cost minus the cost without measurements
    for (int m = 0; m < beliefs_.target_count(); ++m) {
      least += cost_.linearise(m, 0, beliefs_.open_loop(m, 0), reference_.data());
    }
    std::fill(looked_.begin(), looked_.end(), 0.0F);
    const std::size_t states = states_of_turn(turn);
    for (std::size_t i = 0; i < own.size(); ++i) {
      lattice_.reset(own[i], beliefs_);
      const auto path = lattice_.best_path(own[i].start, 0, cost_, looked_.data(), states, deadline,
                                           best.work_nodes);
      if (path.expired || (path.gained == kInfinity && states == kStatesMax)) {
        return best;  // deadline expired, or the path is too long for any lattice
      }
      parts[i] = 0.5 * path.gained;
      least -= path.gained + kFloatRounding * (1.0 + path.gained);
    }
    if (!std::isnan(least) && -0.5 * least < best.information_nats) {
      best.information_nats = std::max(0.0, -0.5 * least);
      best.parts = parts;
    }
    if (std::isinf(least)) {
      continue;  // too few states for some robot's path
    }
    const float share = 2.0F / static_cast<float>(turn + 3);
    for (std::size_t i = 0; i < reference_.size(); ++i) {
      reference_[i] += share * (looked_[i] - reference_[i]);
    }
  }
}

PathsBound::Answer PathsBound::under_attack(std::span<const SearchProblem> problems,
                                            int attacks_max, InformationMeasure measure,
                                            std::int64_t nodes, bool (*is_cancelled)()) {
  const Deadline half =
      Deadline::nodes(std::max<std::int64_t>(1, nodes / 2)).with_cancellation(is_cancelled);
  std::vector<int> robots(problems.size());
  std::iota(robots.begin(), robots.end(), 0);
  const Answer of_all = of(problems, robots, measure, half);
  std::stable_sort(robots.begin(), robots.end(),
                   [&](int a, int b) { return of_all.parts[index(a)] > of_all.parts[index(b)]; });
  const auto attacked = std::min(robots.size(), index(std::max(0, attacks_max)));
  robots.erase(robots.begin(), robots.begin() + static_cast<std::ptrdiff_t>(attacked));
  std::sort(robots.begin(), robots.end());
  Answer left = of(problems, robots, measure, half);
  left.information_nats = std::min(left.information_nats, of_all.information_nats);
  left.work_nodes += of_all.work_nodes;
  return left;
}

}  // namespace vantage::planner
