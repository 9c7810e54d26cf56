#pragma once

#include "models/mapping/beam.hpp"

namespace vantage::models {

/// Information of one beam, with an error bound.
struct BeamInformation {
  double nats = 0.0;
  double error_nats = 0.0;  ///< upper bound of |nats − exact value|, apart from rounding
};

/// Distance between two Gaussians, in σ, beyond which their overlap counts as zero. At 10 σ, the
/// neglected product of two such Gaussians is at most e^−25 of its peak.
inline constexpr double kCutoffSigmas = 10.0;

/// Returns the Cauchy–Schwarz quadratic mutual information between the map and one reading z of the
/// beam:
///
///   I = log Σ_m ∫ p(m,z)² dz + log Σ_m ∫ p(m)² p(z)² dz − 2 log Σ_m ∫ p(m,z) p(m) p(z) dz
///     = log [ pᵀKp / (pᵀK w)² ],   K_jl = exp(−(μ_j − μ_l)² / 4σ²)
///
/// over the events e_j "the first occupied cell is j" and e_0 "no cell is occupied". p are their
/// probabilities, and w their probabilities when every cell's odds are squared. μ_j is the mean
/// reading at the middle of cell j, and μ_0 = range_max. This is the form of Charrow et al. with
/// every sum divided by Π_i (o_i² + (1 − o_i)²). The factor cancels in I. Without this division the
/// sums would underflow on long beams.
///
/// ≥ 0; 0 when every cell is certain. Pairs of events farther apart than `cutoff_sigmas` σ are
/// neglected; error_nats bounds the effect. Cost: cells of the beam × cells within the cutoff. A
/// thread allocates only for a beam longer than all its earlier beams.
/// Source: Charrow et al., Information-theoretic mapping using CSQMI (ICRA 2015), eq. 10–15.
BeamInformation csqmi(const BeamProfile& beam, const BeamSensor& sensor,
                      double cutoff_sigmas = kCutoffSigmas);

/// Changes of a cell's log-odds by a scan: `hit` in the cell where the beam ended, `miss` in the
/// cells before it.
struct InverseBeamModel {
  double hit_log_odds = 2.944;    ///< log(0.95 / 0.05)
  double miss_log_odds = -2.944;  ///< log(0.05 / 0.95)
};

/// Returns the fast Shannon mutual information: the expected sum over the cells of the
/// Kullback–Leibler divergence of the belief after the reading from the belief before it. The
/// belief is updated by `inverse`, and z is distributed as in csqmi():
///
///   I = Σ_j p(e_j) Σ_k C_k ∫_{cell k} N(z; μ_j, σ²) dz
///   C_k = f(hit, o_k) + Σ_{i<k} f(miss, o_i),   f(l, o) = KL( σ(logit o + l) ‖ o )
///
/// A reading ≥ no_hit_range_m(), or beyond the last cell, is a miss of all cells. A reading before
/// the first cell gives no information. With large log-odds and little noise, I approaches
/// Shannon's mutual information. ≥ 0. Cost and error as for csqmi(). Source: Zhang et al., FSMI
/// (ICRA 2019, IJRR 2020), Theorem 1 and the truncation of section IV-B.
BeamInformation fsmi(const BeamProfile& beam, const BeamSensor& sensor,
                     const InverseBeamModel& inverse, double cutoff_sigmas = kCutoffSigmas);

}  // namespace vantage::models
