#include "planner/search/beam.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/check.hpp"
#include "core/index.hpp"
#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

// number of candidates between two deadline checks, which takes some µs
constexpr std::size_t kChunk = 128;
constexpr int kPassesMax = 100;
constexpr unsigned kRegionBits = 2;                 // a region has 4 cells in each of x, y, yaw
constexpr double kGoldenShare = 0.618033988749895;  // offset; cells of two passes do not align

std::uint64_t cell_index(double value, double cell, double offset) {
  constexpr double kCentre = 1'048'576.0;  // 2²⁰: 21 bits per coordinate
  return static_cast<std::uint64_t>(
      std::clamp(std::floor(value / cell + offset) + kCentre, 0.0, 2.0 * kCentre - 1.0));
}

std::uint64_t mixed(std::uint64_t key) {  // finaliser of splitmix64
  key = (key ^ (key >> 30U)) * 0xBF58476D1CE4E5B9U;
  key = (key ^ (key >> 27U)) * 0x94D049BB133111EBU;
  return key ^ (key >> 31U);
}

}  // namespace

RefiningBeam::RefiningBeam(const SearchCapacity& capacity)
    : TreeSearch(capacity, kPassesMax + 1),
      root_bound_(capacity.targets_max, capacity.horizon_max),
      level_begin_(index(capacity.horizon_max + 1)),
      // Only the kept children of a level become nodes.
      candidates_(std::max<std::size_t>(capacity.nodes_max, kMaxControls)),
      ranks_(candidates_.size()),
      marks_(candidates_.size()),
      cells_(std::bit_ceil(2 * candidates_.size())),
      regions_(cells_.size()),
      sighting_(capacity.targets_max) {}

void RefiningBeam::prefault() {
  tree_.prefault();
  candidates_.prefault();
  ranks_.prefault();
  marks_.prefault();
  cells_.prefault();
  regions_.prefault();
  root_bound_.prefault();
}

const SearchResult& RefiningBeam::plan(const SearchProblem& problem, const BeamOptions& options,
                                       const Deadline& deadline) {
  require_valid(problem);
  require_fits(problem, capacity_);
  demand(options.first_width >= 1 && options.growth > 1.0,
         "beam: first_width must be ≥ 1 and growth > 1");
  demand(options.cell_m > 0.0 && options.cell_rad > 0.0, "beam: cell_m and cell_rad must be > 0");
  demand(options.alternation > 0.0, "beam: alternation must be > 0");
  demand(options.breadth >= 0.0 && options.breadth <= 1.0, "beam: breadth must be in [0, 1]");
  demand(options.shrink > 0.0 && options.shrink <= 1.0, "beam: shrink must be in (0, 1]");

  problem_ = &problem;
  options_ = &options;
  deadline_ = &deadline;
  expander_.reset(problem);
  sighting_.reset(problem, expander_);
  moving_bound_ = -kInfinity;
  raised_at_nodes_ = 0;
  result_.reset();
  result_.has_terminal_value = !problem.terminal.is_empty();
  result_.stop_reason = StopReason::kMemory;
  result_.lower_bound = root_bound_.of_any_plan(problem, expander_.beliefs());

  const std::size_t width_max =
      std::max<std::size_t>(1, std::min(candidates_.size() / problem.controls.size(),
                                        (capacity_.nodes_max - 1) / index(problem.horizon_steps)));
  run_passes(options, width_max);
  if (!result_.found) {
    fall_back_to_hover();
  } else {
    result_.lower_bound = std::max(result_.lower_bound, moving_bound_);
  }
  result_.lower_bound = std::min(result_.lower_bound, result_.cost);  // corrects rounding
  return result_;
}

