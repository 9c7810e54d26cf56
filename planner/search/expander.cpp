#include "planner/search/expander.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "planner/problem/log_product.hpp"

namespace vantage::planner {
Expander::Expander(int targets_max, int horizon_max, int teammates_max, int motion_steps_max)
    : motion_(kMaxControls, motion_steps_max > 0 ? motion_steps_max : 3 * horizon_max,
              teammates_max),
      beliefs_(targets_max, horizon_max),
      grid_(targets_max, horizon_max) {
  const std::size_t targets = index(targets_max);
  slot_of_.reserve(targets);
  touched_.reserve(targets);
  predicted_.reserve(targets * kMaxPacked);
  result_targets_.resize(targets);
  result_.resize(targets * kMaxPacked);
}

void Expander::reset(const SearchProblem& problem) {
  problem_ = &problem;
  include_terminal_value(true);
  motion_.reset(problem);
  beliefs_.reset(problem);
  sight_.reset(problem);
  grid_.reset(beliefs_, problem.start.position_m(), problem.horizon_steps, motion_.reach_m(),
              sight_.range_max_m());
  slot_of_.assign(problem.targets.size(), -1);
  touched_.clear();
  predicted_.clear();
  result_targets_.resize(problem.targets.size());
  result_.resize(problem.targets.size() * kMaxPacked);
}

Node Expander::root() const {
  Node node;
  node.world_from_body = problem_->start;
  return node;
}

void Expander::predict_blocks(const Blocks& blocks, int t) {
  predicted_.resize(blocks.targets.size() * kMaxPacked);
  touched_.assign(blocks.targets.begin(), blocks.targets.end());
  const double* in = blocks.packed;
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    const int m = touched_[i];
    beliefs_.predict_into(m, t, in, &predicted_[kMaxPacked * i]);
    slot_of_[index(m)] = static_cast<std::int32_t>(i);
    in += packed_size(beliefs_.layout(m));
  }
}

void Expander::forget_blocks() {
  for (const std::uint16_t m : touched_) {
    slot_of_[m] = -1;
  }
  touched_.clear();
}

double Expander::predicted_cost(int t) const {
  double cost = beliefs_.open_loop_cost(t);
  if (touched_.empty()) {
    return cost;
  }
  LogProduct ratio;
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    const int m = touched_[i];
    const double* block = &predicted_[kMaxPacked * i];
    if (beliefs_.cost() == CostKind::kTrace) {
      cost += trace(beliefs_.layout(m), block) - beliefs_.open_loop_measure(m, t);
      continue;
    }
    ratio.multiply(determinant(beliefs_.layout(m), block) * beliefs_.open_loop_per_measure(m, t));
  }
  return cost + ratio.log();
}

void Expander::move(const Node& node, double cos_yaw, double sin_yaw, Children& out) {
  const Pose2& from = node.world_from_body;
  ChildPoses& poses = out.world_from_body;
  Views& views = poses.views;
  poses.world_from_parent = from;
  poses.motion = &motion_;
  motion_.children(from, cos_yaw, sin_yaw, views);
  const int controls = motion_.control_count();
  if (problem_->teammates.empty() && motion_.is_open_space(from.position_m())) {
    for (int c = 0; c < controls; ++c) {
      out.control[c] = poses.control[c] = static_cast<std::int16_t>(c);
    }
    views.count = out.count = controls;
    return;
  }
  int count = 0;
  for (int c = 0; c < controls; ++c) {
    if (!motion_.is_free(from, cos_yaw, sin_yaw, c, node.depth)) {
      continue;
    }
    views.x_m[count] = views.x_m[c];
    views.y_m[count] = views.y_m[c];
    views.cos_yaw[count] = views.cos_yaw[c];
    views.sin_yaw[count] = views.sin_yaw[c];
    out.control[count] = poses.control[count] = static_cast<std::int16_t>(c);
    ++count;
  }
  views.count = out.count = count;
}

