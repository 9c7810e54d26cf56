#include "planner/search/sequencing_bound.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

constexpr double kAnywhere_m = 1e9;
constexpr double kRounding = 1e-9;

// Nodes with the least f come first; of nodes with equal f, the later step comes first.
constexpr auto kAfter = [](const auto& a, const auto& b) {
  return a.f > b.f || (a.f == b.f && a.state < b.state);
};

// Returns the minimum number of steps for a path length; at least one.
int steps_of(double path_m, double step_m, int steps_max) {
  const double steps = std::ceil(path_m / step_m - kRounding);
  return steps >= steps_max ? steps_max : std::max(1, static_cast<int>(steps));
}

}  // namespace

SequencingBound::SequencingBound(int targets_max, int horizon_max, int states_max)
    : states_max_(index(std::max(states_max, kStopsMax + 1))) {
  targets_.reserve(kTargetsMax);
  nearest_.reserve(kTargetsMax);
  takes_part_.reserve(index(targets_max));
  looks_.reserve(kTargetsMax);
  stops_.reserve(kStopsMax);
  const std::size_t cells = index(kTargetsMax) * index(horizon_max + 2) * index(horizon_max + 2);
  costs_.resize(cells);
  rests_.resize(cells);
  ends_.reserve(kMaxControls);
  after_.reserve(kMaxControls);
  onwards_.resize(index(horizon_max + 2));
  regions_.reserve(kTargetsMax);
  hulls_.resize(index(kTargetsMax) * index(horizon_max + 2));
  gains_.resize(index(kTargetsMax) * index(horizon_max + 2));
  row_averages_.resize(index(horizon_max + 2));
  row_blocks_.resize(index(horizon_max + 2) * 3);
  states_.reserve(states_max_);
  open_.reserve(states_max_);
}

void SequencingBound::reset(const SearchProblem& problem, const BeliefTable& beliefs,
                            const InformationHeuristic& heuristic) {
  begin(problem, beliefs, heuristic);
  looks_.clear();
  schedules_ = true;
  GeodesicTable::VisibleCorners visible;
  heuristic.geodesics().find_visible_corners(problem.start.position_m(), visible);
  // Covers the nearest targets that can be seen at all and have bounded information.
  nearest_.clear();
  for (int m = 0; m < beliefs.target_count(); ++m) {
    if (!heuristic.has_static_position(m) || beliefs.layout(m) != BlockLayout::kPlanar) {
      continue;
    }
    const double path_m = heuristic.geodesics().path_m(visible, m) - heuristic.sight_m(m);
    if (path_m >= horizon_ * heuristic.step_m() ||
        !std::isfinite(heuristic.look_bound(m, 0.0, kAnywhere_m, 0).strongest())) {
      continue;
    }
    if (nearest_.size() < kTargetsMax) {
      nearest_.emplace_back(path_m, m);
    } else if (auto farthest = std::max_element(nearest_.begin(), nearest_.end());
               path_m < farthest->first) {
      *farthest = {path_m, m};
    }
  }
  for (const auto& [path_m, m] : nearest_) {
    targets_.push_back(m);
    looks_.push_back(heuristic.look_bound(m, 0.0, kAnywhere_m, 0));
    takes_part_[index(m)] = 1;
    schedules_ = schedules_ && heuristic.has_only_own_information(m);
  }
  ends_.clear();
  for (const models::UnicycleControl& control : problem.controls) {
    ends_.push_back(models::step_unicycle({}, control, problem.step_s).position_m());
  }
  after_.assign(problem.controls.size(), -kInfinity);
  find_stops();
}

void SequencingBound::find_stops() {
  const int count = static_cast<int>(targets_.size());
  for (int i = 0; i < count; ++i) {
    meets_[i] = 0;
    for (int j = 0; j < count; ++j) {
      const double path_m =
          heuristic_->geodesics().path_between_m(targets_[index(i)], targets_[index(j)]) -
          heuristic_->sight_m(targets_[index(i)]) - heuristic_->sight_m(targets_[index(j)]);
      steps_between_[i][j] =
          static_cast<std::uint8_t>(steps_of(path_m, heuristic_->step_m(), horizon_ + 1));
      if (i == j || path_m < kRounding) {
        meets_[i] |= 1U << j;
      }
    }
  }
  find_regions();
  stops_.clear();
  any_member_ = false;
  const std::uint32_t all = count == 0 ? 0 : (1U << (count - 1)) * 2U - 1U;
  if (!add_cliques(0, all)) {
    stops_.clear();
    any_member_ = true;
    add_regions();
  }
}

