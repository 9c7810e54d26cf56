#include "planner/search/prefix_bound.hpp"

#include <algorithm>
#include <span>

#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

constexpr std::size_t kNodesMax = 1U << 15U;
constexpr std::size_t kBlockDoublesMax = 1U << 20U;
constexpr std::size_t kReferenceFloatsMax = 1U << 21U;
constexpr std::size_t kStatesMax = 1'700'000;

// Improvement steps of a node at this depth. The root starts with coarse lattices, because
// Frank-Wolfe steps gain more there than a fine lattice.
struct Turn {
  std::size_t states = 0;
  double share = 0.0;  // size of the step towards the best path's information
};
constexpr Turn kOfRoot[] = {{300'000, 0.67}, {300'000, 0.5},  {300'000, 0.4},
                            {300'000, 0.33}, {700'000, 0.29}, {kStatesMax, 0.25}};
constexpr Turn kOfOthers[] = {{100'000, 0.4}, {300'000, 0.4}, {300'000, 0.3}};
constexpr std::size_t kStatesOfChild = 100'000;

std::span<const Turn> turns_of(const Node& node) {
  return node.depth == 0 ? std::span<const Turn>(kOfRoot) : std::span<const Turn>(kOfOthers);
}

constexpr auto kLater = [](const auto& a, const auto& b) {
  return a.f > b.f || (a.f == b.f && a.id < b.id);
};

}  // namespace

PrefixBound::PrefixBound(int targets_max, int horizon_max)
    : lattice_(targets_max, horizon_max, kStatesMax),
      tree_(kNodesMax, kBlockDoublesMax),
      references_(kReferenceFloatsMax),
      scratch_(3 * index(targets_max) * index(horizon_max)) {
  open_.reserve(kNodesMax);
}

void PrefixBound::prefault() {
  lattice_.prefault();
  tree_.prefault();
  references_.prefault();
}

void PrefixBound::reset(const SearchProblem& problem, Expander& expander) {
  problem_ = &problem;
  expander_ = &expander;
  lattice_.reset(problem, expander.beliefs());
  tree_.clear();
  open_.clear();
  reference_count_ = 0;
  proven_ = -kInfinity;
  // The lattice needs motion: without it, the bound of a robot that only turns would be too large.
  const bool moves = std::any_of(problem.controls.begin(), problem.controls.end(),
                                 [](const auto& control) { return control.speed_mps > 0.0; });
  is_exhausted_ = !moves || lattice_.reference_size() > references_.size();
}

void PrefixBound::push(NodeId id, double f) {
  open_.push_back({f, id});
  std::push_heap(open_.begin(), open_.end(), kLater);
}

PrefixBound::Answer PrefixBound::raise(std::int64_t until_nodes, const Deadline& deadline,
                                       std::int64_t& work_nodes) {
  if (is_empty()) {
    return {-kInfinity, false};
  }
  expired_ = false;
  if (tree_.node_count() == 0 && !is_exhausted_) {
    lattice_.begin(references_.data());
    reference_count_ = 1;
    Node root = expander_->root();
    root.next = 0;  // index of the root's reference
    push(tree_.add(root), -kInfinity);
  }
  while (!is_exhausted_ && !open_.empty() && work_nodes < until_nodes &&
         step(deadline, work_nodes)) {
    proven_ = std::max(proven_, open_.empty() ? kInfinity : open_.front().f);
  }
  return {proven_, expired_};
}

bool PrefixBound::step(const Deadline& deadline, std::int64_t& work_nodes) {
  const Entry least = open_.front();
  const Node& node = tree_[least.id];
  if (node.depth == problem_->horizon_steps) {
    is_exhausted_ = true;  // the node of the least bound is a complete plan, so no plan costs less
    return true;
  }
  return node.state < turns_of(node).size() ? better(least, deadline, work_nodes)
                                            : expand(least, deadline, work_nodes);
}

bool PrefixBound::better(Entry least, const Deadline& deadline, std::int64_t& work_nodes) {
  const std::size_t size = lattice_.reference_size();
  Node& node = tree_[least.id];
  if (!expander_->ensure_posterior(tree_, least.id) ||
      (reference_count_ + 1) * size > references_.size()) {
    is_exhausted_ = true;
    return false;
  }
  const bool is_own = node.state > 0;
  float* const own = references_.data() + (is_own ? node.next : reference_count_) * size;
  if (!is_own) {
    std::copy_n(references_.data() + node.next * size, size, own);
  }
  const Turn& turn = turns_of(node)[node.state];
  const auto answer =
      lattice_.cost_to_go(node.world_from_body, node.depth, tree_.posterior(least.id), own,
                          turn.share, turn.states, deadline, work_nodes);
  expired_ = answer.expired;
  if (expired_) {
    return false;
  }
  if (!is_own) {
    node.next = static_cast<NodeId>(reference_count_++);
  }
  ++node.state;
  std::pop_heap(open_.begin(), open_.end(), kLater);
  open_.pop_back();
  push(least.id, std::max(least.f, node.cost + answer.cost));
  return true;
}

bool PrefixBound::expand(Entry least, const Deadline& deadline, std::int64_t& work_nodes) {
  const std::size_t controls = problem_->controls.size();
  if (tree_.node_count() + controls > kNodesMax || open_.size() + controls > open_.capacity() ||
      !expander_->expand(tree_, least.id, children_)) {
    is_exhausted_ = true;
    return false;
  }
  const auto first = static_cast<NodeId>(tree_.node_count());
  const Node& parent = tree_[least.id];
  for (int i = 0; i < children_.count; ++i) {
    Node child;
    child.world_from_body = children_.world_from_body[i];
    child.cost = children_.cost[i];
    child.parent = least.id;
    child.control = children_.control[i];
    child.depth = static_cast<std::uint8_t>(parent.depth + 1);
    child.next = parent.next;
    const NodeId id = tree_.add(child);
    children_.cost[i] = std::max(least.f, child.cost + cost_to_go(id, deadline, work_nodes));
    if (expired_ || is_exhausted_) {
      return false;  // the parent's bound also holds for its children
    }
  }
  std::pop_heap(open_.begin(), open_.end(), kLater);
  open_.pop_back();
  for (int i = 0; i < children_.count; ++i) {
    push(first + static_cast<NodeId>(i), children_.cost[i]);
  }
  return true;
}

double PrefixBound::cost_to_go(NodeId id, const Deadline& deadline, std::int64_t& work_nodes) {
  const Node& node = tree_[id];
  if (node.depth == problem_->horizon_steps) {
    return 0.0;
  }
  if (!expander_->ensure_posterior(tree_, id)) {
    is_exhausted_ = true;
    return -kInfinity;
  }
  const std::size_t size = lattice_.reference_size();
  std::copy_n(references_.data() + node.next * size, size, scratch_.data());
  const auto answer =
      lattice_.cost_to_go(node.world_from_body, node.depth, tree_.posterior(id), scratch_.data(),
                          0.0, kStatesOfChild, deadline, work_nodes);
  expired_ = answer.expired;
  return answer.cost;
}

}  // namespace vantage::planner
