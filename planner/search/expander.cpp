#include "planner/search/expander.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vantage::planner {
namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// A sum of logarithms as the logarithm of a product, taken whenever the product might leave the
// range of a double: a single factor may be as small or large as 1e±150.
class LogProduct {
 public:
  void multiply(double factor) {
    product_ *= factor;
    if (!(product_ > 1e-150 && product_ < 1e150)) {
      sum_ += std::log(product_);
      product_ = 1.0;
    }
  }
  [[nodiscard]] double log() const { return sum_ + std::log(product_); }

 private:
  double sum_ = 0.0;
  double product_ = 1.0;
};

}  // namespace

Expander::Expander(int targets_max, int horizon_max, int teammates_max)
    : motion_(kMaxControls, horizon_max, teammates_max), beliefs_(targets_max, horizon_max) {
  const std::size_t targets = index(targets_max);
  slot_of_.reserve(targets);
  touched_.reserve(targets);
  predicted_.reserve(targets * kMaxPacked);
  candidates_.reserve(targets);
  result_targets_.reserve(targets);
  result_.reserve(targets * kMaxPacked);
  cos_half_fov_.reserve(8);
}

void Expander::reset(const SearchProblem& problem) {
  problem_ = &problem;
  motion_.reset(problem);
  beliefs_.reset(problem);
  cos_half_fov_.clear();
  range_max_m_ = 0.0;
  for (const models::SensorModel& sensor : problem.sensors) {
    cos_half_fov_.push_back(sensor.fov_rad >= 2.0 * kPi ? -2.0 : std::cos(0.5 * sensor.fov_rad));
    range_max_m_ = std::max(range_max_m_, sensor.range_max_m);
  }
  has_obstacles_ = problem.world != nullptr && !problem.world->obstacles.empty();
  slot_of_.assign(problem.targets.size(), -1);
  touched_.clear();
  predicted_.clear();
}

Node Expander::root() const {
  Node node;
  node.world_from_body = problem_->start;
  return node;
}

bool Expander::look_planar(const models::SensorModel& sensor, double cos_half_fov, double dx_m,
                           double dy_m, double cos_yaw, double sin_yaw,
                           PackedInformation& sum) const {
  const double r2 = dx_m * dx_m + dy_m * dy_m;
  if (r2 >= sensor.range_max_m * sensor.range_max_m ||
      r2 < sensor.range_min_m * sensor.range_min_m) {
    return false;
  }
  const double r = std::sqrt(r2);
  if (r2 == 0.0) {  // in no direction: only a position sensor that sees all around tells of it
    if (sensor.kind != models::SensorKind::kPosition || cos_half_fov >= -1.0) {
      return false;
    }
  } else if (dx_m * cos_yaw + dy_m * sin_yaw <= cos_half_fov * r) {
    return false;
  }
  if (sensor.kind == models::SensorKind::kPosition) {
    const double a = 1.0 / (sensor.position_sigma_m * sensor.position_sigma_m);
    sum.m[0] += a;
    sum.m[2] += a;
    return true;
  }
  const double growth = sensor.variance_grows_with_range
                            ? std::max(sensor.variance_floor, r / sensor.range_max_m)
                            : 1.0;
  const double ux = dx_m / r;
  const double uy = dy_m / r;
  if (sensor.kind != models::SensorKind::kBearing) {
    const double scaled = sensor.calibration.range_scale / sensor.range_sigma_m;
    const double a = scaled * scaled / growth;
    sum.m[0] += a * ux * ux;
    sum.m[1] += a * ux * uy;
    sum.m[2] += a * uy * uy;
  }
  if (sensor.kind != models::SensorKind::kRange) {
    const double b = 1.0 / (sensor.bearing_sigma_rad * sensor.bearing_sigma_rad * growth * r2);
    sum.m[0] += b * uy * uy;
    sum.m[1] -= b * ux * uy;
    sum.m[2] += b * ux * ux;
  }
  return true;
}