// Adds every set of targets with discs that meet pairwise. Returns false if there are too many.
bool SequencingBound::add_cliques(std::uint32_t clique, std::uint32_t candidates) {
  while (candidates != 0) {
    const int i = std::countr_zero(candidates);
    candidates &= candidates - 1;
    if (is_full()) {
      return false;
    }
    Stop stop;
    stop.targets = clique | (1U << i);
    for (int j = 0; j < static_cast<int>(targets_.size()); ++j) {
      for (std::uint32_t rest = stop.targets; rest != 0; rest &= rest - 1) {
        stop.steps_to[j] = std::max(stop.steps_to[j], steps_between_[std::countr_zero(rest)][j]);
      }
    }
    stops_.push_back(stop);
    if (!add_cliques(stop.targets, candidates & meets_[i])) {
      return false;
    }
  }
  return true;
}

// Adds each group of targets with connected discs as one region that sees all of them.
void SequencingBound::add_regions() {
  for (const std::uint32_t region : regions_) {
    Stop stop;
    stop.targets = region;
    for (int j = 0; j < static_cast<int>(targets_.size()); ++j) {
      stop.steps_to[j] = 255;
      for (std::uint32_t rest = region; rest != 0; rest &= rest - 1) {
        stop.steps_to[j] = std::min(stop.steps_to[j], steps_between_[std::countr_zero(rest)][j]);
      }
    }
    stops_.push_back(stop);
  }
}

void SequencingBound::find_regions() {
  regions_.clear();
  std::uint32_t placed = 0;
  for (int i = 0; i < static_cast<int>(targets_.size()); ++i) {
    if ((placed >> i & 1U) != 0) {
      continue;
    }
    std::uint32_t region = 0;
    std::uint32_t grown = 1U << i;
    while (grown != region) {
      region = grown;
      for (std::uint32_t rest = region; rest != 0; rest &= rest - 1) {
        grown |= meets_[std::countr_zero(rest)];
      }
    }
    placed |= region;
    regions_.push_back(region);
  }
}

void SequencingBound::fill_costs(int i, int depth, const double* block) {
  const int m = targets_[index(i)];
  const bool traces = beliefs_->cost() == CostKind::kTrace;
  const bool by_sum = !heuristic_->has_fixed(m);
  const bool by_recursion = !heuristic_->has_only_own_information(m);
  const double strength = looks_[index(i)].strongest();
  const int left = steps_left_;
  PackedInformation look;
  look.m[0] = look.m[2] = strength;
  // Computes the best cost after n measurements at any times.
  double summed[256];
  if (by_sum) {
    PointedInformation sum(block);
    for (int n = 0; n <= left; ++n) {
      const double measure = traces ? sum.covariance_trace() : 1.0 / sum.determinant();
      summed[n] = by_recursion || traces ? measure : std::log(measure);
      sum.add(looks_[index(i)]);
    }
  }
  // row_blocks_[n]: covariance at step k if the last n steps had a measurement.
  std::copy_n(block, 3, row_blocks_.begin());
  const bool by_average = by_recursion && by_sum;
  if (by_average) {
    row_averages_[0] = AveragedBlock(BlockLayout::kPlanar, block);
  }
  for (int k = 1; k <= left; ++k) {
    for (int n = k; n >= 0; --n) {
      double cost = by_sum ? summed[n] : 0.0;
      if (by_recursion) {
        double* now = &row_blocks_[index(n) * 3];
        beliefs_->predict_into(m, depth + k, n == 0 ? now : now - 3, now);
        if (n > 0) {
          update(BlockLayout::kPlanar, look.m, now, now);
        }
        cost = std::max(cost, traces ? trace(BlockLayout::kPlanar, now) : det2(now));
        if (by_average) {
          AveragedBlock& average = row_averages_[index(n)];
          average = row_averages_[index(std::max(0, n - 1))];
          average.predict(heuristic_->motion(m));
          average.update(n > 0 ? looks_[index(i)].average() : 0.0);
          cost = std::max(cost, traces ? average.trace() : average.determinant());
        }
        cost = traces ? cost : std::log(cost);
      }
      costs_[cell(i, n, k)] = cost;
    }
  }
  fill_rests(i);
  if (schedules_) {
    fill_gains(i);
  }
}

