#include "models/target/kinds/kinds.hpp"

#include <array>

namespace vantage::models {

constinit const TargetKind TargetKind::kStatic(target_kinds::static_target);
constinit const TargetKind TargetKind::kRandomWalk(target_kinds::random_walk);
constinit const TargetKind TargetKind::kDoubleIntegrator(target_kinds::double_integrator);
constinit const TargetKind TargetKind::kGrowingUncertainty(target_kinds::growing_uncertainty);
constinit const TargetKind TargetKind::kDampedOscillator(target_kinds::damped_oscillator);

std::span<const TargetKind> all_target_kinds() {
  static constexpr std::array kAll{
      TargetKind(target_kinds::static_target),     TargetKind(target_kinds::random_walk),
      TargetKind(target_kinds::double_integrator), TargetKind(target_kinds::growing_uncertainty),
      TargetKind(target_kinds::damped_oscillator),
  };
  return kAll;
}

std::string_view TargetKind::name() const { return law_->name; }

}  // namespace vantage::models
