#include "planner/search/heuristic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/infinity.hpp"
#include "models/sensor/law.hpp"
#include "planner/problem/log_product.hpp"

namespace vantage::planner {
namespace {

constexpr double kRounding_m = 1e-9;

// Returns the horizontal distance beyond which `sensor` cannot see a target at any heading, m.
double sight_of(const models::SensorModel& sensor, bool in_space, double drop_m) {
  const double range_m = sensor.range_max_m;
  if (!in_space) {
    return range_m;
  }
  return std::abs(drop_m) >= range_m ? -kInfinity : std::sqrt(range_m * range_m - drop_m * drop_m);
}

}  // namespace

InformationHeuristic::InformationHeuristic(int targets_max, int horizon_max)
    : geodesics_(targets_max) {
  const std::size_t targets = index(targets_max);
  const std::size_t depths = index(horizon_max + 1);
  points_.reserve(targets);
  sights_m_.reserve(targets);
  speeds_mps_.reserve(targets);
  motions_.reserve(targets);
  has_static_position_.reserve(targets);
  has_fixed_.reserve(targets);
  has_only_own_information_.reserve(targets);
  open_loop_rests_.reserve(targets * depths);
  total_rests_.reserve(depths);
  stage_floors_.reserve(depths);
  ring_rests_.reserve(targets * depths * kRings);
  ring_filled_.reserve(targets * depths);
  slots_.reserve(targets);
}

// Long function: it fills several tables in turn.
void InformationHeuristic::reset(const SearchProblem& problem, const BeliefTable& beliefs) {
  problem_ = &problem;
  beliefs_ = &beliefs;
  horizon_ = problem.horizon_steps;
  step_m_ = 0.0;
  for (const models::UnicycleControl& control : problem.controls) {
    const Pose2 end = models::step_unicycle({}, control, problem.step_s);
    step_m_ = std::max(step_m_, end.position_m().norm());
  }
  step_m_ += kRounding_m;
  measures_velocity_ = std::any_of(problem.sensors.begin(), problem.sensors.end(),
                                   [](const auto& each) { return measures_velocity(each); });

  const int targets = beliefs.target_count();
  points_.clear();
  sights_m_.clear();
  speeds_mps_.clear();
  motions_.clear();
  has_static_position_.clear();
  has_fixed_.clear();
  has_only_own_information_.clear();
  for (int m = 0; m < targets; ++m) {
    const SearchTarget& target = problem.targets[index(m)];
    const bool in_space = beliefs.position_dim(m) == 3;
    double sight_m = -kInfinity;
    for (const models::SensorModel& sensor : problem.sensors) {
      const double drop_m = problem.height_m - beliefs.mean_m(m, 0).z();
      sight_m = std::max(sight_m, sight_of(sensor, in_space, drop_m));
    }
    points_.push_back(beliefs.mean_m(m, 0).head<2>());
    sights_m_.push_back(sight_m);
    double speed_mps = 0.0;
    for (int t = 0; t <= horizon_; ++t) {
      speed_mps = std::max(speed_mps, beliefs.velocity_mps(m, t).norm());
    }
    speeds_mps_.push_back(speed_mps);
    motions_.push_back(step_motion(target.model, problem.step_s));
    const bool has_static_position = !target.model.has_velocity();
    has_static_position_.push_back(has_static_position ? 1 : 0);
    bool fixed = false;
    if (!problem.fixed_information.empty()) {
      for (int t = 0; t < horizon_; ++t) {
        const models::StateMatrix& M = problem.fixed_information[index(m)][index(t)];
        fixed = fixed || (M.size() > 0 && !M.isZero(0.0));
      }
    }
    has_fixed_.push_back(fixed ? 1 : 0);
    const bool still =
        has_static_position && target.model.process_noise(problem.step_s).isZero(0.0);
    has_only_own_information_.push_back(still && !fixed ? 1 : 0);
  }
  geodesics_.reset(sight_world(problem), points_);  // no detours if sensors see over obstacles
  slots_.assign(index(targets), -1);

  open_loop_rests_.assign(index(targets) * index(horizon_ + 1), 0.0);
  total_rests_.assign(index(horizon_ + 1), 0.0);
  for (int m = 0; m < targets; ++m) {
    for (int t = horizon_ - 1; t >= 0; --t) {
      const double measure = beliefs.open_loop_measure(m, t + 1);
      open_loop_rests_[at(m, t)] =
          open_loop_rests_[at(m, t + 1)] +
          (beliefs.cost() == CostKind::kLogDet ? std::log(measure) : measure);
    }
    for (int t = 0; t <= horizon_; ++t) {
      total_rests_[index(t)] += open_loop_rests_[at(m, t)];
    }
  }
  ring_rests_.resize(index(targets) * index(horizon_ + 1) * kRings);
  ring_filled_.assign(index(targets) * index(horizon_ + 1), 0);

  stage_floors_.assign(index(horizon_ + 1), 0.0);
  GeodesicTable::VisibleCorners visible;
  geodesics_.find_visible_corners(problem.start.position_m(), visible);
  for (int m = 0; m < targets; ++m) {
    const PathRange ring = has_static_position(m)
                               ? paths_of_ring(ring_of(geodesics_.path_m(visible, m)))
                               : PathRange{};
    const auto path = [&](int k) {
      if (has_static_position(m)) {
        return ring;
      }
      const double path_m = (beliefs.mean_m(m, k).head<2>() - problem.start.position_m()).norm();
      return PathRange{path_m, path_m};
    };
    const bool bounded =
        for_each_step(m, 0, beliefs.open_loop(m, 0), path, [&](int k, double measure) {
          stage_floors_[index(k)] +=
              beliefs.cost() == CostKind::kLogDet ? std::log(measure) : measure;
        });
    if (!bounded) {
      std::fill(stage_floors_.begin(), stage_floors_.end(), -kInfinity);
      return;
    }
  }
}

LookBound InformationHeuristic::look_bound(int m, double nearest_m, double farthest_m,
                                           int steps) const {
  LookBound bound;
  const bool in_space = beliefs_->position_dim(m) == 3;
  // Only the distance matters, so the target is at the origin and the robot on the x axis.
  const double middle_m = 0.5 * (nearest_m + farthest_m);
  const models::Viewpoint from{{middle_m, 0.0, 0.0}, problem_->height_m};
  models::PositionVector target = models::PositionVector::Zero(in_space ? 3 : 2);
  if (in_space) {
    target(2) = beliefs_->mean_m(m, 0).z();
  }
  const double reach_m = steps * step_m_ + (farthest_m - middle_m);
  for (const models::SensorModel& sensor : problem_->sensors) {
    if (measures_velocity_ && measures_velocity(sensor) &&
        beliefs_->layout(m) == BlockLayout::kMoving) {
      bound.of_state +=
          models::information_bound(sensor, from, reach_m, target, speeds_mps_[index(m)]);
      continue;
    }
    const double strongest = models::information_bound(sensor, from, reach_m, target);
    if (strongest == 0.0) {
      continue;
    }
    // `pointed`: the information differs between directions (range, bearing or both).
    const models::SensorLaw& law = sensor.kind.law();
    const bool pointed =
        !in_space && law.planar_law != nullptr && law.planar_law(sensor).isotropic_per_m2 == 0.0;
    if (!pointed) {
      bound.all_round += strongest;
      continue;
    }
    double weakest = 0.0;
    if (law.measures_range && law.measures_bearing) {
      models::SensorModel part = sensor;
      part.kind = models::SensorKind::kRange;
      weakest = models::information_bound(part, from, reach_m, target);
      if (weakest == strongest) {
        part.kind = models::SensorKind::kBearing;
        weakest = models::information_bound(part, from, reach_m, target);
      }
    }
    bound.all_round += weakest;
    bound.pointed += strongest - weakest;
    ++bound.pointed_count;
  }
  return bound;
}

template <class PathAt, class Emit>
bool InformationHeuristic::for_each_step(int m, int t, const double* block, const PathAt& path,
                                         const Emit& emit) const {
  const BlockLayout layout = beliefs_->layout(m);
  const bool trace_cost = beliefs_->cost() == CostKind::kTrace;
  const bool by_sum = layout == BlockLayout::kPlanar && !has_fixed(m);
  const bool by_recursion = !has_only_own_information(m) || !by_sum;
  const bool by_average = by_recursion && is_averaged(m);
  AveragedBlock averaged;
  if (by_average) {
    averaged = AveragedBlock(layout, block);
  }
  PointedInformation sum;
  if (by_sum) {
    sum = PointedInformation(block);
  }
  double recursed[kMaxPacked];
  std::copy_n(block, packed_size(layout), recursed);
  for (int k = t + 1; k <= horizon_; ++k) {
    const PathRange to = path(k);
    const bool in_reach = to.nearest_m < sight_m(m) + (k - t) * step_m_ + kRounding_m;
    const LookBound look =
        in_reach ? look_bound(m, to.nearest_m, to.farthest_m, k - t) : LookBound{};
    if (!std::isfinite(look.strongest() + look.of_state)) {
      return false;
    }
    double measure = 0.0;
    if (by_sum) {
      sum.add(look);
      measure = trace_cost ? sum.covariance_trace() : 1.0 / sum.determinant();
    }
    if (by_recursion) {
      beliefs_->predict_into(m, k, recursed, recursed);
      if (look.of_state > 0.0) {
        PackedInformation M;
        M.is_of_state = true;
        M.m[0] = M.m[2] = look.strongest() + look.of_state;
        M.m[7] = M.m[9] = look.of_state;
        update_state(M.m, recursed, recursed);
      } else if (look.strongest() > 0.0) {
        PackedInformation M;
        M.m[0] = look.strongest();
        (layout == BlockLayout::kSpatial ? M.m[3] : M.m[2]) = look.strongest();
        M.m[5] = look.strongest();
        update(layout, M.m, recursed, recursed);
      }
      measure =
          std::max(measure, trace_cost ? trace(layout, recursed) : determinant(layout, recursed));
    }
    if (by_average) {
      averaged.predict(motion(m));
      averaged.update(look.average());
      measure = std::max(measure, trace_cost ? averaged.trace() : averaged.determinant());
    }
    emit(k, measure);
  }
  return true;
}

template <class PathAt>
double InformationHeuristic::rest(int m, int t, const double* block, const PathAt& path) const {
  if (beliefs_->cost() == CostKind::kTrace) {
    double sum = 0.0;
    const bool bounded =
        for_each_step(m, t, block, path, [&](int, double measure) { sum += measure; });
    return bounded ? sum : -kInfinity;
  }
  LogProduct product;
  const bool bounded =
      for_each_step(m, t, block, path, [&](int, double measure) { product.multiply(measure); });
  return bounded ? product.log() : -kInfinity;
}

int InformationHeuristic::ring_of(double path_m) const {
  // A step crosses at most kRingsPerStep rings inwards despite rounding, since step_m_ is rounded
  // up.
  const double ring = (path_m - kRounding_m) * kRingsPerStep / step_m_;
  return static_cast<int>(std::clamp(ring, 0.0, kRings - 1.0));
}

InformationHeuristic::PathRange InformationHeuristic::paths_of_ring(int ring) const {
  constexpr double kAnywhere_m = 1e9;
  const double ring_m = step_m_ / kRingsPerStep;
  const double inner_m = ring * ring_m;
  return {inner_m, ring == kRings - 1 ? inner_m + kAnywhere_m : inner_m + ring_m + kRounding_m};
}

double InformationHeuristic::untouched_rest(int m, int t, double path_m) {
  double* rings = &ring_rests_[at(m, t) * kRings];
  if (ring_filled_[at(m, t)] == 0) {
    std::fill_n(rings, kRings, std::numeric_limits<double>::quiet_NaN());
    ring_filled_[at(m, t)] = 1;
  }
  const int ring = ring_of(path_m);
  if (std::isnan(rings[ring])) {
    const PathRange path = paths_of_ring(ring);
    rings[ring] = rest(m, t, beliefs_->open_loop(m, t), [&](int) { return path; });
  }
  return rings[ring];
}

InformationHeuristic::Parts InformationHeuristic::cost_to_go(const Pose2& at, int depth,
                                                             const Blocks& blocks,
                                                             const std::uint8_t* apart) {
  if (depth >= horizon_) {
    return {};
  }
  const Eigen::Vector2d p_m = at.position_m();
  GeodesicTable::VisibleCorners visible;
  geodesics_.find_visible_corners(p_m, visible);
  std::int32_t offset = 0;
  for (const std::uint16_t m : blocks.targets) {
    slots_[m] = offset;
    offset += packed_size(beliefs_->layout(m));
  }
  double cost = open_loop_rest(depth);
  double apart_cost = 0.0;
  for (int m = 0; m < beliefs_->target_count(); ++m) {
    const std::int32_t slot = slots_[index(m)];
    const bool touched = slot >= 0;
    const bool is_apart = apart != nullptr && apart[m] != 0;
    double least = open_loop_rest(m, depth);
    if (has_static_position(m)) {
      const double far_m = sight_m(m) + (horizon_ - depth) * step_m_ + kRounding_m;
      const bool near = (points_[index(m)] - p_m).squaredNorm() < far_m * far_m;
      const double path_m = near ? geodesics_.path_m(visible, m) : kInfinity;
      if (!touched && path_m >= far_m) {
        apart_cost += is_apart ? least : 0.0;
        continue;
      }
      least = touched ? rest(m, depth, blocks.packed + slot,
                             [&](int) {
                               return PathRange{path_m, path_m};
                             })
                      : untouched_rest(m, depth, path_m);
    } else {
      const auto path = [&](int k) {
        const double path_m = (beliefs_->mean_m(m, k).head<2>() - p_m).norm();
        return PathRange{path_m, path_m};
      };
      bool near = touched;
      for (int k = depth + 1; k <= horizon_ && !near; ++k) {
        near = path(k).nearest_m < sight_m(m) + (k - depth) * step_m_ + kRounding_m;
      }
      if (!near) {
        apart_cost += is_apart ? least : 0.0;
        continue;
      }
      least = rest(m, depth, touched ? blocks.packed + slot : beliefs_->open_loop(m, depth), path);
    }
    cost += least - open_loop_rest(m, depth);
    apart_cost += is_apart ? least : 0.0;
  }
  for (const std::uint16_t m : blocks.targets) {
    slots_[m] = -1;
  }
  return {std::isnan(cost) ? -kInfinity : cost, apart_cost};
}

}  // namespace vantage::planner