void SequencingBound::fill_rests(int i) {
  const int left = steps_left_;
  for (int n = 0; n <= left; ++n) {
    double* rest = &rests_[cell(i, n, 0)];
    double passed = 0.0;
    for (int next = n + 1; next <= left + 1; ++next) {
      rest[next] = passed;  // cost of the steps before `next`
      passed += next <= left ? costs_[cell(i, n, next)] : 0.0;
    }
  }
  // Adds the cost from `next` on, diagonal by diagonal.
  for (int next = left; next >= 1; --next) {
    for (int n = 0; n < next; ++n) {
      const double onwards =
          costs_[cell(i, n + 1, next)] + (next < left ? onwards_[index(n + 1)] : 0.0);
      onwards_[index(n)] = onwards;
      rests_[cell(i, n, next)] += onwards;
    }
  }
}

void SequencingBound::fill_gains(int i) {
  const int left = steps_left_;
  double* hull = &hulls_[index(i) * index(horizon_ + 2)];
  double* gain = &gains_[index(i) * index(horizon_ + 2)];
  // Lower convex hull, corner by corner: the next corner has the steepest descent.
  hull[0] = cost_after_looks(i, 0);
  int from = 0;
  while (from < left) {
    int to = from + 1;
    double slope = cost_after_looks(i, to) - hull[from];
    for (int n = from + 2; n <= left; ++n) {
      const double other = (cost_after_looks(i, n) - hull[from]) / (n - from);
      if (other < slope) {
        slope = other;
        to = n;
      }
    }
    for (int n = from + 1; n <= to; ++n) {
      gain[n - 1] = std::max(0.0, -slope);
      hull[n] = hull[from] + slope * (n - from);
    }
    from = to;
  }
  gain[left] = 0.0;
}

double SequencingBound::schedule(const State& state) const {
  const int left = steps_left_ - state.step;
  const std::size_t stride = index(horizon_ + 2);
  const int regions = static_cast<int>(regions_.size());
  double at_rest = 0.0;  // cost per step
  int released[kTargetsMax];
  double gain[kTargetsMax];
  const double* rows[kTargetsMax];  // next gain of a region with one target
  int looks[kTargetsMax];
  const auto sum_of_gains = [&](int p) {
    double sum = 0.0;
    for (std::uint32_t rest = regions_[index(p)]; rest != 0; rest &= rest - 1) {
      const int i = std::countr_zero(rest);
      const int n = std::min(state.looks[i] + looks[p], steps_left_);
      sum += gains_[index(i) * stride + index(n)];
    }
    return sum;
  };
  for (int p = 0; p < regions; ++p) {
    const std::uint32_t targets = regions_[index(p)];
    const int first = std::countr_zero(targets) % kTargetsMax;  // no region is empty
    const std::size_t at = index(first) * stride + state.looks[first];
    looks[p] = 0;
    if ((targets & (targets - 1)) == 0) {
      released[p] = state.next[first];
      at_rest += hulls_[at];
      rows[p] = &gains_[at];
      gain[p] = *rows[p];
      continue;
    }
    rows[p] = nullptr;
    released[p] = 255;
    for (std::uint32_t rest = targets; rest != 0; rest &= rest - 1) {
      const int i = std::countr_zero(rest);
      released[p] = std::min<int>(released[p], state.next[i]);
      at_rest += hulls_[index(i) * stride + state.looks[i]];
    }
    gain[p] = sum_of_gains(p);
  }
  double cost = state.passed + left * at_rest;
  for (int steps = left; steps > 0; --steps) {
    const int k = steps_left_ - steps + 1;
    int best = -1;
    double most = 0.0;
    for (int p = 0; p < regions; ++p) {
      const double offered = released[p] <= k ? gain[p] : 0.0;
      best = offered > most ? p : best;
      most = std::max(most, offered);
    }
    if (best < 0) {
      continue;
    }
    cost -= most * steps;
    ++looks[best];
    gain[best] = rows[best] != nullptr ? *++rows[best] : sum_of_gains(best);
  }
  return cost;
}

void SequencingBound::open(const State& state) {
  open_.push_back({state.f, static_cast<std::uint32_t>(states_.size())});
  states_.push_back(state);
  std::push_heap(open_.begin(), open_.end(), kAfter);
}

