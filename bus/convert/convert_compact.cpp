#include <algorithm>

#include "bus/convert/convert_parts.hpp"
#include "models/exchange/compact_belief.hpp"

// Rounded beliefs of robots: COMPACT_BELIEF_R.

namespace vantage::bus {

using namespace parts;  // NOLINT(google-build-using-namespace): names of the converters

namespace {

int correlations_of(int dim) { return dim * (dim - 1) / 2; }

vantage_lcm::compact_target_t target_to(const models::CompactTarget& target) {
  vantage_lcm::compact_target_t wire{};
  const int correlations = correlations_of(target.dim);
  wire.target_id = target.target_id;
  wire.dim = static_cast<std::int8_t>(target.dim);
  wire.mean.assign(target.mean.begin(), target.mean.begin() + target.dim);
  wire.sigma_code.assign(target.sigma_code.begin(), target.sigma_code.begin() + target.dim);
  wire.num_correlations = static_cast<std::int8_t>(correlations);
  wire.correlation_code.assign(target.correlation_code.begin(),
                               target.correlation_code.begin() + correlations);
  wire.unseen_ms = target.unseen_ms;
  return wire;
}

std::optional<models::CompactTarget> target_from(const vantage_lcm::compact_target_t& wire) {
  if (wire.target_id < 0 || wire.dim < models::kMinTargetDim || wire.dim > models::kMaxTargetDim ||
      wire.num_correlations != correlations_of(wire.dim) || !is_count(wire.dim, wire.mean.size()) ||
      !is_count(wire.dim, wire.sigma_code.size()) ||
      !is_count(wire.num_correlations, wire.correlation_code.size())) {
    return std::nullopt;
  }
  models::CompactTarget target;
  target.target_id = wire.target_id;
  target.dim = wire.dim;
  std::copy(wire.mean.begin(), wire.mean.end(), target.mean.begin());
  std::copy(wire.sigma_code.begin(), wire.sigma_code.end(), target.sigma_code.begin());
  std::copy(wire.correlation_code.begin(), wire.correlation_code.end(),
            target.correlation_code.begin());
  target.unseen_ms = wire.unseen_ms;
  return target;
}

}  // namespace

vantage_lcm::compact_belief_t to_wire(const models::CompactBelief& belief) {
  auto wire = stamped<vantage_lcm::compact_belief_t>(belief.stamp);
  wire.robot = belief.robot;
  wire.step = belief.step;
  viewpoint_to(belief.viewpoint, wire);
  wire.num_targets = count_of(belief.targets.size());
  wire.targets.reserve(belief.targets.size());
  for (const models::CompactTarget& target : belief.targets) {
    wire.targets.push_back(target_to(target));
  }
  grid_to(belief.grid, wire);
  wire.num_run_bytes = count_of(belief.runs.size());
  wire.runs = belief.runs;
  return wire;
}

std::optional<models::CompactBelief> from_wire(const vantage_lcm::compact_belief_t& wire) {
  const auto stamp = stamp_from(wire);
  const auto viewpoint = viewpoint_from(wire);
  const auto grid = grid_from(wire);
  if (!stamp || !viewpoint || !grid || !is_text(wire.robot) || wire.step < 0 ||
      !is_count(wire.num_targets, wire.targets.size()) ||
      !is_count(wire.num_run_bytes, wire.runs.size(), kCellsMax)) {
    return std::nullopt;
  }
  models::CompactBelief belief{*stamp, wire.robot, wire.step, *viewpoint, {}, *grid, wire.runs};
  belief.targets.reserve(wire.targets.size());
  for (const vantage_lcm::compact_target_t& each : wire.targets) {
    const auto target = target_from(each);
    if (!target) {
      return std::nullopt;
    }
    belief.targets.push_back(*target);
  }
  // Refuses covariances that are not positive definite, ids that do not ascend, and runs that
  // exceed the grid.
  return models::is_valid(belief) ? std::optional(std::move(belief)) : std::nullopt;
}

}  // namespace vantage::bus
