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

/// How a refining beam goes from pass to pass. The defaults are what the planner study found.
struct BeamOptions {
  int first_width = 16;       ///< nodes kept a depth in the pass after the greedy one
  double growth = 2.0;        ///< of the width, from pass to pass
  double cell_m = 1.0;        ///< edge of the diversity cells at the first width …
  double cell_rad = 1.0;      ///< … and their extent in yaw
  double shrink = 0.82;       ///< of both, from pass to pass
  double alternation = 0.6;   ///< and every other pass has cells this much narrower
  double breadth = 0.3;       ///< share of the width that goes to the best of each region
  double anticipation = 0.3;  ///< share of what a first sighting would bring that counts before it
  double persistence = 0.5;   ///< share of a depth's information that is expected to last
};

/// Refining beam search: passes of a beam whose width grows and whose diversity cells shrink.
///
/// A pass goes depth by depth. Of all children that fall into one cell over (x, y, yaw) only the
/// most promising stays; of those, first the most promising of each region (4 × 4 × 4 cells), up to
/// a share of the width, then the most promising of all. Promising is a low rank:
/// accumulated cost, less what the depth's information is expected to be worth later, less the
/// value of the target that can be sighted soonest while nothing has been seen yet. The first pass
/// has width 1, so a plan exists after T expansions; every pass begins at the root and keeps
/// nothing but the best plan, so memory is that of one beam.
///
/// The schedule of widths follows the pass, never the clock: a search that the clock stopped is
/// replayed to the bit under Deadline::nodes(work_nodes). When a pass left nothing out, its best
/// leaf is the optimum (kFinished, lower_bound = cost).
///
/// Guarantees: the cost never rises with the budget; asks the deadline at each expansion and at
/// every few hundred candidates; allocates nothing in plan() while the problem fits the capacity.
/// Sound but without a bound of its own until it is exhaustive: lower_bound is RootBound's, that of
/// moving plans once the search has done RootBound::kWorthAfterNodes of work.
class RefiningBeam : private TreeSearch {
 public:
  explicit RefiningBeam(const SearchCapacity& capacity);

  /// Takes all the memory that was reserved, so that no page fault comes in plan(): for real time.
  void prefault();

  /// The best plan found by the deadline. The reference is good until the next call.
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
    double cell_m = 0.0;  ///< 0: every child is a cell of its own
    double cell_rad = 0.0;
    double offset = 0.0;     ///< of the cells' corners, in cells
    bool merged = false;     ///< two children fell into one cell
    bool truncated = false;  ///< more cells than the width
  };
  enum class Progress { kDone, kDeadline, kMemory };

  void run_passes(const BeamOptions& options, std::size_t width_max);
  /// Works on the bound, as much as the passes so far are worth; false: out of time.
  bool raise_bound();
  Progress run(Pass& pass);
  Progress expand_level(Pass& pass, int t);
  [[nodiscard]] Cell& cell_at(ReservedArray<Cell>& cells, std::uint64_t key) const;
  void offer_candidate(Pass& pass, Candidate& candidate, double rank);
  /// Makes the `width` best candidates nodes of depth t.
  Progress select(Pass& pass, int t);
  /// Marks the `room` best of the candidates that carry `from` with kKept; false: out of time.
  bool keep_best(std::size_t room, Mark from);
  void offer_leaf(const Candidate& leaf);
  /// When no depth-T node can stop safely: stop as late as is safe, and hover.
  void fall_back_to_hover();
  /// One more piece of work; true when the search has to stop.
  bool work() {
    ++result_.work_nodes;
    return expired();
  }

  static constexpr double kNothing = 1e-9;  ///< gained by a look that sees nothing, to rounding

  RootBound root_bound_;
  std::vector<NodeId> level_begin_;  ///< first node of each depth of the pass
  int levels_ = 0;
  ReservedArray<Candidate> candidates_;
  std::size_t candidate_count_ = 0;
  ReservedArray<double> ranks_;  ///< of each candidate
  ReservedArray<Mark> marks_;    ///< of each candidate
  ReservedArray<Cell> cells_;    ///< open addressing; an entry of another epoch is empty
  ReservedArray<Cell> regions_;  ///< the same for regions, blocks of cells
  std::size_t cell_mask_ = 0;
  std::uint32_t epoch_ = 0;
  SightingValue sighting_;
  double moving_bound_ = 0.0;  ///< of plans that move at every step
  std::int64_t raised_at_nodes_ = 0;
  const BeamOptions* options_ = nullptr;
};

}  // namespace vantage::planner
