#include "planner/search/astar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.hpp"
#include "core/index.hpp"
#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

constexpr float kInfinityF = std::numeric_limits<float>::infinity();
constexpr int kStopsPerDepth = 16;
constexpr int kSequenceStates = 4'000;

enum NodeState : std::uint8_t {
  kGenerated = 0,
  kEvaluated = 1,
  kPartly = 2,
  kSequenced = 3,
  kClosed = 4
};

// Nodes with the least key come first; of nodes with equal keys, the younger, usually deeper one.
constexpr auto kAfter = [](const auto& a, const auto& b) {
  return a.key > b.key || (a.key == b.key && a.id < b.id);
};

}  // namespace

BestFirstSearch::BestFirstSearch(const SearchCapacity& capacity)
    : TreeSearch(capacity, 1),
      heuristic_(capacity.targets_max, capacity.horizon_max),
      sequencing_(capacity.targets_max, capacity.horizon_max, kSequenceStates),
      terminal_(capacity.targets_max),
      index_(capacity.nodes_max),
      child_f_at_(capacity.nodes_max),
      f_(capacity.nodes_max),
      stops_(index(capacity.horizon_max + 1) * kStopsPerDepth),
      stop_counts_(index(capacity.horizon_max + 1)) {
  child_f_.reserve(4 * capacity.nodes_max);
  open_.reserve(capacity.nodes_max + 1);
  floors_.reserve(2 * capacity.nodes_max + 2);
  floor_sums_.reserve(index(capacity.horizon_max + 1));
}

void BestFirstSearch::prefault() {
  tree_.prefault();
  index_.prefault();
  child_f_at_.prefault();
  f_.prefault();
}

void BestFirstSearch::start(const SearchProblem& problem, const BestFirstOptions& options) {
  problem_ = &problem;
  options_ = options;
  metric_ = {options.yaw_weight_m_per_rad};
  tree_.clear();
  expander_.reset(problem);
  heuristic_.reset(problem, expander_.beliefs());
  sequencing_.reset(problem, expander_.beliefs(), heuristic_);
  terminal_.reset(problem, expander_.beliefs(), heuristic_);
  index_.reset(options.delta_m);
  child_f_.assign(1, 0.0F);  // entry 0 is unused, because index 0 means "none"
  open_.clear();
  floors_.clear();
  open_peak_ = 0;
  floors_peak_ = 0;
  floor_sums_.assign(index(problem.horizon_steps + 1), 0.0);
  for (int k = 1; k <= problem.horizon_steps; ++k) {
    floor_sums_[index(k)] = floor_sums_[index(k - 1)] + heuristic_.stage_floor(k);
  }
  weighted_ = options.search != BestFirst::kAStar && options.weight > 1.0 &&
              std::isfinite(floor_sums_.back());
  std::fill(stop_counts_.begin(), stop_counts_.end(), 0);
  next_dive_ = 0;
  dives_ = true;
  least_dominated_ = kInfinity;
  best_parent_ = kNoNode;
  result_.reset();
  result_.has_terminal_value = !problem.terminal.is_empty();
  result_.epsilon = options.search == BestFirst::kAegis ? options.epsilon : 0.0;
  result_.delta_m = options.search == BestFirst::kAegis ? options.delta_m : 0.0;
  next_ = tree_.add(expander_.root());
  expander_.ensure_posterior(tree_, next_);
  stops_[0] = next_;
  stop_counts_[0] = 1;
  f_[next_] = floor_sums_.back() + terminal_.of_any_plan();
  child_f_at_[next_] = 0;
}

