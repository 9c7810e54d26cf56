#include "planner/search/arvi.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.hpp"

namespace vantage::planner {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// require() makes a std::string of its rule even when the rule holds; a search may not allocate.
void demand(bool holds, const char* rule) {
  if (!holds) {
    require(false, rule);
  }
}

}  // namespace

ReducedValueIteration::ReducedValueIteration(const SearchCapacity& capacity)
    : capacity_(capacity),
      tree_(capacity.nodes_max, capacity.block_doubles_max),
      expander_(capacity.targets_max, capacity.horizon_max, capacity.teammates_max),
      index_(capacity.nodes_max),
      levels_(index(capacity.horizon_max + 1)) {
  for (Level& level : levels_) {
    level.pending.reserve(capacity.nodes_max);
    level.fresh.reserve(capacity.nodes_max);
    level.open.reserve(capacity.nodes_max);
  }
  left_out_.reserve(capacity.nodes_max);
  result_.controls.reserve(index(capacity.horizon_max));
  result_.poses.reserve(index(capacity.horizon_max));
  constexpr std::size_t kPassesMax = 128;
  result_.history.reserve(kPassesMax);
}

const SearchResult& ReducedValueIteration::plan(const SearchProblem& problem,
                                                const ReducedOptions& options,
                                                const Deadline& deadline) {
  require_valid(problem);
  demand(problem.horizon_steps <= capacity_.horizon_max, "search: horizon_steps over capacity");
  demand(problem.targets.size() <= index(capacity_.targets_max),
         "search: more targets than capacity");
  demand(problem.teammates.size() <= index(capacity_.teammates_max),
         "search: more teammates than capacity");
  demand(options.halvings >= 0 && options.halvings <= 100, "search: halvings must be in [0, 100]");
  demand(options.epsilon >= 0.0 && options.delta_m >= 0.0, "search: ε and δ must be ≥ 0");
  demand(options.yaw_weight_m_per_rad >= 0.0, "search: the yaw weight must be ≥ 0");

  problem_ = &problem;
  deadline_ = &deadline;
  metric_ = {options.yaw_weight_m_per_rad};
  tree_.clear();
  expander_.reset(problem);
  for (Level& level : levels_) {
    level.pending.clear();
    level.fresh.clear();
    level.open.clear();
    level.expanded = 0;
  }
  best_leaf_ = kNoNode;
  result_.found = false;
  result_.controls.clear();
  result_.poses.clear();
  result_.history.clear();
  result_.cost = kInfinity;
  result_.moving_steps = 0;
  result_.epsilon = kInfinity;
  result_.delta_m = kInfinity;
  result_.passes = 0;
  result_.nodes_generated = 0;
  result_.nodes_expanded = 0;
  result_.work_nodes = 0;
  levels_[0].open.push_back(tree_.add(expander_.root()));

  // The schedule: (∞, ∞), then the finite passes, then (0, 0), as far as the kind of search goes.
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
      double scale = 1.0;
      for (int i = 0; more && i < options.halvings; ++i, scale *= 0.5) {
        more = pass(options.epsilon * scale, options.delta_m * scale, true);
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
    fill_result(best_leaf_);
  } else {
    fall_back_to_hover();
  }
  result_.lower_bound = expander_.lower_bound_at_root();
  return result_;
}

ReducedValueIteration::Progress ReducedValueIteration::improve_path(double epsilon, double delta_m,
                                                                    bool prune) {
  for (int t = 1; t <= problem_->horizon_steps; ++t) {
    Progress progress = expand_level(t);
    if (progress == Progress::kDone && t < problem_->horizon_steps) {
      progress = open_level(t, epsilon, delta_m, prune);
    }
    if (progress != Progress::kDone) {
      return progress;
    }
  }
  return Progress::kDone;
}

ReducedValueIteration::Progress ReducedValueIteration::expand_level(int t) {
  Level& parents = levels_[index(t - 1)];
  Level& level = levels_[index(t)];
  const auto costlier = [this](NodeId a, NodeId b) { return tree_[a].cost > tree_[b].cost; };
  while (parents.expanded < parents.open.size()) {
    ++result_.work_nodes;  // before each asking, so that no two askings see the same count
    if (expired()) {
      return Progress::kDeadline;
    }
    const NodeId parent = parents.open[parents.expanded];
    if (!expander_.expand(tree_, parent, children_)) {
      return Progress::kMemory;
    }
    ++parents.expanded;
    ++result_.nodes_expanded;
    for (int i = 0; i < children_.count; ++i) {
      Node child;
      child.world_from_body = children_.world_from_body[i];
      child.cost = children_.cost[i];
      child.parent = parent;
      child.control = children_.control[i];
      child.depth = static_cast<std::uint8_t>(t);
      const NodeId id = tree_.add(child);
      if (id == kNoNode) {
        return Progress::kMemory;
      }
      ++result_.nodes_generated;
      ++result_.work_nodes;
      if (t == problem_->horizon_steps) {
        offer_leaf(id);
      } else {
        level.fresh.push_back(id);
        std::push_heap(level.fresh.begin(), level.fresh.end(), costlier);
      }
    }
  }
  return Progress::kDone;
}

