#include "planner/search/arvi.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"
#include "core/index.hpp"
#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

constexpr std::size_t kHistoryMax = 128;

}  // namespace

ReducedValueIteration::ReducedValueIteration(const SearchCapacity& capacity)
    : TreeSearch(capacity, kHistoryMax),
      root_bound_(capacity.targets_max, capacity.horizon_max),
      index_(capacity.nodes_max),
      levels_(index(capacity.horizon_max + 1)),
      fresh_(capacity.nodes_max) {}

void ReducedValueIteration::prefault() {
  tree_.prefault();
  index_.prefault();
  fresh_.prefault();
}

// Long function: it makes the passes and sets all fields of the result.
const SearchResult& ReducedValueIteration::plan(const SearchProblem& problem,
                                                const ReducedOptions& options,
                                                const Deadline& deadline) {
  require_valid(problem);
  require_fits(problem, capacity_);
  demand(options.halvings >= 0 && options.halvings <= 100, "search: halvings must be in [0, 100]");
  demand(options.epsilon >= 0.0 && options.delta_m >= 0.0, "search: ε and δ must be ≥ 0");
  demand(options.yaw_weight_m_per_rad >= 0.0, "search: the yaw weight must be ≥ 0");

  problem_ = &problem;
  deadline_ = &deadline;
  metric_ = {options.yaw_weight_m_per_rad};
  tree_.clear();
  expander_.reset(problem);
  std::fill(levels_.begin(), levels_.end(), Level{});
  fresh_peak_ = 0;
  index_peak_ = 0;
  best_leaf_ = kNoNode;
  keeps_leaves_ = options.keeps_leaves;
  result_.reset();
  result_.has_terminal_value = !problem.terminal.is_empty();
  result_.lower_bound = root_bound_.of_any_plan(problem, expander_.beliefs());
  double moving_bound = result_.lower_bound;
  open_node(levels_[0], tree_.add(expander_.root()));

  // The passes of the schedule that the search kind uses: (∞, ∞), the finite passes, (0, 0).
  Progress progress = Progress::kDone;
  const auto pass = [&](double epsilon, double delta_m, bool prune) {
    progress = improve_path(epsilon, delta_m, prune);
    if (progress == Progress::kDone) {
      result_.epsilon = epsilon;
      result_.delta_m = delta_m;
      ++result_.passes;
      result_.history.push_back({epsilon, delta_m, result_.cost, result_.work_nodes});
    }
    return progress == Progress::kDone;
  };
  result_.stop_reason = StopReason::kConverged;
  switch (options.search) {
    case ReducedSearch::kExhaustive:
      pass(0.0, 0.0, false);
      result_.stop_reason = StopReason::kFinished;
      break;
    case ReducedSearch::kSinglePass:
      pass(options.epsilon, options.delta_m, true);
      break;
    case ReducedSearch::kGreedy:
      pass(kInfinity, kInfinity, true);
      break;
    case ReducedSearch::kAnytime: {
      bool more = pass(kInfinity, kInfinity, true);
      bool bounded = false;
      double scale = 1.0;
      for (int i = 0; more && i < options.halvings; ++i, scale *= 0.5) {
        more = pass(options.epsilon * scale, options.delta_m * scale, true);
        if (more && !bounded && result_.work_nodes >= RootBound::kMovingBoundAfterNodes) {
          bounded = true;
          const auto bound = root_bound_.of_moving_plan(deadline, result_.work_nodes);
          moving_bound = bound.cost;
          more = !bound.expired;
          progress = more ? progress : Progress::kDeadline;
        }
      }
      if (more) {
        pass(0.0, 0.0, true);
        result_.stop_reason = StopReason::kFinished;
      }
      break;
    }
  }
  if (progress == Progress::kDeadline) {
    result_.stop_reason = StopReason::kDeadline;
  } else if (progress == Progress::kMemory) {
    result_.stop_reason = StopReason::kMemory;
  }
  if (best_leaf_ != kNoNode) {
    write_path(tree_, best_leaf_, problem.horizon_steps, result_);
    result_.lower_bound =
        result_.stop_reason == StopReason::kFinished ? result_.cost : moving_bound;
  } else {
    fall_back_to_hover();
  }
  result_.lower_bound = std::min(result_.lower_bound, result_.cost);  // corrects rounding
  result_.peak_bytes = tree_.bytes_used() + fresh_peak_ * CostOrder::bytes_per_entry() +
                       index_peak_ * CrossingIndex::bytes_per_entry();
  return result_;
}

ReducedValueIteration::Progress ReducedValueIteration::improve_path(double epsilon, double delta_m,
                                                                    bool prune) {
  for (int t = 1; t <= problem_->horizon_steps; ++t) {
    Progress progress = expand_level(t, prune);
    if (progress == Progress::kDone && prune && t < problem_->horizon_steps) {
      progress = open_level(t, epsilon, delta_m);
    }
    if (progress != Progress::kDone) {
      return progress;
    }
  }
  return Progress::kDone;
}

