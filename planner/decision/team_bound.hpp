#pragma once

#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// Returns an upper bound of J over all choices, computed from the gain of each candidate when
/// added to a given choice:
///   J(S') ≤ I(S ∪ S') − C(S') ≤ I(S) + Σ_i max(0, max_a I(a | S) − C(a))   for every S',
/// since I is monotone and submodular. The bound is the smaller one for S = `choice` and S = ∅. It
/// is tight if robots measure different targets or no information is left.
/// Source: Minoux 1978; Nemhauser et al. 1978, Prop. 2.1, with a modular cost. Cost: ≤ N oracle
/// calls; fewer because a candidate adds at most its individual value.
/// @throws UsageError when information is not submodular (kLogDet)
double value_bound(const TeamOracle& oracle, const Choice& choice);

}  // namespace vantage::planner
