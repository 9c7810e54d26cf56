#include <cmath>

#include "bus/convert/convert_parts.hpp"

// Non-Gaussian beliefs of robots: MIXTURE_R.

namespace vantage::bus {

using namespace parts;  // NOLINT(google-build-using-namespace): names of the converters

namespace {

constexpr double kWeightSumErrorMax = 1e-6;

bool is_probability(double p) { return p > 0.0 && p <= 1.0; }  // false for NaN

std::optional<models::Component> component_from(const vantage_lcm::mixture_component_t& wire) {
  const bool has_shape = wire.dim >= models::kMinTargetDim && wire.dim <= models::kMaxTargetDim &&
                         is_count(wire.dim, wire.mean.size());
  const auto covariance = has_shape ? definite_from(wire.covariance, wire.dim) : std::nullopt;
  if (!is_probability(wire.weight) || !covariance) {
    return std::nullopt;
  }
  models::Component component;
  component.weight = wire.weight;
  component.belief.mean = Eigen::Map<const Eigen::VectorXd>(wire.mean.data(), wire.dim);
  component.belief.covariance = *covariance;
  if (!component.belief.mean.allFinite()) {
    return std::nullopt;
  }
  return component;
}

std::optional<models::TargetMixture> target_from(const vantage_lcm::target_mixture_t& wire) {
  if (wire.target_id < 0 || !is_probability(wire.existence) ||
      !is_count(wire.num_components, wire.components.size()) || wire.components.empty()) {
    return std::nullopt;
  }
  models::TargetMixture target{wire.target_id, wire.existence, {}};
  double sum = 0.0;
  for (const vantage_lcm::mixture_component_t& each : wire.components) {
    const auto component = component_from(each);
    if (!component || each.dim != wire.components.front().dim) {
      return std::nullopt;
    }
    sum += component->weight;
    target.components.push_back(*component);
  }
  return std::abs(sum - 1.0) <= kWeightSumErrorMax ? std::optional(std::move(target))
                                                   : std::nullopt;
}

vantage_lcm::target_mixture_t target_to(const models::TargetMixture& target) {
  vantage_lcm::target_mixture_t wire{};
  wire.target_id = target.target_id;
  wire.existence = target.existence;
  wire.num_components = count_of(target.components.size());
  for (const models::Component& component : target.components) {
    vantage_lcm::mixture_component_t& each = wire.components.emplace_back();
    const models::StateVector& mean = component.belief.mean;
    each.weight = component.weight;
    each.dim = static_cast<int>(mean.size());
    each.mean.assign(mean.data(), mean.data() + mean.size());
    each.covariance = rows_to(component.belief.covariance, each.dim);
  }
  return wire;
}

}  // namespace

vantage_lcm::mixture_t to_wire(const models::BeliefMixture& mixture) {
  auto wire = stamped<vantage_lcm::mixture_t>(mixture.stamp);
  wire.robot = mixture.robot;
  wire.step = mixture.step;
  wire.num_targets = count_of(mixture.targets.size());
  for (const models::TargetMixture& target : mixture.targets) {
    wire.targets.push_back(target_to(target));
  }
  return wire;
}

std::optional<models::BeliefMixture> from_wire(const vantage_lcm::mixture_t& wire) {
  const auto stamp = stamp_from(wire);
  if (!stamp || !is_text(wire.robot) || wire.step < 0 ||
      !is_count(wire.num_targets, wire.targets.size())) {
    return std::nullopt;
  }
  models::BeliefMixture mixture{*stamp, wire.robot, wire.step, {}};
  int previous_id = -1;
  for (const vantage_lcm::target_mixture_t& each : wire.targets) {
    auto target = target_from(each);
    if (!target || target->target_id <= previous_id) {
      return std::nullopt;  // receivers rely on ascending ids
    }
    previous_id = target->target_id;
    mixture.targets.push_back(std::move(*target));
  }
  return mixture;
}

}  // namespace vantage::bus