ReducedValueIteration::Progress ReducedValueIteration::expand_level(int t, bool prune) {
  Level& parents = levels_[index(t - 1)];
  Level& level = levels_[index(t)];
  const bool is_last = t == problem_->horizon_steps;
  fresh_.clear();
  for (NodeId parent = parents.unexpanded; parent != kNoNode; parent = parents.unexpanded) {
    // counted before each deadline check, so that every check sees a different count
    ++result_.work_nodes;
    if (expired()) {
      return Progress::kDeadline;
    }
    if (!expander_.expand(tree_, parent, children_)) {
      return Progress::kMemory;
    }
    parents.unexpanded = tree_[parent].next;
    ++result_.nodes_expanded;
    if (is_last) {
      for (int i = 0; i < children_.count; ++i) {
        if ((keeps_leaves_ || is_best_leaf(i)) && !offer_leaf(i, parent)) {
          return Progress::kMemory;
        }
      }
      result_.nodes_generated += children_.count;
      result_.work_nodes += children_.count;
      continue;
    }
    for (int i = 0; i < children_.count; ++i) {
      const Node child = children_.node(i, parent, t);
      const NodeId id = tree_.add(child);
      if (id == kNoNode) {
        return Progress::kMemory;
      }
      ++result_.nodes_generated;
      ++result_.work_nodes;
      if (prune) {
        fresh_.add(child.cost, id);
      } else {
        open_node(level, id);
      }
    }
  }
  return Progress::kDone;
}

void ReducedValueIteration::open_node(Level& level, NodeId id) {
  level.open.push(tree_, id);
  if (level.unexpanded == kNoNode) {
    level.unexpanded = id;
  }
}

NodeId ReducedValueIteration::pop_least(Level& level) {
  if (!level.pending.is_empty() &&
      (fresh_.is_empty() || !fresh_.is_next_before(tree_[level.pending.first].cost))) {
    return level.pending.pop(tree_);
  }
  return fresh_.is_empty() ? kNoNode : fresh_.pop();
}

ReducedValueIteration::Progress ReducedValueIteration::open_level(int t, double epsilon,
                                                                  double delta_m) {
  Level& level = levels_[index(t)];
  const auto go_on = [this] {
    ++result_.work_nodes;
    return !expired();
  };
  fresh_peak_ = std::max(fresh_peak_, fresh_.size());
  if (!fresh_.sort(go_on)) {
    return Progress::kDeadline;
  }
  const bool indexed = std::isfinite(delta_m);
  if (indexed) {
    index_.reset(delta_m);
    for (NodeId id = level.open.first; id != kNoNode; id = tree_[id].next) {
      if (!go_on()) {
        return Progress::kDeadline;
      }
      index_.insert(tree_[id].world_from_body, id);
    }
  }
  NodeList left_out;
  for (NodeId id = pop_least(level); id != kNoNode; id = pop_least(level)) {
    if (!go_on()) {
      return Progress::kDeadline;
    }
    bool pruned = false;
    const Progress progress = is_pruned(id, epsilon, delta_m, level, pruned);
    if (progress != Progress::kDone) {
      return progress;
    }
    if (pruned) {
      left_out.push(tree_, id);
      continue;
    }
    open_node(level, id);
    if (indexed) {
      index_.insert(tree_[id].world_from_body, id);
    }
  }
  level.pending = left_out;
  index_peak_ = std::max(index_peak_, index_.size());
  return Progress::kDone;
}

ReducedValueIteration::Progress ReducedValueIteration::is_pruned(NodeId id, double epsilon,
                                                                 double delta_m, const Level& level,
                                                                 bool& pruned) {
  pruned = false;
  const double cost = tree_[id].cost;
  const Pose2 pose = tree_[id].world_from_body;
  Progress progress = Progress::kDone;
  // Number of compared nodes between two deadline checks; 64 comparisons take a few µs.
  constexpr int kAskEvery = 64;
  int passed_by = 0;
  const auto go_on_after = [&](NodeId other) {
    if (++passed_by % kAskEvery == 0) {
      ++result_.work_nodes;
      if (expired()) {
        progress = Progress::kDeadline;
        return false;
      }
    }
    // Cheapest test first: cost, distance, then blocks.
    if (tree_[other].cost > cost || !metric_.crosses(tree_[other].world_from_body, pose, delta_m)) {
      return true;
    }
    if (std::isfinite(epsilon)) {
      ++result_.work_nodes;
      if (expired()) {
        progress = Progress::kDeadline;
        return false;
      }
      if (!expander_.ensure_posterior(tree_, id) || !expander_.ensure_posterior(tree_, other)) {
        progress = Progress::kMemory;
        return false;
      }
      if (!expander_.is_redundant(tree_, id, epsilon, other)) {
        return true;
      }
    }
    pruned = true;
    return false;
  };
  if (std::isfinite(delta_m)) {
    index_.near(pose, go_on_after);
  } else {  // with infinite δ all nodes cross each other
    NodeId other = level.open.first;
    while (other != kNoNode && go_on_after(other)) {
      other = tree_[other].next;
    }
  }
  return progress;
}

bool ReducedValueIteration::offer_leaf(int i, NodeId parent) {
  const int t = problem_->horizon_steps;
  NodeId id = keeps_leaves_ ? tree_.add(children_.node(i, parent, t)) : best_leaf_;
  if (keeps_leaves_ && id == kNoNode) {
    return false;
  }
  if (!is_best_leaf(i) ||
      !expander_.motion().can_stop(children_.world_from_body[i], children_.control[i], t)) {
    return true;
  }
  if (id == kNoNode) {
    id = tree_.add(children_.node(i, parent, t));
    if (id == kNoNode) {
      return false;
    }
  } else if (!keeps_leaves_) {
    tree_[id] = children_.node(i, parent, t);
  }
  best_leaf_ = id;
  result_.cost = children_.cost[i];
  return true;
}

void ReducedValueIteration::fall_back_to_hover() {
  constexpr int kTriedMax = 64;
  result_.cost = kInfinity;
  const auto offer = [&](int t, HoverChoice& choice) {
    NodeId id = levels_[index(t)].open.first;
    for (int tried = 0; id != kNoNode && tried < kTriedMax; id = tree_[id].next, ++tried) {
      choice.offer(id);
    }
  };
  hover_as_late_as_safe(problem_->horizon_steps, offer);
}

}  // namespace vantage::planner
