#include "sim/world/linear_targets.hpp"

#include <algorithm>
#include <utility>

#include "core/check.hpp"

namespace vantage::sim {
namespace {

constexpr Eigen::Index kDim = 4;

void mirror(models::StateVector& state, const models::Rectangle& bounds) {
  for (int axis = 0; axis < 2; ++axis) {
    const double inside_m = std::clamp(state(axis), bounds.min_m(axis), bounds.max_m(axis));
    if (inside_m != state(axis)) {
      state(axis) = 2.0 * inside_m - state(axis);
      state(axis + 2) = -state(axis + 2);
    }
  }
}

}  // namespace

models::StateVector draw_gaussian(const Eigen::LDLT<models::StateMatrix>& root,
                                  std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  models::StateVector white(root.rows());
  for (Eigen::Index i = 0; i < white.size(); ++i) {
    white(i) = normal(rng);
  }
  const models::StateVector scaled = root.vectorD().cwiseMax(0.0).cwiseSqrt().cwiseProduct(white);
  return root.transpositionsP().transpose() * (root.matrixL() * scaled).eval();
}

LinearTargets::LinearTargets(const models::TargetModel& model, double step_s,
                             const models::Rectangle& bounds,
                             std::vector<models::StateVector> starts, const std::mt19937_64& rng)
    : A_(model.transition(step_s)),
      root_of_W_(model.process_noise(step_s)),
      bounds_(bounds),
      states_(std::move(starts)),
      rng_(rng) {
  require(model.dim() == kDim, "linear targets have a position and a velocity in the plane");
  for (const models::StateVector& state : states_) {
    require(state.size() == kDim, "linear targets start with a position and a velocity");
  }
}

void LinearTargets::move() {
  for (models::StateVector& state : states_) {
    state = A_ * state + draw_gaussian(root_of_W_, rng_);
    mirror(state, bounds_);
  }
}

}  // namespace vantage::sim