void Expander::look_at_one(int m, int t, const Views& views, Gains& gains) const {
  const double* P = predicted(m, t);
  const Eigen::Vector3d& mean_m = beliefs_.mean_m(m, t);
  const Lanes one = broadcast(1.0);
  const Lanes zero = {};
  for (int group = 0; group < views.groups(); ++group) {
    InformationLanes M;
    LaneMask seen = sight_.compute_lanes(mean_m, views, group, M);
    if (bits(seen) == 0) {
      continue;
    }
    const int at = kLanes * group;
    if (sight_.has_obstacles()) {
      for (int lane = 0; lane < kLanes; ++lane) {
        if (seen[lane] != 0 && at + lane < views.count &&
            !sight_.line_of_sight({views.x_m[at + lane], views.y_m[at + lane]}, mean_m.head<2>())) {
          seen[lane] = 0;
        }
      }
    }
    // Computes gain2() and trace_reduction() in four lanes at once.
    const Lanes det_m = M.m00 * M.m11 - M.m01 * M.m01;
    const Lanes gain = 1.0 + M.m00 * P[0] + 2.0 * M.m01 * P[1] + M.m11 * P[2] + det_m * det2(P);
    if (beliefs_.cost() == CostKind::kTrace) {
      const Square2 s = squared_rows(beliefs_.layout(m), P);
      const Lanes reduction = ((M.m00 + det_m * P[2]) * s.xx + 2.0 * (M.m01 - det_m * P[1]) * s.xy +
                               (M.m11 + det_m * P[0]) * s.yy) /
                              gain;
      store(gains.sum + at, load(gains.sum + at) + (seen ? reduction : zero));
      continue;
    }
    const Lanes product = load(gains.product + at) * (seen ? gain : one);
    store(gains.product + at, product);
    if (bits(product > kProductMax) != 0) {
      for (int i = at; i < at + kLanes; ++i) {
        gains.sum[i] += std::log(gains.product[i]);
        gains.product[i] = 1.0;
      }
    }
  }
}

void Expander::look_at_one_each(int m, int t, const Children& children, Gains& gains) const {
  const BlockLayout layout = beliefs_.layout(m);
  const double* P = predicted(m, t);
  for (int i = 0; i < children.count; ++i) {
    PackedInformation M;
    if (!sight_.add_information(beliefs_.mean_m(m, t), beliefs_.velocity_mps(m, t), layout,
                                children.world_from_body[i],
                                children.world_from_body.views.cos_yaw[i],
                                children.world_from_body.views.sin_yaw[i], M)) {
      continue;
    }
    if (beliefs_.cost() == CostKind::kTrace) {
      gains.sum[i] += trace_reduction(layout, M, P);
      continue;
    }
    gains.product[i] *= gain(layout, M, P);
    if (gains.product[i] > kProductMax) {
      gains.sum[i] += std::log(gains.product[i]);
      gains.product[i] = 1.0;
    }
  }
}

void Expander::look_from_children(int t, const Children& children, Gains& gains) const {
  for (int i = 0; i < kLanes * children.world_from_body.views.groups(); ++i) {
    gains.product[i] = 1.0;
    gains.sum[i] = 0.0;
  }
  for (const std::uint16_t m : candidates_) {
    if (sight_.has_lanes() && beliefs_.layout(m) != BlockLayout::kSpatial) {
      look_at_one(m, t, children.world_from_body.views, gains);
    } else {
      look_at_one_each(m, t, children, gains);
    }
  }
}

