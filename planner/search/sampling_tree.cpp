#include "planner/search/sampling_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/check.hpp"
#include "core/index.hpp"
#include "core/infinity.hpp"
#include "core/uniform.hpp"

namespace vantage::planner {
namespace {

constexpr int kSweepsMax = 14;                    // the last sweep has ε = δ = 0
constexpr std::int64_t kFirstSweepNodes = 2'000;  // work of the first sweep
constexpr int kRivals = 4;        // number of drawn nodes; a branch begins at the cheapest
constexpr int kDrawsMax = 16;     // draws of a branch's start; after these the root is taken
constexpr double kNoGain = 1e-9;  // gains below this are rounding errors

std::uint64_t hash_of(std::uint64_t key) {  // finaliser of splitmix64
  key = (key ^ (key >> 30U)) * 0xBF58476D1CE4E5B9U;
  key = (key ^ (key >> 27U)) * 0x94D049BB133111EBU;
  return key ^ (key >> 31U);
}

}  // namespace

SamplingTree::SamplingTree(const SearchCapacity& capacity)
    : TreeSearch(capacity, kSweepsMax + 1),
      root_bound_(capacity.targets_max, capacity.horizon_max),
      heuristic_(capacity.targets_max, capacity.horizon_max),
      terminal_(capacity.targets_max),
      sighting_(capacity.targets_max),
      growths_(capacity.nodes_max),
      cells_(std::bit_ceil(capacity.nodes_max)),
      epochs_(cells_.size()) {
  floors_.reserve(index(capacity.horizon_max + 1));
}

void SamplingTree::prefault() {
  tree_.prefault();
  growths_.prefault();
  cells_.prefault();
  epochs_.prefault();
  root_bound_.prefault();
}

double SamplingTree::draw(double low, double high) { return uniform(random_, low, high); }

std::uint32_t SamplingTree::draw_below(std::size_t count) {
  return static_cast<std::uint32_t>(random_() % count);
}

// Long function: it makes the sweeps and sets all fields of the result.
const SearchResult& SamplingTree::plan(const SearchProblem& problem,
                                       const SamplingTreeOptions& options,
                                       const Deadline& deadline) {
  require_valid(problem);
  require_fits(problem, capacity_);
  demand(options.epsilon >= 0.0 && options.delta_m >= 0.0, "sampling_tree: ε and δ must be ≥ 0");
  demand(options.yaw_weight_m_per_rad >= 0.0, "sampling_tree: the yaw weight must be ≥ 0");

  problem_ = &problem;
  options_ = &options;
  deadline_ = &deadline;
  metric_ = {options.yaw_weight_m_per_rad};
  random_.seed(problem.seed);
  tree_.clear();
  expander_.reset(problem);
  heuristic_.reset(problem, expander_.beliefs());
  terminal_.reset(problem, expander_.beliefs(), heuristic_);
  sighting_.reset(problem, expander_);
  floors_.assign(index(problem.horizon_steps + 1), 0.0);
  for (int t = problem.horizon_steps - 1; t >= 0; --t) {
    floors_[index(t)] = floors_[index(t + 1)] + heuristic_.stage_floor(t + 1);
  }
  result_.reset();
  result_.has_terminal_value = !problem.terminal.is_empty();
  result_.lower_bound = root_bound_.of_any_plan(problem, expander_.beliefs());
  double moving_bound = result_.lower_bound;

  const NodeId root = tree_.add(expander_.root());
  growths_[root] = Growth{};
  sweep_ = 0;
  branches_ = 0;
  begin_sweep();
  Progress progress = Progress::kDone;
  result_.stop_reason = StopReason::kFinished;
  while (progress == Progress::kDone && tree_[root].state != kComplete) {
    progress = grow_branch();
    if (progress == Progress::kDone && result_.work_nodes >= sweep_end_nodes_ &&
        sweep_ < kSweepsMax) {
      result_.epsilon = epsilon_;
      result_.delta_m = delta_m_;
      ++result_.passes;
      result_.history.push_back({epsilon_, delta_m_, result_.cost, result_.work_nodes});
      ++sweep_;
      begin_sweep();
      if (moving_bound == result_.lower_bound &&
          result_.work_nodes >= RootBound::kMovingBoundAfterNodes) {
        const auto bound = root_bound_.of_moving_plan(deadline, result_.work_nodes);
        moving_bound = std::max(moving_bound, bound.cost);
        progress = bound.expired ? Progress::kDeadline : progress;
      }
    }
  }
  if (progress != Progress::kDone) {
    result_.stop_reason =
        progress == Progress::kDeadline ? StopReason::kDeadline : StopReason::kMemory;
  }
  if (!result_.found) {
    result_.stop_reason =
        result_.stop_reason == StopReason::kFinished ? StopReason::kConverged : result_.stop_reason;
    fall_back_to_hover();
  } else {
    result_.lower_bound =
        result_.stop_reason == StopReason::kFinished ? result_.cost : moving_bound;
  }
  result_.lower_bound = std::min(result_.lower_bound, result_.cost);  // corrects rounding
  result_.peak_bytes =
      tree_.bytes_used() + tree_.node_count() * (sizeof(Growth) + sizeof(NodeId) + sizeof(epoch_));
  return result_;
}

// Empties the cells. Nodes of earlier sweeps enter them again when a branch passes through them.
void SamplingTree::begin_sweep() {
  const bool is_last = sweep_ == kSweepsMax;
  const double scale = is_last ? 0.0 : std::ldexp(1.0, -sweep_);
  epsilon_ = scale * options_->epsilon;
  delta_m_ = scale * options_->delta_m;
  sweep_end_nodes_ = result_.work_nodes + (kFirstSweepNodes << static_cast<unsigned>(sweep_));
  if (++epoch_ == 0) {
    std::fill(epochs_.begin(), epochs_.end(), 0U);
    epoch_ = 1;
  }
}

NodeId SamplingTree::draw_start() {
  const NodeId root = 0;
  const std::size_t count = tree_.node_count();
  const auto depth = static_cast<int>(draw_below(index(problem_->horizon_steps)));
  const int rivals = draw(0.0, 1.0) < options_->breadth ? 1 : kRivals;
  NodeId best = kNoNode;
  int found = 0;
  for (int k = 0; k < kDrawsMax && found < rivals; ++k) {
    NodeId id = draw_below(count);
    while (tree_[id].depth > depth) {
      id = tree_[id].parent;
    }
    if (tree_[id].depth < depth || tree_[id].state != kExpanded) {
      continue;
    }
    ++found;
    best = best == kNoNode || tree_[id].cost < tree_[best].cost ? id : best;
  }
  return best == kNoNode ? root : best;
}

// Draws in the frame of the start, so that plans do not depend on the frame of the world.
Eigen::Vector2d SamplingTree::draw_goal() {
  const double turn_rad = draw(-kPi, kPi) + problem_->start.yaw_rad;
  const double share = std::sqrt(draw(0.0, 1.0));
  const Eigen::Vector2d direction(std::cos(turn_rad), std::sin(turn_rad));
  if (!problem_->targets.empty() && draw(0.0, 1.0) < options_->near_targets) {
    const auto m = static_cast<int>(draw_below(problem_->targets.size()));
    const double sight_m =
        std::min(heuristic_.sight_m(m), heuristic_.step_m() * problem_->horizon_steps);
    return expander_.beliefs().mean_m(m, problem_->horizon_steps).head<2>() +
           0.7 * share * sight_m * direction;
  }
  return problem_->start.position_m() +
         share * heuristic_.step_m() * problem_->horizon_steps * direction;
}

NodeId SamplingTree::child_by(NodeId id, int control) const {
  NodeId child = growths_[id].first_child;
  while (child != kNoNode && tree_[child].control != control) {
    child = tree_[child].next;
  }
  return child;
}

void SamplingTree::close(NodeId id, int control) {
  Growth& growth = growths_[id];
  const std::uint64_t bit = std::uint64_t{1} << static_cast<unsigned>(control);
  if ((growth.closed & bit) == 0) {
    growth.closed |= bit;
    --growth.controls_left;
  }
}

SamplingTree::Progress SamplingTree::expand(NodeId id) {
  if (work()) {
    return Progress::kDeadline;
  }
  if (!expander_.expand(tree_, id, children_)) {
    return Progress::kMemory;
  }
  ++result_.nodes_expanded;
  result_.nodes_generated += children_.count;
  result_.work_nodes += children_.count;
  const int t = tree_[id].depth + 1;
  const bool is_last = t == problem_->horizon_steps;
  if (tree_[id].state != kExpanded) {
    tree_[id].state = kExpanded;
    growths_[id].controls_left = children_.count;
  }
  const double value_here = expander_.terminal_value(tree_, id);
  // The bound of Theorem 6 for the node itself can close all of its children at once.
  double bound = -kInfinity;
  if (result_.found && !is_last) {
    if (work()) {
      return Progress::kDeadline;
    }
    bound = tree_[id].cost - value_here +
            heuristic_.cost_to_go(tree_[id].world_from_body, t - 1, tree_.posterior(id)) +
            terminal_.least(tree_[id].world_from_body, t - 1);
  }
  for (int i = 0; i < children_.count; ++i) {
    if (is_last) {
      if (children_.cost[i] < result_.cost &&
          expander_.motion().can_stop(children_.world_from_body[i], children_.control[i], t)) {
        result_.cost = children_.cost[i];
        write_path(tree_, id, children_.control[i], children_.world_from_body[i], result_);
      }
      close(id, children_.control[i]);
      continue;
    }
    const double child_bound = children_.cost[i] - value_here - children_.terminal_rise[i] +
                               floors_[index(t)] + terminal_.least(children_.world_from_body[i], t);
    if (std::max(bound, child_bound) >= result_.cost) {
      close(id, children_.control[i]);
    }
  }
  return Progress::kDone;
}

int SamplingTree::choose_child(NodeId id, const Eigen::Vector2d& goal_m) {
  const int t = tree_[id].depth + 1;
  const double open_loop = expander_.beliefs().open_loop_cost(t);
  const double outlook = options_->persistence * (problem_->horizon_steps - t);
  const double way = draw(0.0, 1.0);
  const bool is_drawn = branches_ > 0 && way < options_->wander;
  const bool is_greedy = branches_ == 0 || (!is_drawn && way < options_->wander + options_->greed);
  const bool is_blind = tree_.posterior(id).targets.empty();
  const Growth& growth = growths_[id];
  const std::uint64_t shut =
      growth.closed | (growth.rejected_epoch == epoch_ ? growth.rejected : 0);
  int best = -1;
  double best_rank = kInfinity;
  for (int i = 0; i < children_.count; ++i) {
    if ((shut >> static_cast<unsigned>(children_.control[i]) & 1U) != 0) {
      continue;
    }
    double rank = 0.0;
    if (is_drawn) {
      rank = draw(0.0, 1.0);
    } else if (is_greedy) {
      const double gained =
          open_loop - (children_.cost[i] - tree_[id].cost - children_.terminal_rise[i]);
      rank = children_.cost[i] - outlook * gained;
      if (is_blind && gained < kNoGain) {
        rank -= options_->anticipation * sighting_.value(children_.world_from_body[i], t);
      }
    } else {
      rank = (children_.world_from_body[i].position_m() - goal_m).squaredNorm();
    }
    if (best < 0 || rank < best_rank) {
      best = i;
      best_rank = rank;
    }
  }
  return best;
}

std::size_t SamplingTree::bucket(const Pose2& pose, int depth, int dx, int dy) const {
  std::int64_t x = std::bit_cast<std::int64_t>(pose.x_m + 0.0);
  std::int64_t y = std::bit_cast<std::int64_t>(pose.y_m + 0.0);
  if (delta_m_ > 0.0) {
    constexpr double kCells = 1e15;
    x = static_cast<std::int64_t>(std::clamp(std::floor(pose.x_m / delta_m_), -kCells, kCells)) +
        dx;
    y = static_cast<std::int64_t>(std::clamp(std::floor(pose.y_m / delta_m_), -kCells, kCells)) +
        dy;
  }
  const std::uint64_t key =
      hash_of(static_cast<std::uint64_t>(x) +
              hash_of(static_cast<std::uint64_t>(y) * 257U + static_cast<std::uint64_t>(depth)));
  return static_cast<std::size_t>(key) & (cells_.size() - 1);
}

// Looks at the nodes in the nine cells around the node. A bucket can contain nodes of other cells
// and depths.
SamplingTree::Progress SamplingTree::reject(NodeId id, bool& is_rejected) {
  is_rejected = false;
  const Node node = tree_[id];
  const int reach = delta_m_ > 0.0 ? 1 : 0;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const std::size_t at = bucket(node.world_from_body, node.depth, dx, dy);
      NodeId other = epochs_[at] == epoch_ ? cells_[at] : kNoNode;
      for (; other != kNoNode; other = growths_[other].next_in_cell) {
        if (work()) {
          return Progress::kDeadline;
        }
        if (other == id || tree_[other].depth != node.depth || tree_[other].cost > node.cost ||
            !metric_.crosses(tree_[other].world_from_body, node.world_from_body, delta_m_)) {
          continue;
        }
        if (!expander_.ensure_posterior(tree_, id) || !expander_.ensure_posterior(tree_, other)) {
          return Progress::kMemory;
        }
        if (expander_.is_redundant(tree_, id, epsilon_, other)) {
          is_rejected = true;
          return Progress::kDone;
        }
      }
    }
  }
  return Progress::kDone;
}

