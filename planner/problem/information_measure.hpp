#pragma once

namespace vantage::planner {

/// How the information that a team's looks give is measured. Both are 0 without a look, never
/// fall when a trajectory is added, and are in nats.
enum class InformationMeasure {
  /// I(y_{1:T}; z_{1:T}) = ½ Σ_t (log det Σᵖ_t − log det Σ_t), Σᵖ_t predicted with all looks
  /// before t. Submodular: every guarantee of planner/decision is for it.
  kMutual,
  /// ½ Σ_t (log det Σ⁰_t − log det Σ_t), Σ⁰_t without any look: the sum of I(y_t; z_{1:t}). What
  /// single-robot searches maximise. Not submodular when targets move.
  kLogDet,
};

}  // namespace vantage::planner