void RefiningBeam::run_passes(const BeamOptions& options, std::size_t width_max) {
  double width = 1.0;
  double cell_m = options.cell_m;
  double cell_rad = options.cell_rad;
  bool split = false;  // true: all cells fitted, so every child gets its own cell
  for (int k = 0; k < kPassesMax; ++k) {
    const double narrowed = k % 2 == 0 ? options.alternation : 1.0;
    Pass pass;
    pass.width = std::min(width_max, static_cast<std::size_t>(width));
    pass.width_of_leaders =
        static_cast<std::size_t>(options.breadth * static_cast<double>(pass.width));
    pass.cell_m = split ? 0.0 : narrowed * cell_m;
    pass.cell_rad = cell_rad;
    pass.offset = kGoldenShare * k;
    const Progress progress = run(pass);
    if (progress == Progress::kDeadline) {
      result_.stop_reason = StopReason::kDeadline;
      return;
    }
    if (progress == Progress::kMemory) {
      width_max = std::max<std::size_t>(1, pass.width / 2);
    } else {
      const bool exhaustive = !pass.merged && !pass.truncated;
      if (exhaustive) {
        result_.epsilon = 0.0;
        result_.delta_m = 0.0;
        result_.lower_bound = result_.found ? result_.cost : result_.lower_bound;
        result_.stop_reason = StopReason::kFinished;
      }
      ++result_.passes;
      result_.history.push_back(
          {result_.epsilon, result_.delta_m, result_.cost, result_.work_nodes});
      if (exhaustive) {
        return;
      }
      if (result_.found && !raise_bound()) {
        result_.stop_reason = StopReason::kDeadline;
        return;
      }
      split = !pass.truncated;
    }
    width = k == 0 ? options.first_width : std::min(1e9, width * options.growth);
    if (k > 0) {
      cell_m *= options.shrink;
      cell_rad *= options.shrink;
    }
  }
}

bool RefiningBeam::raise_bound() {
  std::int64_t& work_nodes = result_.work_nodes;
  if (moving_bound_ == -kInfinity && work_nodes >= RootBound::kMovingBoundAfterNodes) {
    const auto bound = root_bound_.of_moving_plan(*deadline_, work_nodes);
    moving_bound_ = bound.cost;
    if (bound.expired) {
      return false;
    }
  }
  if (work_nodes < RootBound::kRaiseAfterNodes) {
    return true;
  }
  const auto since = static_cast<double>(work_nodes - raised_at_nodes_);
  const double share = work_nodes < RootBound::kLongNodes ? RootBound::kRaiseShare : 1.0;
  const auto nodes = static_cast<std::int64_t>(share * since) +
                     (raised_at_nodes_ == 0 ? RootBound::kRaiseAtFirstNodes : 0);
  const auto bound = root_bound_.raise(expander_, work_nodes + nodes, *deadline_, work_nodes);
  moving_bound_ = std::max(moving_bound_, bound.cost);
  raised_at_nodes_ = work_nodes;
  return !bound.expired;
}

RefiningBeam::Progress RefiningBeam::run(Pass& pass) {
  tree_.clear();
  const std::size_t candidates_most =
      std::min(candidates_.size(), pass.width * problem_->controls.size());
  cell_mask_ = std::min(cells_.size(), std::bit_ceil(2 * candidates_most)) - 1;
  level_begin_[0] = tree_.add(expander_.root());
  levels_ = 1;
  Progress progress = Progress::kDone;
  for (int t = 1; progress == Progress::kDone && t <= problem_->horizon_steps; ++t) {
    progress = expand_level(pass, t);
    if (progress == Progress::kDone && t < problem_->horizon_steps) {
      progress = select(pass, t);
    }
  }
  result_.peak_bytes =
      std::max(result_.peak_bytes, tree_.bytes_used() + candidates_most * sizeof(Candidate) +
                                       candidates_most * (sizeof(double) + sizeof(Mark)) +
                                       2 * (cell_mask_ + 1) * sizeof(Cell));
  return progress;
}

RefiningBeam::Progress RefiningBeam::expand_level(Pass& pass, int t) {
  candidate_count_ = 0;
  if (++epoch_ == 0) {
    std::fill(cells_.begin(), cells_.end(), Cell{});
    std::fill(regions_.begin(), regions_.end(), Cell{});
    epoch_ = 1;
  }
  const double open_loop = expander_.beliefs().open_loop_cost(t);
  const double outlook = options_->persistence * (problem_->horizon_steps - t);
  const auto end = static_cast<NodeId>(tree_.node_count());
  for (NodeId parent = level_begin_[index(t - 1)]; parent < end; ++parent) {
    if (work()) {
      return Progress::kDeadline;
    }
    if (!expander_.expand(tree_, parent, children_)) {
      return Progress::kMemory;
    }
    ++result_.nodes_expanded;
    result_.nodes_generated += children_.count;
    result_.work_nodes += children_.count;
    const double cost_before = tree_[parent].cost;
    const bool blind = tree_.posterior(parent).targets.empty();
    if (blind && work()) {  // sighting values double the work
      return Progress::kDeadline;
    }
    for (int i = 0; i < children_.count; ++i) {
      Candidate child;
      child.world_from_body = children_.world_from_body[i];
      child.cost = children_.cost[i];
      child.parent = parent;
      child.control = children_.control[i];
      if (t == problem_->horizon_steps) {
        offer_leaf(child);
        continue;
      }
      const double gained = open_loop - (child.cost - cost_before - children_.terminal_rise[i]);
      double rank = child.cost - outlook * gained;
      if (blind && gained < kNothing) {
        rank -= options_->anticipation * sighting_.value(child.world_from_body, t);
      }
      offer_candidate(pass, child, rank);
    }
  }
  return Progress::kDone;
}