bool Expander::look(int m, int t, const Pose2& at, double cos_yaw, double sin_yaw,
                    PackedInformation& out) const {
  const Eigen::Vector3d& mean_m = beliefs_.mean_m(m, t);
  const bool spatial = beliefs_.layout(m) == BlockLayout::kSpatial;
  bool seen = false;
  for (std::size_t s = 0; s < problem_->sensors.size(); ++s) {
    const models::SensorModel& sensor = problem_->sensors[s];
    if (!spatial && sensor.kind != models::SensorKind::kCamera) {
      seen = look_planar(sensor, cos_half_fov_[s], mean_m.x() - at.x_m, mean_m.y() - at.y_m,
                         cos_yaw, sin_yaw, out) ||
             seen;
      continue;
    }
    const models::Viewpoint from{at, problem_->height_m};
    const models::PositionVector target = mean_m.head(spatial ? 3 : 2);
    if (!models::in_view(sensor, from, target)) {
      continue;
    }
    const models::PositionMatrix M = models::information(sensor, from, target);
    double packed[6];
    pack(spatial ? BlockLayout::kSpatial : BlockLayout::kPlanar, M, packed);
    for (int i = 0; i < (spatial ? 6 : 3); ++i) {
      out.m[i] += packed[i];
    }
    seen = true;
  }
  return seen && (!has_obstacles_ ||
                  models::line_of_sight(*problem_->world, at.position_m(), mean_m.head<2>()));
}

void Expander::find_candidates(const Eigen::Vector2d& p_m, double reach_m, int t) {
  candidates_.clear();
  const double far_m = range_max_m_ + reach_m;
  for (int m = 0; m < beliefs_.target_count(); ++m) {
    if ((beliefs_.mean_m(m, t).head<2>() - p_m).squaredNorm() < far_m * far_m) {
      candidates_.push_back(static_cast<std::uint16_t>(m));
    }
  }
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
  LogProduct ratio;
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    const int m = touched_[i];
    const double* block = &predicted_[kMaxPacked * i];
    if (beliefs_.cost() == CostKind::kTrace) {
      cost += trace(beliefs_.layout(m), block) - beliefs_.open_loop_measure(m, t);
      continue;
    }
    ratio.multiply(determinant(beliefs_.layout(m), block) / beliefs_.open_loop_measure(m, t));
  }
  return cost + ratio.log();
}

bool Expander::expand(Tree& tree, NodeId id, Children& out) {
  out.count = 0;
  if (!ensure_posterior(tree, id)) {
    return false;
  }
  const Node node = tree[id];
  const int t = node.depth + 1;
  predict_blocks(tree.posterior(id), t);
  const double base = node.cost + predicted_cost(t);
  find_candidates(node.world_from_body.position_m(), motion_.reach_m(), t);

  const double cos_yaw = std::cos(node.world_from_body.yaw_rad);
  const double sin_yaw = std::sin(node.world_from_body.yaw_rad);
  for (int c = 0; c < motion_.control_count(); ++c) {
    if (!motion_.is_free(node.world_from_body, cos_yaw, sin_yaw, c, node.depth)) {
      continue;
    }
    const Pose2 pose = motion_.child(node.world_from_body, cos_yaw, sin_yaw, c);
    const double cos_child = std::cos(pose.yaw_rad);
    const double sin_child = std::sin(pose.yaw_rad);
    double cost = base;
    LogProduct gained;
    for (const std::uint16_t m : candidates_) {
      PackedInformation M;
      if (!look(m, t, pose, cos_child, sin_child, M)) {
        continue;
      }
      const BlockLayout layout = beliefs_.layout(m);
      if (beliefs_.cost() == CostKind::kTrace) {
        cost -= trace_reduction(layout, M.m, predicted(m, t));
        continue;
      }
      gained.multiply(gain(layout, M.m, predicted(m, t)));
    }
    out.control[out.count] = static_cast<std::int16_t>(c);
    out.world_from_body[out.count] = pose;
    out.cost[out.count] = cost - gained.log();
    ++out.count;
  }
  forget_blocks();
  return true;
}

