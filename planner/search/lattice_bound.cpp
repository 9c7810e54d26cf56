#include "planner/search/lattice_bound.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "core/infinity.hpp"
#include "models/sensor/law.hpp"

namespace vantage::planner {
namespace {

constexpr double kEdge_rad = 1e-6;
constexpr double kEdge_m = ReachLattice::kEdge_m;
constexpr double kFloatRounding = 1e-5;  // relative rounding error of float sums
constexpr std::size_t kCellNodes = 4;    // nodes of work per view from a cell

// Split of a measurement's information: `kept` counts linearly, and the excess gains at most
// ln(`more`) nats per state.
struct Capped {
  double kept = 0.0;
  double more = 1.0;
};

// Minimises `per_strength` b' + weight ln((b + known) / (b' + known)) over b'.
Capped capped(double strength, double per_strength, double weight, double known) {
  const double kept = std::max(0.0, weight / per_strength - known);
  return kept < strength ? Capped{kept, (strength + known) / (kept + known)}
                         : Capped{strength, 1.0};
}

}  // namespace

LatticeBound::LatticeBound(int targets_max, int horizon_max, std::size_t states_max)
    : reach_(horizon_max),
      cost_(targets_max, horizon_max),
      states_(kPauseStepsMax * states_max),
      squares_(kPauseStepsMax * states_max / 2),
      looks_(states_max / 2) {
  const double finest = ReachLattice::kCellsPerStep[0];
  const auto width_max = 2 * static_cast<std::size_t>(finest) * (index(horizon_max) + 1) + 8;
  sensors_.reserve(8);
  path_information_.resize(3 * index(targets_max) * index(horizon_max));
  near_radii_m_.reserve(index(targets_max));
  bounding_boxes_.resize(index(targets_max));
  row_.resize(width_max);
  rare_row_.resize(width_max);
  all_round_ = ReservedArray<float>(width_max * width_max);
  rare_ = ReservedArray<float>(width_max * width_max);
}

void LatticeBound::prefault() {
  states_.prefault();
  squares_.prefault();
  looks_.prefault();
  all_round_.prefault();
  rare_.prefault();
}

void LatticeBound::reset(const SearchProblem& problem, const BeliefTable& beliefs) {
  problem_ = &problem;
  beliefs_ = &beliefs;
  targets_ = beliefs.target_count();
  horizon_ = problem.horizon_steps;
  cost_.reset(problem, beliefs, InformationMeasure::kLogDet);
  applies_ = reach_.reset(problem) && beliefs.cost() == CostKind::kLogDet && targets_ > 0;
  sensors_.clear();
  sight_m_ = 0.0;
  for (const models::SensorModel& model : problem.sensors) {
    const models::SensorLaw& law = model.kind.law();
    if (law.planar_law == nullptr) {
      applies_ = false;
      return;
    }
    const models::PlanarLaw planar = law.planar_law(model);
    sensors_.push_back({model.range_max_m, model.range_min_m, std::min(kPi, 0.5 * model.fov_rad),
                        planar.along_per_m2, planar.across_per_rad2, planar.isotropic_per_m2,
                        1.0 / model.range_max_m, model.variance_floor,
                        model.variance_grows_with_range});
    sight_m_ = std::max(sight_m_, model.range_max_m);
  }
  for (int m = 0; m < targets_; ++m) {
    applies_ = applies_ && beliefs.layout(m) != BlockLayout::kSpatial;
  }
  const auto is_of_state = [](const models::StateMatrix& M) { return M.rows() > 2; };
  for (const std::vector<models::StateMatrix>& fixed : problem.fixed_information) {
    applies_ = applies_ && std::none_of(fixed.begin(), fixed.end(), is_of_state);
  }
  find_rare_gains();
}

void LatticeBound::find_rare_gains() {
  constexpr double kNearRadiusMax_m = 0.2;
  constexpr double kBesideLeast_m = 0.02;
  near_radii_m_.assign(index(targets_), 0.0);
  pause_steps_ = 1;
  if (sensors_.size() > 1) {
    return;  // add_rewards() takes only the maximum rare gain of one sensor
  }
  // Smallest and largest distances covered in one and in two steps.
  double least_m[kPauseStepsMax] = {0.0, kInfinity, kInfinity};
  double most_m[kPauseStepsMax] = {};
  for (const Pose2& first : reach_.ends()) {
    least_m[1] = std::min(least_m[1], first.position_m().norm());
    most_m[1] = std::max(most_m[1], first.position_m().norm());
    for (const models::UnicycleControl& control : problem_->controls) {
      const double way_m =
          models::step_unicycle(first, control, problem_->step_s).position_m().norm();
      least_m[2] = std::min(least_m[2], way_m);
      most_m[2] = std::max(most_m[2], way_m);
    }
  }
  // Returns the sum of the radii of targets i and j below which no controls lead from near i at
  // step k to near j at step k + steps; negative if some controls always do.
  const auto slack_m = [&](int i, int j) {
    double slack = kInfinity;
    for (int steps = i == j ? 1 : 0; steps < kPauseStepsMax; ++steps) {
      for (int k = 1; k + steps <= horizon_; ++k) {
        const double way_m =
            (beliefs_->mean_m(j, k + steps).head<2>() - beliefs_->mean_m(i, k).head<2>()).norm();
        slack = std::min(slack, std::max(least_m[steps] - way_m, way_m - most_m[steps]));
      }
    }
    return slack - kEdge_m;
  };
  for (int m = 0; m < targets_; ++m) {
    models::Rectangle& bounding_box = bounding_boxes_[index(m)];
    bounding_box = {beliefs_->mean_m(m, 1).head<2>(), beliefs_->mean_m(m, 1).head<2>()};
    for (int k = 2; k <= horizon_; ++k) {
      bounding_box.min_m = bounding_box.min_m.cwiseMin(beliefs_->mean_m(m, k).head<2>());
      bounding_box.max_m = bounding_box.max_m.cwiseMax(beliefs_->mean_m(m, k).head<2>());
    }
    double near_m = std::min(kNearRadiusMax_m, 0.5 * slack_m(m, m));
    const double far_m = most_m[kPauseStepsMax - 1] + 2.0 * kNearRadiusMax_m + kEdge_m;
    for (int other = 0; other < m; ++other) {
      const models::Rectangle& its = bounding_boxes_[index(other)];
      const bool is_far = (bounding_box.min_m.array() - its.max_m.array() > far_m).any() ||
                          (its.min_m.array() - bounding_box.max_m.array() > far_m).any();
      if (near_radii_m_[index(other)] > 0.0 && !is_far) {
        near_m = std::min({near_m, slack_m(m, other) - near_radii_m_[index(other)],
                           slack_m(other, m) - near_radii_m_[index(other)]});
      }
    }
    if (near_m >= kBesideLeast_m) {
      near_radii_m_[index(m)] = near_m;
      pause_steps_ = kPauseStepsMax;
    }
  }
}

void LatticeBound::begin(float* reference) const {
  constexpr double kShare = 0.1;
  for (int m = 0; m < targets_; ++m) {
    for (int k = 1; k <= horizon_; ++k) {
      const double away_m =
          (beliefs_->mean_m(m, k).head<2>() - problem_->start.position_m()).norm();
      double strength = 0.0;
      for (const Sensor& sensor : sensors_) {
        const double middle_m = 0.5 * sensor.range_max_m;
        if (away_m < sensor.range_max_m + k * reach_.step_m()) {
          strength += sensor.isotropic_per_m2 +
                      0.5 * (sensor.along + sensor.across / (middle_m * middle_m));
        }
      }
      float* const R = reference + 3 * cost_.at(m, k);
      R[0] = R[2] = static_cast<float>(kShare * strength);
      R[1] = 0.0F;
    }
  }
}

bool LatticeBound::work(std::size_t nodes) {
  *work_nodes_ += 1 + static_cast<std::int64_t>(nodes);
  return !deadline_->expired(*work_nodes_);
}

void LatticeBound::mark_reached(const Pose2& at, int depth, LinearisedCost& cost) const {
  for (int m = 0; m < targets_; ++m) {
    for (int k = depth + 1; k <= horizon_; ++k) {
      const double away_m = (beliefs_->mean_m(m, k).head<2>() - at.position_m()).norm();
      if (away_m < sight_m_ + (k - depth) * reach_.step_m() + kEdge_m) {
        cost.set_reached(m, k);
      }
    }
  }
}

bool LatticeBound::clear_level(int t) {
  const ReachLattice::Level& level = layout_->levels[index(t)];
  std::fill_n(all_round_.data(), level.any.size(), 0.0F);
  std::fill_n(rare_.data(), level.any.size(), 0.0F);
  for (int n = -level.turns; n <= level.turns; ++n) {
    const ReachLattice::Plane& plane = layout_->plane(t, n);
    std::fill_n(looks_.data() + plane.begin, plane.size(), 0.0F);
    if (!work(plane.size() / kMovesANode)) {
      return false;
    }
  }
  return true;
}

LatticeBound::LocalGradient LatticeBound::local_gradient(int m, int k) const {
  const LinearisedCost::Gradient& g = query_cost_->gradient(m, k);
  const double half_difference = 0.5 * (g.xx - g.yy);
  const double cos_2 = std::cos(2.0 * from_.yaw_rad);
  const double sin_2 = std::sin(2.0 * from_.yaw_rad);
  LocalGradient out;
  out.at_m = inverse(from_) * Eigen::Vector2d(beliefs_->mean_m(m, k).head<2>());
  out.mean = 0.5 * (g.xx + g.yy);
  out.half_difference = half_difference * cos_2 + g.xy * sin_2;
  out.xy = g.xy * cos_2 - half_difference * sin_2;
  out.amplitude = std::sqrt(half_difference * half_difference + g.xy * g.xy);
  out.weight = query_cost_->weight(k);
  out.known = query_cost_->known(m, k);
  out.near_radius_m = near_radii_m_[index(m)];
  return out;
}

// Long function: it computes the distances and directions of a cell, then their values.
LatticeBound::CellGain LatticeBound::cell_gain(const LocalGradient& local_gradient,
                                               const Sensor& sensor, double dx_m, double dy_m,
                                               double half_cell_m) {
  const double ax_m = std::abs(dx_m);
  const double ay_m = std::abs(dy_m);
  const double nx_m = std::max(0.0, ax_m - half_cell_m);
  const double ny_m = std::max(0.0, ay_m - half_cell_m);
  const double near2_m2 = nx_m * nx_m + ny_m * ny_m;
  if (near2_m2 >= sensor.range_max_m * sensor.range_max_m) {
    return {};
  }
  const double fx_m = ax_m + half_cell_m;
  const double fy_m = ay_m + half_cell_m;
  if (fx_m * fx_m + fy_m * fy_m < sensor.range_min_m * sensor.range_min_m) {
    return {};
  }
  // Range of the gradient's values over the directions towards the cell.
  const double amplitude = local_gradient.amplitude;
  const double center2_m2 = dx_m * dx_m + dy_m * dy_m;
  const double sin2_spread = 2.0 * half_cell_m * half_cell_m / center2_m2;
  double most = amplitude;
  double least = -amplitude;
  CellGain out;
  out.half_angle_rad = kPi;
  if (sin2_spread < 1.0) {
    const double spread_rad = std::asin(std::sqrt(sin2_spread));
    out.half_angle_rad = std::min(kPi, sensor.half_fov_rad + spread_rad + kEdge_rad);
    const double cos_2 = (dx_m * dx_m - dy_m * dy_m) / center2_m2;
    const double sin_2 = 2.0 * dx_m * dy_m / center2_m2;
    const double here = local_gradient.half_difference * cos_2 + local_gradient.xy * sin_2;
    const double turned =
        std::abs(local_gradient.xy * cos_2 - local_gradient.half_difference * sin_2);
    const double cos_spread = 1.0 - 2.0 * sin2_spread;  // cosine of twice the spread
    const double sin_spread = 2.0 * std::sqrt(sin2_spread * (1.0 - sin2_spread));
    if (here < amplitude * cos_spread) {
      most = here * cos_spread + turned * sin_spread;
    }
    if (-here < amplitude * cos_spread) {
      least = here * cos_spread - turned * sin_spread;
    }
  }
  if (sensor.half_fov_rad >= kPi) {
    out.half_angle_rad = kPi;
  }
  const double per_along = local_gradient.mean + most;
  const double per_across = local_gradient.mean - least;
  const auto value = [&](double r_m) {
    const double growth =
        sensor.grows ? std::max(sensor.variance_floor, r_m * sensor.growth_per_m) : 1.0;
    const Capped forth = capped(sensor.along / growth + sensor.isotropic_per_m2, per_along,
                                local_gradient.weight, local_gradient.known);
    const Capped side = capped(sensor.across / (r_m * r_m * growth) + sensor.isotropic_per_m2,
                               per_across, local_gradient.weight, local_gradient.known);
    out.along = forth.kept;
    out.across = side.kept;
    const double more = forth.more * side.more;
    return per_along * forth.kept + per_across * side.kept +
           (more > 1.0 ? local_gradient.weight * std::log(more) : 0.0);
  };
  const double r_m = std::max({std::sqrt(near2_m2), sensor.range_min_m, models::kLeastRange_m});
  out.near_gain = r_m < local_gradient.near_radius_m ? value(r_m) : 0.0;
  out.reward = value(std::max(r_m, local_gradient.near_radius_m));
  out.near_gain = std::max(0.0, out.near_gain - out.reward);
  return out;
}

// Long function: it has nested loops over targets, sensors and cells.
bool LatticeBound::add_rewards(int t) {
  const int k = depth_ + t;
  const ReachLattice::Level& level = layout_->levels[index(t)];
  const double cell_m = layout_->cell_m;
  const double half_cell_m = 0.5 * cell_m + kEdge_m;
  const double unit_rad = reach_.unit_rad();
  const double period = 2.0 * kPi / unit_rad;
  for (int m = 0; m < targets_; ++m) {
    if (!query_cost_->is_reached(m, k)) {
      continue;
    }
    const LocalGradient local_gradient = this->local_gradient(m, k);
    for (const Sensor& sensor : sensors_) {
      const double within_m = sensor.range_max_m + half_cell_m;
      const int low =
          std::max(level.any.low,
                   static_cast<int>(std::ceil((local_gradient.at_m.y() - within_m) / cell_m)));
      const int high =
          std::min(level.any.high,
                   static_cast<int>(std::floor((local_gradient.at_m.y() + within_m) / cell_m)));
      for (int j = low; j <= high; ++j) {
        const double dy_m = local_gradient.at_m.y() - j * cell_m;
        const double ny_m = std::max(0.0, std::abs(dy_m) - half_cell_m);
        const double across2_m2 = sensor.range_max_m * sensor.range_max_m - ny_m * ny_m;
        if (across2_m2 <= 0.0) {
          continue;
        }
        const ReachLattice::Row row = ReachLattice::row(level.any, j);
        const double wide_m = std::sqrt(across2_m2) + half_cell_m;
        const int left = std::max(
            row.left, static_cast<int>(std::ceil((local_gradient.at_m.x() - wide_m) / cell_m)));
        const int right = std::min(
            row.right, static_cast<int>(std::floor((local_gradient.at_m.x() + wide_m) / cell_m)));
        for (int i = left; i <= right; ++i) {
          const double dx_m = local_gradient.at_m.x() - i * cell_m;
          const CellGain seen = cell_gain(local_gradient, sensor, dx_m, dy_m, half_cell_m);
          if (seen.reward <= 0.0) {
            continue;
          }
          const auto reward = static_cast<float>(seen.reward);
          const std::ptrdiff_t cell = level.any.at(i, j);
          float& rare = rare_.data()[cell];
          rare = std::max(rare, static_cast<float>(seen.near_gain));
          if (seen.half_angle_rad >= kPi) {
            all_round_.data()[cell] += reward;
            continue;
          }
          const double bearing = std::atan2(dy_m, dx_m) / unit_rad;
          const double spread = seen.half_angle_rad / unit_rad;
          double middle = bearing - period * std::floor((bearing + spread + level.turns) / period);
          for (; middle - spread <= level.turns; middle += period) {
            const int first = std::max(-level.turns, static_cast<int>(std::ceil(middle - spread)));
            const int last = std::min(level.turns, static_cast<int>(std::floor(middle + spread)));
            for (int n = first; n <= last; ++n) {
              const ReachLattice::Plane& plane = layout_->plane(t, n);
              if (plane.has(i, j)) {
                looks_.data()[static_cast<std::ptrdiff_t>(plane.begin) + plane.at(i, j)] += reward;
              }
            }
          }
        }
        if (right >= left && !work(kCellNodes * index(right - left + 1))) {
          return false;
        }
      }
    }
  }
  return true;
}

LatticeBound::Answer LatticeBound::cost_to_go(const Pose2& at, int depth, const Blocks& blocks,
                                              float* reference, double share, std::size_t states,
                                              const Deadline& deadline, std::int64_t& work_nodes) {
  deadline_ = &deadline;
  work_nodes_ = &work_nodes;
  cost_.clear_reached();
  mark_reached(at, depth, cost_);
  double base = 0.0;
  std::size_t touched = 0;
  const double* packed = blocks.packed;
  for (int m = 0; m < targets_; ++m) {
    const double* block = beliefs_->open_loop(m, depth);
    if (touched < blocks.targets.size() && blocks.targets[touched] == m) {
      block = packed;
      packed += packed_size(beliefs_->layout(m));
      ++touched;
    }
    base += cost_.linearise(m, depth, block, reference);
    if (!work(kTargetNodes)) {
      return {-kInfinity, true};
    }
  }
  const bool betters = share > 0.0;
  std::fill(path_information_.begin(), path_information_.end(), 0.0F);
  const Path path = best_path(at, depth, cost_, betters ? path_information_.data() : nullptr,
                              states, deadline, work_nodes);
  const double cost = base - path.gained - kFloatRounding * (1.0 + path.gained);
  if (betters && !path.expired && path.gained < kInfinity) {
    for (int m = 0; m < targets_; ++m) {
      for (std::size_t i = 3 * cost_.at(m, depth + 1); i < 3 * cost_.at(m, horizon_) + 3; ++i) {
        reference[i] += static_cast<float>(share) * (path_information_[i] - reference[i]);
      }
    }
  }
  return {std::isnan(cost) ? -kInfinity : cost, path.expired};
}

LatticeBound::Path LatticeBound::best_path(const Pose2& at, int depth, const LinearisedCost& cost,
                                           float* path_information, std::size_t states,
                                           const Deadline& deadline, std::int64_t& work_nodes) {
  from_ = at;
  depth_ = depth;
  query_cost_ = &cost;
  deadline_ = &deadline;
  work_nodes_ = &work_nodes;
  layout_ = reach_.layout(horizon_ - depth, std::min(states, states_.size() / kPauseStepsMax),
                          looks_.size());
  if (layout_ == nullptr) {
    return {kInfinity, false};
  }
  for (int t = horizon_ - depth_; t >= 1; --t) {
    if (!clear_level(t) || !add_rewards(t) || !gather(t)) {
      return {kInfinity, true};
    }
  }
  const double most = best_first_step();
  return {most, path_information != nullptr && !follow_best(path_information)};
}

}  // namespace vantage::planner