const SearchResult& BestFirstSearch::plan(const SearchProblem& problem,
                                          const BestFirstOptions& options,
                                          const Deadline& deadline) {
  require_valid(problem);
  demand(capacity_.nodes_max > 0, "search: nodes_max must be > 0");
  require_fits(problem, capacity_);
  demand(options.epsilon >= 0.0 && options.delta_m >= 0.0, "search: ε and δ must be ≥ 0");
  demand(options.weight >= 1.0 && std::isfinite(options.weight), "search: the weight must be ≥ 1");
  demand(options.yaw_weight_m_per_rad >= 0.0, "search: the yaw weight must be ≥ 0");
  demand(options.dive_every >= 0, "search: dive_every must be ≥ 0");
  deadline_ = &deadline;
  start(problem, options);

  Progress progress = Progress::kGoOn;
  while (progress == Progress::kGoOn) {
    progress = step();
  }
  const double least_f = least_open();
  result_.peak_bytes =
      tree_.bytes_used() + tree_.node_count() * (sizeof(f_[0]) + sizeof(child_f_at_[0])) +
      child_f_.size() * sizeof(child_f_[0]) + (open_peak_ + floors_peak_) * sizeof(Entry) +
      index_.size() * CrossingIndex::bytes_per_entry();
  if (progress == Progress::kDone) {
    result_.passes = 1;
    const bool proven = std::min(least_f, least_dominated_) >= result_.cost;
    result_.stop_reason = proven ? StopReason::kFinished : StopReason::kConverged;
    result_.history.push_back({result_.epsilon, result_.delta_m, result_.cost, result_.work_nodes});
  } else {
    result_.stop_reason =
        progress == Progress::kDeadline ? StopReason::kDeadline : StopReason::kMemory;
  }
  if (best_parent_ != kNoNode) {
    write_path(tree_, best_parent_, best_control_, best_pose_, result_);
    result_.lower_bound = std::min({result_.cost, least_f, least_dominated_});
  } else {
    fall_back_to_hover();
    // Hovering is not a path of the tree, so only the bound for every motion applies.
    result_.lower_bound = std::min(result_.cost, floor_sums_.back() + terminal_.of_any_plan());
  }
  return result_;
}

double BestFirstSearch::key(NodeId id) const {
  if (!weighted_) {
    return f_[id];
  }
  const Node& node = tree_[id];
  const double passed = floor_sums_[node.depth];
  const double ahead = floor_sums_.back() - passed;
  const double cost = node.cost - expander_.terminal_value(tree_, id);
  return (cost - passed) + options_.weight * std::max(0.0, f_[id] - cost - ahead);
}

void BestFirstSearch::push(NodeId id) {
  open_.push_back({key(id), id});
  open_peak_ = std::max(open_peak_, open_.size());
  std::push_heap(open_.begin(), open_.end(), kAfter);
  if (weighted_ && floors_.size() < floors_.capacity()) {
    floors_.push_back({f_[id], id});
    floors_peak_ = std::max(floors_peak_, floors_.size());
    std::push_heap(floors_.begin(), floors_.end(), kAfter);
  }
}

NodeId BestFirstSearch::pop() {
  std::pop_heap(open_.begin(), open_.end(), kAfter);
  const NodeId id = open_.back().id;
  open_.pop_back();
  return id;
}

void BestFirstSearch::clean_floors() {
  constexpr int kAtOnce = 4;
  for (int i = 0; i < kAtOnce && !floors_.empty(); ++i) {
    const Entry& least = floors_.front();
    if (tree_[least.id].state != kClosed && least.key == f_[least.id]) {
      return;
    }
    std::pop_heap(floors_.begin(), floors_.end(), kAfter);
    floors_.pop_back();
  }
}

double BestFirstSearch::least_open() const {
  const double held = next_ != kNoNode ? f_[next_] : kInfinity;
  if (open_.empty()) {
    return held;
  }
  return std::min(held, weighted_ ? floors_.front().key : open_.front().key);
}

bool BestFirstSearch::evaluate(NodeId id) {
  if (!expander_.ensure_posterior(tree_, id)) {
    return false;
  }
  Node& node = tree_[id];
  const double h = heuristic_.cost_to_go(node.world_from_body, node.depth, tree_.posterior(id));
  f_[id] = std::max(f_[id], node.cost - expander_.terminal_value(tree_, id) + h +
                                terminal_.least(node.world_from_body, node.depth));
  node.state = kEvaluated;
  return true;
}