SamplingTree::Progress SamplingTree::grow_branch() {
  NodeId id = draw_start();
  const Eigen::Vector2d goal_m = draw_goal();
  while (true) {
    Progress progress = expand(id);
    if (progress != Progress::kDone) {
      return progress;
    }
    const int i = choose_child(id, goal_m);
    if (i < 0) {
      break;
    }
    NodeId child = kNoNode;
    progress = enter_child(id, i, child);
    if (progress != Progress::kDone) {
      return progress;
    }
    if (child == kNoNode) {
      break;
    }
    id = child;
  }
  ++branches_;
  complete(id);
  return Progress::kDone;
}

void SamplingTree::complete(NodeId id) {
  while (growths_[id].controls_left == 0) {
    tree_[id].state = kComplete;
    if (tree_[id].parent == kNoNode) {
      return;
    }
    close(tree_[id].parent, tree_[id].control);
    id = tree_[id].parent;
  }
}

SamplingTree::Progress SamplingTree::enter_child(NodeId id, int i, NodeId& child) {
  const int t = tree_[id].depth + 1;
  child = child_by(id, children_.control[i]);
  if (child == kNoNode) {
    child = tree_.add(children_.node(i, id, t));
    if (child == kNoNode) {
      return Progress::kMemory;
    }
    growths_[child] = Growth{};
    tree_[child].next = growths_[id].first_child;
    growths_[id].first_child = child;
  }
  if (growths_[child].cell_epoch == epoch_) {
    return Progress::kDone;
  }
  bool is_rejected = false;
  if (tree_[child].state != kExpanded) {
    const Progress progress = reject(child, is_rejected);
    if (progress != Progress::kDone) {
      return progress;
    }
  }
  if (is_rejected) {
    Growth& growth = growths_[id];
    if (epsilon_ == 0.0 && delta_m_ == 0.0) {
      tree_[child].state = kComplete;
      close(id, children_.control[i]);
    } else {
      tree_[child].state = kRejected;
      growth.rejected = growth.rejected_epoch == epoch_ ? growth.rejected : 0;
      growth.rejected_epoch = epoch_;
      growth.rejected |= std::uint64_t{1} << static_cast<unsigned>(children_.control[i]);
    }
    child = kNoNode;
    return Progress::kDone;
  }
  if (tree_[child].state == kRejected) {
    tree_[child].state = kNew;
  }
  const std::size_t at = bucket(tree_[child].world_from_body, t, 0, 0);
  growths_[child].next_in_cell = epochs_[at] == epoch_ ? cells_[at] : kNoNode;
  growths_[child].cell_epoch = epoch_;
  epochs_[at] = epoch_;
  cells_[at] = child;
  return Progress::kDone;
}

void SamplingTree::fall_back_to_hover() {
  constexpr int kTriedMax = 64;
  result_.cost = kInfinity;
  const auto offer = [&](int t, HoverChoice& choice) {
    int tried = 0;
    for (NodeId id = 0; id < tree_.node_count() && tried < kTriedMax; ++id) {
      if (tree_[id].depth == t) {
        choice.offer(id);
        ++tried;
      }
    }
  };
  hover_as_late_as_safe(problem_->horizon_steps, offer);
}

}  // namespace vantage::planner
