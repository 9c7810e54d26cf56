#pragma once

#include "models/mapping/beam.hpp"

namespace vantage::models {

/// Information of one beam and by how much that number may be off.
struct BeamInformation {
  double nats = 0.0;
  double error_nats = 0.0;  ///< |nats − the exact value| is at most this (and rounding)
};

/// How far from each other two Gaussians may be before their overlap counts as none, in σ.
/// At 10 σ what is dropped of a product of two of them is e^−25 of its peak.
inline constexpr double kCutoffSigmas = 10.0;

/// Cauchy–Schwarz quadratic mutual information between the map and one reading z of the beam:
///
///   I = log Σ_m ∫ p(m,z)² dz + log Σ_m ∫ p(m)² p(z)² dz − 2 log Σ_m ∫ p(m,z) p(m) p(z) dz
///     = log [ pᵀKp / (pᵀK w)² ],   K_jl = exp(−(μ_j − μ_l)² / 4σ²)
///
/// over the events e_j "the first occupied cell is j" and e_0 "none is", with p their
/// probabilities, w their probabilities when every cell's odds are squared, μ_j the mean reading at
/// the middle of cell j and μ_0 = range_max. This is the form of Charrow et al. with every sum
/// divided by Π_i (o_i² + (1 − o_i)²), which underflows on long beams and cancels.
///
/// ≥ 0; 0 when every cell is certain. Pairs of events farther apart than `cutoff_sigmas` σ are
/// dropped, and error_nats says what that may have cost; the time is linear in the cells (times the
/// cells in that window). No allocation after the first call of a thread with the longest beam.
/// Source: Charrow et al., Information-theoretic mapping using CSQMI (ICRA 2015), eq. 10–15.
BeamInformation csqmi(const BeamProfile& beam, const BeamSensor& sensor,
                      double cutoff_sigmas = kCutoffSigmas);

/// The odds ratios by which a look changes a cell: × `hit` where the beam ended, × `miss` before.
struct InverseBeamModel {
  double hit_log_odds = 2.944;    ///< log(0.95 / 0.05)
  double miss_log_odds = -2.944;  ///< −the same
};

/// Fast Shannon mutual information: the expected sum over the cells of the Kullback–Leibler
/// divergence of what is believed after the reading from what is believed now, when the belief is
/// changed by `inverse` and z is distributed as in csqmi():
///
///   I = Σ_j p(e_j) Σ_k C_k ∫_{cell k} N(z; μ_j, σ²) dz
///   C_k = f(hit, o_k) + Σ_{i<k} f(miss, o_i),   f(l, o) = KL( σ(logit o + l) ‖ o )
///
/// A reading from no_hit_range_m() on, or beyond the last cell, is a miss of all; one before the
/// first cell says nothing. With
/// strong odds and little noise this is Shannon's mutual information. ≥ 0. Cost and error as for
/// csqmi(). Source: Zhang et al., FSMI (ICRA 2019, IJRR 2020), Theorem 1 and the truncation of
/// section IV-B.
BeamInformation fsmi(const BeamProfile& beam, const BeamSensor& sensor,
                     const InverseBeamModel& inverse, double cutoff_sigmas = kCutoffSigmas);

}  // namespace vantage::models