BestFirstSearch::Progress BestFirstSearch::evaluate_sequence(NodeId id) {
  Node& node = tree_[id];
  const Blocks blocks = tree_.posterior(id);
  const InformationHeuristic::Parts parts = heuristic_.cost_to_go(
      node.world_from_body, node.depth, blocks, sequencing_.takes_part().data());
  const double others = node.cost - expander_.terminal_value(tree_, id) +
                        terminal_.least(node.world_from_body, node.depth) +
                        (parts.all - parts.apart);
  if (!std::isfinite(others)) {
    node.state = kSequenced;
    return Progress::kGoOn;
  }
  // Computes the bound only as far as needed to compare the node with the next ones; farther if the
  // node is selected again.
  constexpr double kShare = 0.3;
  const double least = std::max(f_[id], open_.empty() ? f_[id] : open_.front().key);
  const double enough = node.state == kEvaluated
                            ? std::min(result_.cost, least + kShare * (result_.cost - least))
                            : result_.cost;
  const SequencingBound::Answer answer = sequencing_.cost_to_go(
      node.world_from_body, node.depth, blocks, enough - others, *deadline_, result_.work_nodes);
  f_[id] = std::max(f_[id], others + answer.cost);
  if (answer.expired) {
    return Progress::kDeadline;
  }
  if (f_[id] >= enough && enough < result_.cost) {
    node.state = kPartly;
    return Progress::kGoOn;
  }
  node.state = kSequenced;
  const std::size_t controls = problem_->controls.size();
  if (child_f_.size() + controls <= child_f_.capacity()) {
    child_f_at_[id] = static_cast<std::uint32_t>(child_f_.size());
    for (std::size_t c = 0; c < controls; ++c) {
      const double after = others + sequencing_.cost_after(static_cast<int>(c));
      child_f_.push_back(std::nextafter(static_cast<float>(after), -kInfinityF));
    }
  }
  return Progress::kGoOn;
}

// Long function: it makes one expansion, whose parts use the same variables.
BestFirstSearch::Progress BestFirstSearch::step() {
  // counted before each deadline check, so that every check sees a different count
  ++result_.work_nodes;
  if (expired()) {
    return Progress::kDeadline;
  }
  const bool diving = next_ != kNoNode;
  if (!diving && open_.empty()) {
    return Progress::kDone;
  }
  if (weighted_) {
    clean_floors();
    if (!diving && options_.search == BestFirst::kWeightedAStar && best_parent_ != kNoNode &&
        open_.front().key >= result_.cost - floor_sums_.back()) {
      return Progress::kDone;
    }
  }
  const NodeId id = diving ? next_ : pop();
  next_ = kNoNode;
  const auto put_back = [&](Progress why) {
    push(id);
    return why;
  };
  if (f_[id] >= result_.cost) {
    if (!weighted_ && !diving) {
      push(id);
      return Progress::kDone;  // no other open node can cost less
    }
    tree_[id].state = kClosed;
    return Progress::kGoOn;
  }
  if (tree_[id].state == kGenerated) {
    if (!evaluate(id)) {
      return put_back(Progress::kMemory);
    }
    ++result_.work_nodes;
    if (expired()) {
      return put_back(Progress::kDeadline);
    }
    if (!diving && !open_.empty() && key(id) > open_.front().key) {
      return put_back(Progress::kGoOn);
    }
  }
  if (tree_[id].state < kSequenced && best_parent_ != kNoNode && f_[id] < result_.cost &&
      options_.bound == NodeBound::kSequence && !sequencing_.is_empty()) {
    const Progress progress = evaluate_sequence(id);
    if (progress != Progress::kGoOn) {
      return put_back(progress);
    }
    if (!diving && !open_.empty() && key(id) > open_.front().key && f_[id] < result_.cost) {
      return put_back(Progress::kGoOn);
    }
  }
  if (f_[id] >= result_.cost) {
    tree_[id].state = kClosed;
    return Progress::kGoOn;
  }
  if (options_.search == BestFirst::kAegis) {
    bool dominated = false;
    const Progress progress = is_dominated(id, dominated);
    if (progress != Progress::kGoOn) {
      return put_back(progress);
    }
    if (dominated) {
      tree_[id].state = kClosed;
      return Progress::kGoOn;
    }
    index_.insert(tree_[id].world_from_body, id);
  }
  const Progress progress = expand(id);
  return tree_[id].state == kClosed ? progress : put_back(progress);
}