NodeId ReducedValueIteration::pop_least(Level& level, std::size_t& next_pending) {
  const auto costlier = [this](NodeId a, NodeId b) { return tree_[a].cost > tree_[b].cost; };
  const bool has_pending = next_pending < level.pending.size();
  if (level.fresh.empty() && !has_pending) {
    return kNoNode;
  }
  if (level.fresh.empty() ||
      (has_pending && tree_[level.pending[next_pending]].cost <= tree_[level.fresh.front()].cost)) {
    return level.pending[next_pending++];
  }
  std::pop_heap(level.fresh.begin(), level.fresh.end(), costlier);
  const NodeId id = level.fresh.back();
  level.fresh.pop_back();
  return id;
}

ReducedValueIteration::Progress ReducedValueIteration::open_level(int t, double epsilon,
                                                                  double delta_m, bool prune) {
  Level& level = levels_[index(t)];
  const bool indexed = prune && std::isfinite(delta_m);
  if (indexed) {
    index_.reset(delta_m);
    for (const NodeId id : level.open) {
      ++result_.work_nodes;
      if (expired()) {
        return Progress::kDeadline;
      }
      index_.insert(tree_[id].world_from_body, id);
    }
  }
  left_out_.clear();
  std::size_t next_pending = 0;
  for (NodeId id = pop_least(level, next_pending); id != kNoNode;
       id = pop_least(level, next_pending)) {
    ++result_.work_nodes;
    if (expired()) {
      return Progress::kDeadline;
    }
    bool pruned = false;
    if (prune) {
      const Progress progress = is_pruned(id, epsilon, delta_m, level, pruned);
      if (progress != Progress::kDone) {
        return progress;
      }
    }
    if (pruned) {
      left_out_.push_back(id);
      continue;
    }
    level.open.push_back(id);
    if (indexed) {
      index_.insert(tree_[id].world_from_body, id);
    }
  }
  std::swap(level.pending, left_out_);
  return Progress::kDone;
}

ReducedValueIteration::Progress ReducedValueIteration::is_pruned(NodeId id, double epsilon,
                                                                 double delta_m, const Level& level,
                                                                 bool& pruned) {
  pruned = false;
  const double cost = tree_[id].cost;
  const Pose2 pose = tree_[id].world_from_body;
  const double delta2_m2 = delta_m * delta_m;
  Progress progress = Progress::kDone;
  const auto go_on_after = [&](NodeId other) {
    // Cheapest test first: cost, distance, then the blocks.
    if (tree_[other].cost > cost ||
        metric_.squared(tree_[other].world_from_body, pose) > delta2_m2) {
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
  } else {  // everything crosses everything
    static_cast<void>(std::all_of(level.open.begin(), level.open.end(), go_on_after));
  }
  return progress;
}

void ReducedValueIteration::offer_leaf(NodeId id) {
  const Node& leaf = tree_[id];
  if (leaf.cost >= result_.cost && best_leaf_ != kNoNode) {
    return;
  }
  if (!expander_.motion().can_stop(leaf.world_from_body, leaf.control, leaf.depth)) {
    return;
  }
  best_leaf_ = id;
  result_.cost = leaf.cost;
}

void ReducedValueIteration::fall_back_to_hover() {
  constexpr std::size_t kTriedMax = 64;
  result_.cost = kInfinity;
  for (int t = problem_->horizon_steps - 1; t >= 0; --t) {
    const Level& level = levels_[index(t)];
    NodeId best = kNoNode;
    for (std::size_t i = 0; i < std::min(level.open.size(), kTriedMax); ++i) {
      const NodeId id = level.open[i];
      const Node& node = tree_[id];
      const bool stops = t == 0
                             ? expander_.motion().can_stop_from_start()
                             : expander_.motion().can_stop(node.world_from_body, node.control, t);
      if (!stops || !expander_.ensure_posterior(tree_, id)) {
        continue;
      }
      const double cost = expander_.cost_of_hovering(tree_, id);
      if (cost < result_.cost) {
        result_.cost = cost;
        best = id;
      }
    }
    if (best != kNoNode) {
      fill_result(best);
      return;
    }
  }
}

void ReducedValueIteration::fill_result(NodeId last) {
  result_.found = true;
  result_.moving_steps = tree_[last].depth;
  for (NodeId id = last; tree_[id].parent != kNoNode; id = tree_[id].parent) {
    result_.controls.push_back(tree_[id].control);
    result_.poses.push_back(tree_[id].world_from_body);
  }
  std::reverse(result_.controls.begin(), result_.controls.end());
  std::reverse(result_.poses.begin(), result_.poses.end());
  result_.poses.resize(index(problem_->horizon_steps), tree_[last].world_from_body);
}

}  // namespace vantage::planner