bool Expander::expand(Tree& tree, NodeId id, Children& out) {
  out.count = 0;
  const Node node = tree[id];
  const double cos_yaw = std::cos(node.world_from_body.yaw_rad);
  const double sin_yaw = std::sin(node.world_from_body.yaw_rad);
  if (!tree.has_posterior(id) && !keep_posterior(tree, id, cos_yaw, sin_yaw)) {
    return false;
  }
  const int t = node.depth + 1;
  predict_blocks(tree.posterior(id), t);
  const double base = node.cost + predicted_cost(t);
  candidates_ = grid_.near(node.world_from_body.position_m(), t);
  move(node, cos_yaw, sin_yaw, out);
  Gains gains;
  look_from_children(t, out, gains);
  for (int i = 0; i < out.count; ++i) {
    const double gained =
        gains.product[i] == 1.0 ? gains.sum[i] : gains.sum[i] + std::log(gains.product[i]);
    out.cost[i] = base - gained;
    out.terminal_rise[i] = 0.0;
  }
  forget_blocks();
  if (has_terminal_) {
    const double here = terminal_value(tree, id);
    const TerminalValue::Rest rest = rest_of_tour(tree.posterior(id));
    for (int i = 0; i < out.count; ++i) {
      out.terminal_rise[i] =
          problem_->terminal.at(rest, out.world_from_body[i].position_m()) - here;
      out.cost[i] += out.terminal_rise[i];
    }
  }
  return true;
}

double Expander::terminal_value(const Tree& tree, NodeId id) const {
  const Node& node = tree[id];
  if (!has_terminal_ || node.parent == kNoNode) {
    return 0.0;
  }
  return problem_->terminal.at(rest_of_tour(tree.posterior(node.parent)),
                               node.world_from_body.position_m());
}

TerminalValue::Rest Expander::rest_of_tour(const Blocks& blocks) const {
  std::size_t at = 0;  // index of the target that `block` points to
  const double* block = blocks.packed;
  return problem_->terminal.rest(blocks.targets, [&](std::size_t k) {
    for (; at < k; ++at) {
      block += packed_size(beliefs_.layout(blocks.targets[at]));
    }
    const BlockLayout layout = beliefs_.layout(blocks.targets[k]);
    return beliefs_.cost() == CostKind::kTrace ? trace(layout, block)
                                               : std::log(determinant(layout, block));
  });
}

Expander::Kept Expander::update_blocks(const Pose2& at, double cos_yaw, double sin_yaw, int t,
                                       Tree::Room room) {
  Kept kept;
  std::size_t next_touched = 0;
  const auto keep = [&](int m) {
    room.targets[kept.targets++] = static_cast<std::uint16_t>(m);
    double* block = room.packed + kept.doubles;
    kept.doubles += static_cast<std::size_t>(packed_size(beliefs_.layout(m)));
    return block;
  };
  const auto keep_touched_before = [&](int m) {
    while (next_touched < touched_.size() && touched_[next_touched] < m) {
      const int kept_m = touched_[next_touched];
      std::copy_n(&predicted_[kMaxPacked * next_touched], packed_size(beliefs_.layout(kept_m)),
                  keep(kept_m));
      ++next_touched;
    }
  };
  for (const std::uint16_t m : candidates_) {
    const BlockLayout layout = beliefs_.layout(m);
    if (sight_.has_lanes() && layout != BlockLayout::kSpatial &&
        !sight_.may_be_in_range(beliefs_.mean_m(m, t), at)) {
      continue;
    }
    PackedInformation M;
    if (!sight_.add_information(beliefs_.mean_m(m, t), beliefs_.velocity_mps(m, t), layout, at,
                                cos_yaw, sin_yaw, M)) {
      continue;
    }
    keep_touched_before(m);
    update(layout, M, predicted(m, t), keep(m));
    if (next_touched < touched_.size() && touched_[next_touched] == m) {
      ++next_touched;
    }
  }
  keep_touched_before(beliefs_.target_count());
  return kept;
}

bool Expander::ensure_posterior(Tree& tree, NodeId id) {
  if (tree.has_posterior(id)) {
    return true;
  }
  const double yaw_rad = tree[id].world_from_body.yaw_rad;
  return keep_posterior(tree, id, std::cos(yaw_rad), std::sin(yaw_rad));
}

