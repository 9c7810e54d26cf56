#pragma once

#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// How good any choice can be at most, told by what each candidate would still add to a given one:
///   J(S') ≤ I(S ∪ S') − C(S') ≤ I(S) + Σ_i max(0, max_a I(a | S) − C(a))   for every S',
/// since I is monotone and submodular; the lesser of this for S = `choice` and for S = ∅. Tight
/// where robots look at different targets or nothing is left to see.
/// Source: Minoux 1978; Nemhauser et al. 1978, Prop. 2.1, with a modular cost. Cost: ≤ N oracle
/// calls, fewer since a candidate adds at most what it is worth alone.
/// @throws UsageError when information is not submodular (kLogDet)
double value_bound(const TeamOracle& oracle, const Choice& choice);

}  // namespace vantage::planner
