#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "core/reserved_array.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/arvi.hpp"
#include "planner/search/root_bound.hpp"
#include "planner/search/sighting_value.hpp"
#include "planner/search/tree_search.hpp"

namespace vantage::planner {

/// Options of a refining beam. The defaults are the result of the planner study.
struct BeamOptions {
  int first_width = 16;      ///< nodes kept per depth in the pass after the greedy pass
  double growth = 2.0;       ///< factor by which the width grows from pass to pass
  double cell_m = 1.0;       ///< edge of the diversity cells at the first width, m
  double cell_rad = 1.0;     ///< extent of the diversity cells in yaw at the first width
  double shrink = 0.82;      ///< factor by which cell_m and cell_rad change from pass to pass
  double alternation = 0.6;  ///< extra factor of cell_m in every second pass
  double breadth = 0.3;      ///< share of the width for the best nodes of each region
  /// share of the expected value of a first sighting that is counted before the sighting
  double anticipation = 0.3;
  /// share of a depth's information gain that is expected to remain later
  double persistence = 0.5;
};

/// Refining beam search: passes of a beam with growing width and shrinking diversity cells.
///
/// A pass proceeds depth by depth. Of all children in one cell over (x, y, yaw) it keeps only the
/// most promising. The beam then keeps the most promising child of each region (4 × 4 × 4 cells),
/// up to a share of the width. The remaining width is filled with the most promising of all other
/// children. Children are ranked by accumulated cost minus the expected later value of the depth's
/// information (lower is better). Until a target has been seen, the value of the target that can be
/// seen first is also subtracted. The first pass has width 1, so a plan exists after T expansions.
/// Every pass starts at the root and keeps only the best plan, so the search needs memory for one
/// beam only.
///
/// The widths depend on the pass, not on the clock: a search stopped by the clock is replayed bit
/// for bit under Deadline::nodes(work_nodes). If a pass discarded nothing, its best leaf is the
/// optimum (kFinished, lower_bound = cost).
///
/// Guarantees: the cost never increases with the budget; the deadline is checked at each expansion
/// and every few hundred candidates; plan() allocates nothing while the problem fits the capacity.
/// Until a pass is exhaustive, lower_bound is RootBound's; after RootBound::kMovingBoundAfterNodes
/// nodes of work it is the RootBound of moving plans.
class RefiningBeam : private TreeSearch {
 public:
  explicit RefiningBeam(const SearchCapacity& capacity);

  /// Commits the first MiB of each array: plan() causes no page fault there. Use in real time.
  void prefault();

  /// Returns the best plan found by the deadline. The reference is valid until the next call.
  /// @throws UsageError when `problem` breaks a rule of require_valid or exceeds the capacity.
  const SearchResult& plan(const SearchProblem& problem, const BeamOptions& options,
                           const Deadline& deadline);

 private:
  struct Candidate {
    Pose2 world_from_body;
    double cost = 0.0;
    NodeId parent = kNoNode;
    std::uint32_t region = 0;  ///< slot in regions_
    std::int16_t control = -1;
  };
  struct Cell {
    std::uint64_t key = 0;
    std::uint32_t epoch = 0;
    std::uint32_t candidate = 0;
  };
  enum Mark : std::uint8_t { kOther, kLeader, kKept };
  struct Pass {
    std::size_t width = 1;
    std::size_t width_of_leaders = 0;
    double cell_m = 0.0;  ///< 0: every child has its own cell
    double cell_rad = 0.0;
    double offset = 0.0;     ///< offset of the cells' corners, in cells
    bool merged = false;     ///< two children fell into one cell
    bool truncated = false;  ///< more cells than the width
  };
  enum class Progress { kDone, kDeadline, kMemory };

  void run_passes(const BeamOptions& options, std::size_t width_max);
  /// Improves the bound with work in proportion to the passes so far; false: the deadline expired.
  bool raise_bound();
  Progress run(Pass& pass);
  Progress expand_level(Pass& pass, int t);
  [[nodiscard]] Cell& cell_at(ReservedArray<Cell>& cells, std::uint64_t key) const;
  void offer_candidate(Pass& pass, Candidate& candidate, double rank);
  /// Adds the `width` best candidates to the tree as nodes of depth t.
  Progress select(Pass& pass, int t);
  /// Marks the `room` best of the candidates marked `from` as kKept; false: the deadline expired.
  bool keep_best(std::size_t room, Mark from);
  void offer_leaf(const Candidate& leaf);
  /// Sets the plan if no depth-T node can stop safely: stop at the deepest safe node and hover.
  void fall_back_to_hover();
  /// Counts one unit of work; true if the search has to stop.
  bool work() {
    ++result_.work_nodes;
    return expired();
  }

  static constexpr double kNothing = 1e-9;  ///< gains below this are rounding errors

  RootBound root_bound_;
  std::vector<NodeId> level_begin_;  ///< first node of each depth of the pass
  int levels_ = 0;
  ReservedArray<Candidate> candidates_;
  std::size_t candidate_count_ = 0;
  ReservedArray<double> ranks_;  ///< rank of each candidate
  ReservedArray<Mark> marks_;    ///< mark of each candidate
  ReservedArray<Cell> cells_;    ///< hash table; entries of another epoch count as empty
  ReservedArray<Cell> regions_;  ///< hash table of regions, as cells_
  std::size_t cell_mask_ = 0;
  std::uint32_t epoch_ = 0;
  SightingValue sighting_;
  double moving_bound_ = 0.0;  ///< lower bound of plans that move at every step
  std::int64_t raised_at_nodes_ = 0;
  const BeamOptions* options_ = nullptr;
};

}  // namespace vantage::planner