bool Expander::keep_posterior(Tree& tree, NodeId id, double cos_yaw, double sin_yaw) {
  const Node& node = tree[id];
  if (node.parent == kNoNode) {
    return tree.keep_posterior(id, {}, {});
  }
  const Blocks before = tree.posterior(node.parent);
  candidates_ = grid_.near(node.world_from_body.position_m(), node.depth);
  const std::size_t targets_max =
      std::min(slot_of_.size(), before.targets.size() + candidates_.size());
  const Tree::Room room = tree.room_for_posterior(targets_max, kMaxPacked * targets_max);
  if (room.targets == nullptr) {
    return false;
  }
  predict_blocks(before, node.depth);
  const Kept kept = update_blocks(node.world_from_body, cos_yaw, sin_yaw, node.depth, room);
  forget_blocks();
  tree.commit_posterior(id, kept.targets, kept.doubles);
  return true;
}

double Expander::cost_of_hovering(const Tree& tree, NodeId id) {
  const Node& node = tree[id];
  const double cos_yaw = std::cos(node.world_from_body.yaw_rad);
  const double sin_yaw = std::sin(node.world_from_body.yaw_rad);
  double cost = node.cost - terminal_value(tree, id);
  Blocks blocks = tree.posterior(id);
  double terminal = node.cost - cost;  // terminal value of a node at the last depth
  for (int t = node.depth + 1; t <= problem_->horizon_steps; ++t) {
    if (has_terminal_ && t == problem_->horizon_steps) {
      terminal = problem_->terminal.at(rest_of_tour(blocks), node.world_from_body.position_m());
    }
    predict_blocks(blocks, t);
    candidates_ = grid_.near(node.world_from_body.position_m(), t);
    const Kept kept = update_blocks(node.world_from_body, cos_yaw, sin_yaw, t,
                                    {result_targets_.data(), result_.data()});
    forget_blocks();
    // The new blocks are the next step's input. They are in result_, which predict_blocks() reads
    // before update_blocks() overwrites it.
    blocks = {{result_targets_.data(), kept.targets}, result_.data()};
    cost += beliefs_.open_loop_cost(t);
    const double* block = result_.data();
    for (const std::uint16_t m : blocks.targets) {
      const BlockLayout layout = beliefs_.layout(m);
      const double open_loop = beliefs_.open_loop_measure(m, t);
      cost += beliefs_.cost() == CostKind::kTrace
                  ? trace(layout, block) - open_loop
                  : std::log(determinant(layout, block) / open_loop);
      block += packed_size(layout);
    }
  }
  return cost + terminal;
}

bool Expander::is_redundant(const Tree& tree, NodeId a, double epsilon, NodeId b) const {
  const Blocks blocks_a = tree.posterior(a);
  const Blocks blocks_b = tree.posterior(b);
  const int t = tree[a].depth;
  std::size_t i = 0;
  std::size_t j = 0;
  const double* block_a = blocks_a.packed;
  const double* block_b = blocks_b.packed;
  while (i < blocks_a.targets.size() || j < blocks_b.targets.size()) {
    const int in_a = i < blocks_a.targets.size() ? blocks_a.targets[i] : beliefs_.target_count();
    const int in_b = j < blocks_b.targets.size() ? blocks_b.targets[j] : beliefs_.target_count();
    const int m = std::min(in_a, in_b);
    if (has_terminal_ && in_b != m && problem_->terminal.has_stop(m)) {
      return false;
    }
    const BlockLayout layout = beliefs_.layout(m);
    const double* left = in_a == m ? block_a : beliefs_.open_loop(m, t);
    const double* right = in_b == m ? block_b : beliefs_.open_loop(m, t);
    if (!dominates(layout, left, epsilon, right)) {
      return false;
    }
    if (in_a == m) {
      ++i;
      block_a += packed_size(layout);
    }
    if (in_b == m) {
      ++j;
      block_b += packed_size(layout);
    }
  }
  return !has_terminal_ ||
         tree[b].cost - terminal_value(tree, b) <= tree[a].cost - terminal_value(tree, a) + epsilon;
}

}  // namespace vantage::planner
