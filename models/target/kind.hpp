#pragma once

#include <span>
#include <string_view>

namespace vantage::models {

struct TargetLaw;

/// A kind of target model: a pointer to its motion model (TargetLaw). Two kinds are equal if they
/// point to the same model.
/// User-defined kinds are made from a TargetLaw, which must outlive them.
class TargetKind {
 public:
  constexpr explicit TargetKind(const TargetLaw& law) : law_(&law) {}
  [[nodiscard]] constexpr const TargetLaw& law() const { return *law_; }
  /// Returns the name used in scenarios, such as "double_integrator".
  [[nodiscard]] std::string_view name() const;

  friend constexpr bool operator==(TargetKind a, TargetKind b) { return a.law_ == b.law_; }

  static const TargetKind kStatic;              ///< y' = y
  static const TargetKind kRandomWalk;          ///< y' = y + w, W = qτ I
  static const TargetKind kDoubleIntegrator;    ///< white acceleration of density q
  static const TargetKind kGrowingUncertainty;  ///< noise grows while the target is not seen
  static const TargetKind kDampedOscillator;    ///< confined to an area

 private:
  const TargetLaw* law_;
};

/// Returns all kinds that scenarios may name, in display order. A new kind needs a file in
/// models/target/kinds and a line in kinds.cpp.
std::span<const TargetKind> all_target_kinds();

}  // namespace vantage::models
