#include "planner/problem/belief_table.hpp"

#include <cmath>

namespace vantage::planner {
namespace {

BlockLayout layout_of(const models::TargetModel& model) {
  if (model.has_velocity()) {
    return BlockLayout::kMoving;
  }
  return model.position_dim == 3 ? BlockLayout::kSpatial : BlockLayout::kPlanar;
}

// Packs information about the position, or about the state of a moving target.
PackedInformation packed_information(const models::StateMatrix& M, int position_dim) {
  PackedInformation packed;
  packed.is_of_state = M.rows() == 4;
  pack(packed.is_of_state  ? BlockLayout::kMoving
       : position_dim == 3 ? BlockLayout::kSpatial
                           : BlockLayout::kPlanar,
       M, packed.m);
  return packed;
}

}  // namespace

void pack(BlockLayout layout, const models::StateMatrix& covariance, double* out) {
  const auto& S = covariance;
  if (layout == BlockLayout::kSpatial) {
    const double packed[] = {S(0, 0), S(0, 1), S(0, 2), S(1, 1), S(1, 2), S(2, 2)};
    std::copy(std::begin(packed), std::end(packed), out);
    return;
  }
  out[0] = S(0, 0);
  out[1] = S(0, 1);
  out[2] = S(1, 1);
  if (layout == BlockLayout::kMoving) {
    const double packed[] = {S(0, 2), S(0, 3), S(1, 2), S(1, 3), S(2, 2), S(2, 3), S(3, 3)};
    std::copy(std::begin(packed), std::end(packed), out + 3);
  }
}

models::StateMatrix unpack(BlockLayout layout, const double* b) {
  if (layout == BlockLayout::kSpatial) {
    return unpack3(b);
  }
  if (layout == BlockLayout::kPlanar) {
    models::StateMatrix S(2, 2);
    S << b[0], b[1], b[1], b[2];
    return S;
  }
  models::StateMatrix S(4, 4);
  S << b[0], b[1], b[3], b[4],  //
      b[1], b[2], b[5], b[6],   //
      b[3], b[5], b[7], b[8],   //
      b[4], b[6], b[8], b[9];
  return S;
}

BeliefTable::BeliefTable(int targets_max, int horizon_max) {
  const std::size_t targets = index(targets_max);
  const std::size_t cells = targets * index(horizon_max + 1);
  layouts_.reserve(targets);
  motions_.reserve(targets);
  means_.reserve(cells);
  velocities_.reserve(cells);
  open_loop_.reserve(cells * kMaxPacked);
  measures_.reserve(cells);
  per_measures_.reserve(cells);
  stage_costs_.reserve(index(horizon_max + 1));
  fixed_.reserve(cells);
  is_fixed_.reserve(cells);
}

void BeliefTable::predict_into(int m, int t, const double* in, double* out) const {
  planner::predict(layouts_[index(m)], motions_[index(m)], in, out);
  if (has_fixed_) {
    const std::size_t cell = at(m, t - 1);
    if (is_fixed_[cell] != 0) {
      update(layouts_[index(m)], fixed_[cell], out, out);
    }
  }
}

void BeliefTable::reset(const SearchProblem& problem) {
  const int targets = static_cast<int>(problem.targets.size());
  const int horizon = problem.horizon_steps;
  cost_ = problem.cost;
  layouts_.clear();
  motions_.clear();
  for (const SearchTarget& target : problem.targets) {
    layouts_.push_back(layout_of(target.model));
    motions_.push_back(step_motion(target.model, problem.step_s));
  }
  const std::size_t cells = index(targets) * index(horizon + 1);
  means_.resize(cells);
  velocities_.resize(cells);
  open_loop_.resize(cells * kMaxPacked);
  measures_.resize(cells);
  per_measures_.resize(cells);
  stage_costs_.assign(index(horizon + 1), 0.0);

  has_fixed_ = false;
  if (!problem.fixed_information.empty()) {
    fixed_.assign(index(targets) * index(horizon), {});
    is_fixed_.assign(index(targets) * index(horizon), 0);
    for (int m = 0; m < targets; ++m) {
      for (int t = 0; t < horizon; ++t) {
        const models::StateMatrix& M = problem.fixed_information[index(m)][index(t)];
        if (M.size() == 0 || M.isZero(0.0)) {
          continue;
        }
        fixed_[at(m, t)] = packed_information(M, position_dim(m));
        is_fixed_[at(m, t)] = 1;
        has_fixed_ = true;
      }
    }
  }

  for (int m = 0; m < targets; ++m) {
    const SearchTarget& target = problem.targets[index(m)];
    const int p = position_dim(m);
    models::StateVector mean = target.prior.mean;
    pack(layout(m), target.prior.covariance, &open_loop_[kMaxPacked * at(m, 0)]);
    for (int t = 0; t <= horizon; ++t) {
      if (t > 0) {
        mean = target.model.expected(mean, problem.step_s);
        predict_into(m, t, open_loop(m, t - 1), &open_loop_[kMaxPacked * at(m, t)]);
      }
      means_[at(m, t)] = Eigen::Vector3d(mean(0), mean(1), p == 3 ? mean(2) : 0.0);
      velocities_[at(m, t)] = models::velocity_of(mean);
      const double* block = open_loop(m, t);
      const double measure =
          cost_ == CostKind::kLogDet ? determinant(layout(m), block) : trace(layout(m), block);
      measures_[at(m, t)] = measure;
      per_measures_[at(m, t)] = 1.0 / measure;
      stage_costs_[index(t)] += cost_ == CostKind::kLogDet ? std::log(measure) : measure;
    }
  }
}

}  // namespace vantage::planner