void SequencingBound::open_controls(const Pose2& at, double cutoff) {
  const double cos_yaw = std::cos(at.yaw_rad);
  const double sin_yaw = std::sin(at.yaw_rad);
  const int count = static_cast<int>(targets_.size());
  const GeodesicTable& geodesics = heuristic_->geodesics();
  for (std::size_t c = 0; c < ends_.size(); ++c) {
    after_[c] = kInfinity;
    const Eigen::Vector2d end_m(at.x_m + cos_yaw * ends_[c].x() - sin_yaw * ends_[c].y(),
                                at.y_m + sin_yaw * ends_[c].x() + cos_yaw * ends_[c].y());
    if (geodesics.is_blocked(end_m)) {
      continue;
    }
    GeodesicTable::VisibleCorners visible;
    geodesics.find_visible_corners(end_m, visible);
    State root;
    root.control = static_cast<std::uint8_t>(c);
    for (int i = 0; i < count; ++i) {
      const int m = targets_[index(i)];
      const double path_m = geodesics.path_m(visible, m) - heuristic_->sight_m(m);
      const int next =
          path_m < kRounding ? 1 : 1 + steps_of(path_m, heuristic_->step_m(), steps_left_);
      root.next[i] = static_cast<std::uint8_t>(next);
      root.alone += rests(i, 0)[next];
    }
    root.f = root.alone;
    if (schedules_ && root.f < cutoff) {
      root.f = std::max(root.f, schedule(root));
    }
    after_[c] = root.f;
    if (root.f < cutoff) {
      open(root);
    }
  }
}

SequencingBound::Answer SequencingBound::answer(double cost, bool expired) {
  // `cost` is the least f of all open states, so it bounds the cost after each control.
  for (double& after : after_) {
    after = std::max(after, cost);
  }
  return {cost, expired};
}

SequencingBound::Answer SequencingBound::cost_to_go(const Pose2& at, int depth,
                                                    const Blocks& blocks, double cutoff,
                                                    const Deadline& deadline,
                                                    std::int64_t& work_nodes) {
  constexpr int kAskEvery = 8;
  steps_left_ = horizon_ - depth;
  states_.clear();
  open_.clear();
  for (int i = 0; i < static_cast<int>(targets_.size()); ++i) {
    const int m = targets_[index(i)];
    const double* block = beliefs_->open_loop(m, depth);
    const double* packed = blocks.packed;
    for (const std::uint16_t target : blocks.targets) {
      if (target == m) {
        block = packed;
        break;
      }
      packed += packed_size(beliefs_->layout(target));
    }
    fill_costs(i, depth, block);
  }
  open_controls(at, cutoff);
  int until_asking = kAskEvery;
  while (!open_.empty()) {
    const double least = open_.front().f;
    const State state = states_[open_.front().state];
    if (states_.size() + stops_.size() > states_max_) {
      return answer(least, false);
    }
    ++work_nodes;
    if (--until_asking == 0) {
      until_asking = kAskEvery;
      if (deadline.expired(work_nodes)) {
        return answer(least, true);
      }
    }
    std::pop_heap(open_.begin(), open_.end(), kAfter);
    open_.pop_back();
    if (!expand(state, cutoff)) {
      return answer(least, false);  // this sequence is complete, and no other is cheaper
    }
  }
  return answer(cutoff, false);
}

bool SequencingBound::expand(const State& state, double cutoff) {
  const int count = static_cast<int>(targets_.size());
  const double* rows[kTargetsMax];
  double unchanged = state.alone;
  double per_step = 0.0;
  for (int i = 0; i < count; ++i) {
    rows[i] = rests(i, state.looks[i]);
    unchanged -= rows[i][state.next[i]];
    if (schedules_) {
      per_step += cost_after_looks(i, state.looks[i]);
    }
  }
  bool goes_on = false;
  for (const Stop& stop : stops_) {
    int step = any_member_ ? 255 : 0;
    for (std::uint32_t rest = stop.targets; rest != 0; rest &= rest - 1) {
      const int next = state.next[std::countr_zero(rest)];
      step = any_member_ ? std::min(step, next) : std::max(step, next);
    }
    step = std::max(step, state.step + 1);
    if (step > steps_left_) {
      continue;
    }
    goes_on = true;
    State child = state;
    child.step = static_cast<std::uint8_t>(step);
    child.alone = unchanged;
    child.passed += (step - state.step) * per_step;
    for (int i = 0; i < count; ++i) {
      if ((stop.targets >> i & 1U) != 0) {
        child.alone += rows[i][step];
        if (schedules_) {
          child.passed +=
              cost_after_looks(i, state.looks[i] + 1) - cost_after_looks(i, state.looks[i]);
        }
        ++child.looks[i];
        child.next[i] = static_cast<std::uint8_t>(step + 1);
        continue;
      }
      const int next =
          std::min(std::max<int>(state.next[i], step + stop.steps_to[i]), steps_left_ + 1);
      child.alone += rows[i][next];
      child.next[i] = static_cast<std::uint8_t>(next);
    }
    child.f = std::max(state.f, child.alone);
    if (schedules_ && child.f < cutoff) {
      child.f = std::max(child.f, schedule(child));
    }
    if (child.f < cutoff) {
      open(child);
    }
  }
  return goes_on;
}

}  // namespace vantage::planner
