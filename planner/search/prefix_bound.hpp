#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "core/reserved_array.hpp"
#include "planner/search/expander.hpp"
#include "planner/search/lattice_bound.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// A bound on plans that move at every step, raised for as long as there is time: best first over
/// the plans' first steps, which are made exactly, with LatticeBound for the rest. What is open is
/// bounded each by itself, so what is least is a bound on all. Of the node that is least, first the
/// reference is bettered, then its children are looked at with it.
///
/// Allocates nothing after construction. Source: ours.
class PrefixBound {
 public:
  PrefixBound(int targets_max, int horizon_max);

  /// Takes all the memory that was reserved.
  void prefault();

  /// Tables `problem`; all three must outlive the queries, `expander` reset to it.
  void reset(const SearchProblem& problem, Expander& expander);

  /// Whether it bounds nothing of this problem.
  [[nodiscard]] bool is_empty() const { return lattice_.is_empty(); }

  struct Answer {
    double cost = 0.0;     ///< no less than what was answered before; −∞: nothing yet
    bool expired = false;  ///< the deadline came
  };
  /// Goes on until `work_nodes` is at `until_nodes`, the deadline comes or nothing is left to do.
  Answer raise(std::int64_t until_nodes, const Deadline& deadline, std::int64_t& work_nodes);

 private:
  struct Entry {
    double f = 0.0;
    NodeId id = kNoNode;
  };

  void push(NodeId id, double f);
  /// Works on the least open node. False when the deadline came or memory is used up.
  bool step(const Deadline& deadline, std::int64_t& work_nodes);
  bool better(Entry least, const Deadline& deadline, std::int64_t& work_nodes);
  bool expand(Entry least, const Deadline& deadline, std::int64_t& work_nodes);

  /// Of a new node with its parent's reference; −∞ when there is no more time or memory.
  double cost_to_go(NodeId id, const Deadline& deadline, std::int64_t& work_nodes);

  LatticeBound lattice_;
  Tree tree_;
  const SearchProblem* problem_ = nullptr;
  Expander* expander_ = nullptr;
  Children children_;
  std::vector<Entry> open_;          ///< a heap, least f first
  ReservedArray<float> references_;  ///< of nodes that were bettered; Node::next says which
  std::vector<float> scratch_;
  std::size_t reference_count_ = 0;
  double proven_ = 0.0;
  bool expired_ = false;
  bool full_ = false;  ///< nothing is left to do, or no memory to do it with
};

}  // namespace vantage::planner