RefiningBeam::Cell& RefiningBeam::cell_at(ReservedArray<Cell>& cells, std::uint64_t key) const {
  std::size_t slot = mixed(key) & cell_mask_;
  while (cells[slot].epoch == epoch_ && cells[slot].key != key) {
    slot = (slot + 1) & cell_mask_;
  }
  return cells[slot];
}

void RefiningBeam::offer_candidate(Pass& pass, Candidate& candidate, double rank) {
  if (pass.cell_m == 0.0) {
    ranks_[candidate_count_] = rank;
    candidates_[candidate_count_++] = candidate;
    return;
  }
  const Pose2& pose = candidate.world_from_body;
  const std::uint64_t x = cell_index(pose.x_m, pass.cell_m, pass.offset);
  const std::uint64_t y = cell_index(pose.y_m, pass.cell_m, pass.offset);
  const std::uint64_t yaw = cell_index(pose.yaw_rad, pass.cell_rad, pass.offset);
  Cell& cell = cell_at(cells_, x | y << 21U | yaw << 42U);
  std::uint32_t at = cell.candidate;
  if (cell.epoch == epoch_) {
    pass.merged = true;
    if (rank >= ranks_[at]) {
      return;
    }
  } else {
    at = static_cast<std::uint32_t>(candidate_count_++);
    cell.key = x | y << 21U | yaw << 42U;
    cell.epoch = epoch_;
    cell.candidate = at;
  }
  const std::uint64_t region_key =
      x >> kRegionBits | (y >> kRegionBits) << 21U | (yaw >> kRegionBits) << 42U;
  Cell& region = cell_at(regions_, region_key);
  if (region.epoch != epoch_ || rank < ranks_[region.candidate]) {
    region = {region_key, epoch_, at};
  }
  candidate.region = static_cast<std::uint32_t>(&region - regions_.data());
  candidates_[at] = candidate;
  ranks_[at] = rank;
}

// Two rounds of counting find the rank up to which candidates are kept, because a sort could not be
// interrupted. Candidates in the last bin are taken in order.
// Long function: it counts twice over the same bins.
bool RefiningBeam::keep_best(std::size_t room, Mark from) {
  constexpr std::size_t kBins = 256;
  using Histogram = std::array<std::uint32_t, kBins>;
  struct Scale {
    double low = 0.0;
    double per_bin = 0.0;  ///< inverse width of a bin
    [[nodiscard]] std::size_t bin(double rank) const {
      return std::min(kBins - 1, static_cast<std::size_t>(std::max(0.0, (rank - low) * per_bin)));
    }
  };
  // Calls take(i) for every candidate marked `from`; checks the deadline between candidates.
  const auto for_all = [&](const auto& take) {
    for (std::size_t i = 0; i < candidate_count_; ++i) {
      if (i % kChunk == 0 && work()) {
        return false;
      }
      if (marks_[i] == from) {
        take(i);
      }
    }
    return true;
  };
  // Returns the bin in which the count exceeds `left`; reduces `left` to the number of candidates
  // still to take from that bin.
  const auto edge_of = [](const Histogram& histogram, std::size_t& left) {
    std::size_t bin = 0;
    while (bin + 1 < kBins && histogram[bin] <= left) {
      left -= histogram[bin++];
    }
    return bin;
  };
  double low = kInfinity;
  double high = -kInfinity;
  std::size_t count = 0;
  if (!for_all([&](std::size_t i) {
        low = std::min(low, ranks_[i]);
        high = std::max(high, ranks_[i]);
        ++count;
      })) {
    return false;
  }
  if (count <= room) {
    return for_all([&](std::size_t i) { marks_[i] = kKept; });
  }
  const Scale coarse{low, high > low ? static_cast<double>(kBins) / (high - low) : 0.0};
  Histogram histogram{};
  if (!for_all([&](std::size_t i) { ++histogram[coarse.bin(ranks_[i])]; })) {
    return false;
  }
  const std::size_t coarse_edge = edge_of(histogram, room);
  const double extent = (high - low) / static_cast<double>(kBins);
  const Scale fine{low + static_cast<double>(coarse_edge) * extent,
                   coarse.per_bin * static_cast<double>(kBins)};
  histogram.fill(0);
  if (!for_all([&](std::size_t i) {
        if (coarse.bin(ranks_[i]) == coarse_edge) {
          ++histogram[fine.bin(ranks_[i])];
        }
      })) {
    return false;
  }
  const std::size_t fine_edge = edge_of(histogram, room);
  return for_all([&](std::size_t i) {
    const std::size_t bin = coarse.bin(ranks_[i]);
    if (bin < coarse_edge) {
      marks_[i] = kKept;
      return;
    }
    const std::size_t fine_bin = fine.bin(ranks_[i]);
    if (bin > coarse_edge || fine_bin > fine_edge || (fine_bin == fine_edge && room == 0)) {
      return;
    }
    room -= fine_bin == fine_edge ? 1 : 0;
    marks_[i] = kKept;
  });
}