BestFirstSearch::Progress BestFirstSearch::is_dominated(NodeId id, bool& dominated) {
  const Node node = tree_[id];
  Progress progress = Progress::kGoOn;
  // Number of compared nodes between two deadline checks; 64 comparisons take a few µs.
  constexpr int kAskEvery = 64;
  int passed_by = 0;
  index_.near(node.world_from_body, [&](NodeId other) {
    if (++passed_by % kAskEvery == 0) {
      ++result_.work_nodes;
      if (expired()) {
        progress = Progress::kDeadline;
        return false;
      }
    }
    const Node& twin = tree_[other];
    if (twin.depth != node.depth || twin.cost > node.cost + options_.epsilon ||
        !metric_.crosses(twin.world_from_body, node.world_from_body, options_.delta_m)) {
      return true;
    }
    ++result_.work_nodes;
    if (expired()) {
      progress = Progress::kDeadline;
      return false;
    }
    if (!expander_.is_redundant(tree_, id, options_.epsilon, other)) {
      return true;
    }
    dominated = true;
    const bool exactly = options_.epsilon == 0.0 && twin.world_from_body == node.world_from_body;
    if (!exactly) {
      least_dominated_ = std::min(least_dominated_, f_[id]);
    }
    return false;
  });
  return progress;
}

BestFirstSearch::Progress BestFirstSearch::expand(NodeId id) {
  if (!expander_.expand(tree_, id, children_)) {
    return Progress::kMemory;
  }
  const Node parent = tree_[id];
  const int depth = parent.depth + 1;
  const bool leaves = depth == problem_->horizon_steps;
  if (!leaves && tree_.node_count() + index(children_.count) > capacity_.nodes_max) {
    return Progress::kMemory;
  }
  ++result_.nodes_expanded;
  result_.nodes_generated += children_.count;
  result_.work_nodes += children_.count;
  tree_[id].state = kClosed;
  if (int& stops = stop_counts_[parent.depth]; parent.depth > 0 && stops < kStopsPerDepth) {
    stops_[index(parent.depth * kStopsPerDepth + stops++)] = id;
  }
  if (leaves) {
    for (int i = 0; i < children_.count; ++i) {
      offer_leaf(id, i);
    }
    dives_ = false;
    return Progress::kGoOn;
  }
  const NodeId first = static_cast<NodeId>(tree_.node_count());
  for (int i = 0; i < children_.count; ++i) {
    const Node child = children_.node(i, id, depth);
    const NodeId child_id = tree_.add(child);
    f_[child_id] = f_[id];
    child_f_at_[child_id] = 0;
    if (child_f_at_[id] != 0) {
      const double after = static_cast<double>(child_f_[child_f_at_[id] + index(child.control)]);
      f_[child_id] = std::max(f_[id], after);
    }
  }
  const NodeId end = static_cast<NodeId>(tree_.node_count());
  if (best_parent_ == kNoNode ||
      (options_.dive_every > 0 && result_.nodes_expanded >= next_dive_)) {
    dives_ = true;
    next_dive_ = result_.nodes_expanded +
                 (best_parent_ == kNoNode ? problem_->horizon_steps : options_.dive_every);
  }
  const Progress progress = dives_ ? choose_next(first, end) : Progress::kGoOn;
  for (NodeId child = first; child < end; ++child) {
    if (child != next_) {
      push(child);
    }
  }
  return progress;
}

BestFirstSearch::Progress BestFirstSearch::choose_next(NodeId first, NodeId end) {
  dives_ = false;
  for (NodeId child = first; child < end; ++child) {
    ++result_.work_nodes;
    if (expired()) {
      return Progress::kDeadline;
    }
    if (!evaluate(child)) {
      return Progress::kMemory;
    }
    if (f_[child] < result_.cost && (next_ == kNoNode || f_[child] < f_[next_])) {
      next_ = child;
      dives_ = true;
    }
  }
  return Progress::kGoOn;
}

void BestFirstSearch::offer_leaf(NodeId parent, int child) {
  const double cost = children_.cost[child];
  const int depth = tree_[parent].depth + 1;
  if ((best_parent_ != kNoNode && cost >= result_.cost) ||
      !expander_.motion().can_stop(children_.world_from_body[child], children_.control[child],
                                   depth)) {
    return;
  }
  best_parent_ = parent;
  best_control_ = children_.control[child];
  best_pose_ = children_.world_from_body[child];
  result_.cost = cost;
}

void BestFirstSearch::fall_back_to_hover() {
  const auto offer = [&](int t, HoverChoice& choice) {
    for (int i = 0; i < stop_counts_[index(t)]; ++i) {
      choice.offer(stops_[index(t * kStopsPerDepth + i)]);
    }
  };
  hover_as_late_as_safe(problem_->horizon_steps, offer);
}

}  // namespace vantage::planner
