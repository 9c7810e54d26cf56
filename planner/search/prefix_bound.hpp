#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "core/reserved_array.hpp"
#include "planner/search/expander.hpp"
#include "planner/search/lattice_bound.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Anytime lower bound for plans that move at every step. A best-first search evaluates the first
/// steps of the plans exactly and uses LatticeBound for the later steps. Each open node has its own
/// bound, so the least of them bounds all plans. The node with the least bound is processed: first
/// its reference is improved, then its children are evaluated with this reference.
///
/// Allocates nothing after construction. Source: ours.
class PrefixBound {
 public:
  PrefixBound(int targets_max, int horizon_max);

  /// Commits the first MiB of each array.
  void prefault();

  /// Tabulates `problem`. Call expander.reset(problem) first. Both arguments must outlive the
  /// queries.
  void reset(const SearchProblem& problem, Expander& expander);

  /// True if this problem cannot be bounded.
  [[nodiscard]] bool is_empty() const { return lattice_.is_empty(); }

  struct Answer {
    double cost = 0.0;     ///< never decreases from call to call; −∞: no bound yet
    bool expired = false;  ///< the deadline expired
  };
  /// Continues until `work_nodes` reaches `until_nodes`, the deadline expires or no work is left.
  Answer raise(std::int64_t until_nodes, const Deadline& deadline, std::int64_t& work_nodes);

 private:
  struct Entry {
    double f = 0.0;
    NodeId id = kNoNode;
  };

  void push(NodeId id, double f);
  /// Processes the open node with the least bound. False if the deadline expired or memory is used
  /// up.
  bool step(const Deadline& deadline, std::int64_t& work_nodes);
  bool better(Entry least, const Deadline& deadline, std::int64_t& work_nodes);
  bool expand(Entry least, const Deadline& deadline, std::int64_t& work_nodes);

  /// Returns the bound of a new node with its parent's reference; −∞ if time or memory is used up.
  double cost_to_go(NodeId id, const Deadline& deadline, std::int64_t& work_nodes);

  LatticeBound lattice_;
  Tree tree_;
  const SearchProblem* problem_ = nullptr;
  Expander* expander_ = nullptr;
  Children children_;
  std::vector<Entry> open_;          ///< a heap, least f first
  ReservedArray<float> references_;  ///< references of improved nodes, indexed by Node::next
  std::vector<float> scratch_;
  std::size_t reference_count_ = 0;
  double proven_ = 0.0;
  bool expired_ = false;
  bool is_exhausted_ = false;  ///< no nodes left to process, or no memory
};

}  // namespace vantage::planner