RefiningBeam::Progress RefiningBeam::select(Pass& pass, int t) {
  pass.truncated = pass.truncated || candidate_count_ > pass.width;
  std::size_t leaders = 0;
  for (std::size_t i = 0; i < candidate_count_; ++i) {
    if (i % kChunk == 0 && work()) {
      return Progress::kDeadline;
    }
    const bool leads = pass.cell_m > 0.0 && regions_[candidates_[i].region].candidate == i;
    marks_[i] = candidate_count_ <= pass.width ? kKept : leads ? kLeader : kOther;
    leaders += leads ? 1 : 0;
  }
  if (candidate_count_ > pass.width) {
    const std::size_t room = std::min(leaders, pass.width_of_leaders);
    if (!keep_best(room, kLeader)) {
      return Progress::kDeadline;
    }
    for (std::size_t i = 0; i < candidate_count_; ++i) {
      if (i % kChunk == 0 && work()) {
        return Progress::kDeadline;
      }
      marks_[i] = marks_[i] == kLeader ? kOther : marks_[i];
    }
    if (!keep_best(pass.width - room, kOther)) {
      return Progress::kDeadline;
    }
  }
  level_begin_[index(t)] = static_cast<NodeId>(tree_.node_count());
  levels_ = t + 1;
  for (std::size_t i = 0; i < candidate_count_; ++i) {
    if (i % kChunk == 0 && work()) {
      return Progress::kDeadline;
    }
    if (marks_[i] != kKept) {
      continue;
    }
    const Candidate& candidate = candidates_[i];
    Node node;
    node.world_from_body = candidate.world_from_body;
    node.cost = candidate.cost;
    node.parent = candidate.parent;
    node.control = candidate.control;
    node.depth = static_cast<std::uint8_t>(t);
    if (tree_.add(node) == kNoNode) {
      return Progress::kMemory;
    }
  }
  return Progress::kDone;
}

void RefiningBeam::offer_leaf(const Candidate& leaf) {
  if (leaf.cost >= result_.cost ||
      !expander_.motion().can_stop(leaf.world_from_body, leaf.control, problem_->horizon_steps)) {
    return;
  }
  result_.cost = leaf.cost;
  write_path(tree_, leaf.parent, leaf.control, leaf.world_from_body, result_);
}

void RefiningBeam::fall_back_to_hover() {
  constexpr NodeId kTriedMax = 64;
  const auto offer = [&](int t, HoverChoice& choice) {
    const NodeId begin = level_begin_[index(t)];
    const NodeId end =
        t + 1 < levels_ ? level_begin_[index(t + 1)] : static_cast<NodeId>(tree_.node_count());
    for (NodeId id = begin; id < std::min(end, begin + kTriedMax); ++id) {
      choice.offer(id);
    }
  };
  hover_as_late_as_safe(levels_, offer);
}

}  // namespace vantage::planner