void Expander::update_blocks(const Pose2& at, int t) {
  find_candidates(at.position_m(), 0.0, t);
  const double cos_yaw = std::cos(at.yaw_rad);
  const double sin_yaw = std::sin(at.yaw_rad);
  result_targets_.clear();
  result_.clear();
  std::size_t next_touched = 0;
  const auto keep = [&](int m, const double* block) {
    result_targets_.push_back(static_cast<std::uint16_t>(m));
    result_.insert(result_.end(), block, block + packed_size(beliefs_.layout(m)));
  };
  const auto keep_touched_before = [&](int m) {
    while (next_touched < touched_.size() && touched_[next_touched] < m) {
      keep(touched_[next_touched], &predicted_[kMaxPacked * next_touched]);
      ++next_touched;
    }
  };
  for (const std::uint16_t m : candidates_) {
    PackedInformation M;
    if (!look(m, t, at, cos_yaw, sin_yaw, M)) {
      continue;
    }
    keep_touched_before(m);
    double block[kMaxPacked];
    update(beliefs_.layout(m), M.m, predicted(m, t), block);
    keep(m, block);
    if (next_touched < touched_.size() && touched_[next_touched] == m) {
      ++next_touched;
    }
  }
  keep_touched_before(beliefs_.target_count());
}

bool Expander::ensure_posterior(Tree& tree, NodeId id) {
  if (tree.has_posterior(id)) {
    return true;
  }
  const Node& node = tree[id];
  if (node.parent == kNoNode) {
    return tree.keep_posterior(id, {}, {});
  }
  predict_blocks(tree.posterior(node.parent), node.depth);
  update_blocks(node.world_from_body, node.depth);
  forget_blocks();
  return tree.keep_posterior(id, result_targets_, result_);
}

double Expander::cost_of_hovering(const Tree& tree, NodeId id) {
  const Node& node = tree[id];
  double cost = node.cost;
  Blocks blocks = tree.posterior(id);
  for (int t = node.depth + 1; t <= problem_->horizon_steps; ++t) {
    predict_blocks(blocks, t);
    update_blocks(node.world_from_body, t);
    forget_blocks();
    // The blocks just made are the next step's input: they live in result_, which predict_blocks
    // reads before update_blocks overwrites it.
    blocks = {result_targets_, result_.data()};
    cost += beliefs_.open_loop_cost(t);
    const double* block = result_.data();
    for (const std::uint16_t m : result_targets_) {
      const BlockLayout layout = beliefs_.layout(m);
      const double open_loop = beliefs_.open_loop_measure(m, t);
      cost += beliefs_.cost() == CostKind::kTrace
                  ? trace(layout, block) - open_loop
                  : std::log(determinant(layout, block) / open_loop);
      block += packed_size(layout);
    }
  }
  return cost;
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
  return true;
}

double Expander::lower_bound_at_root() const {
  double bound = 0.0;
  const models::Viewpoint from{problem_->start, problem_->height_m};
  for (int m = 0; m < beliefs_.target_count(); ++m) {
    const BlockLayout layout = beliefs_.layout(m);
    double block[kMaxPacked];
    std::copy_n(beliefs_.open_loop(m, 0), packed_size(layout), block);
    for (int t = 1; t <= problem_->horizon_steps; ++t) {
      beliefs_.predict_into(m, t, block, block);
      const models::PositionVector target = beliefs_.mean_m(m, t).head(beliefs_.position_dim(m));
      double information = 0.0;
      for (const models::SensorModel& sensor : problem_->sensors) {
        information += models::information_bound(sensor, from, t * motion_.reach_m(), target);
      }
      if (!std::isfinite(information)) {
        return -std::numeric_limits<double>::infinity();
      }
      if (information > 0.0) {
        PackedInformation M;
        M.m[0] = information;
        (layout == BlockLayout::kSpatial ? M.m[3] : M.m[2]) = information;
        M.m[5] = information;
        update(layout, M.m, block, block);
      }
      bound += beliefs_.cost() == CostKind::kTrace ? trace(layout, block)
                                                   : std::log(determinant(layout, block));
    }
  }
  return bound;
}

}  // namespace vantage::planner
