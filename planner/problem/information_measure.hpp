#pragma once

namespace vantage::planner {

/// Measure of the information that a team's measurements give, nats. Both measures are 0 without
/// measurements and never decrease when a trajectory is added.
enum class InformationMeasure {
  /// I(y_{1:T}; z_{1:T}) = ½ Σ_t (log det Σᵖ_t − log det Σ_t), with Σᵖ_t predicted from all
  /// measurements before t. Submodular: all guarantees of planner/decision hold for this measure.
  kMutual,
  /// ½ Σ_t (log det Σ⁰_t − log det Σ_t), with Σ⁰_t predicted without any measurement: the sum of
  /// I(y_t; z_{1:t}). Single-robot searches maximise it. Not submodular when targets move.
  kLogDet,
};

}  // namespace vantage::planner
