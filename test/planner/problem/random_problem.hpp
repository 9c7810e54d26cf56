#pragma once

#include <cstdint>
#include <random>

#include "planner/problem/owned_problem.hpp"

namespace vantage::test {

using planner::OwnedProblem;

/// A small problem drawn by `seed`: any of the five sensors or two of them, every target model in
/// every dimension, 1–6 targets, 1–5 steps, both costs; with and without a world, its distance
/// field, a demanded stop, and teammates' information. |U|^T ≤ 700: exhaustion is cheap.
OwnedProblem random_problem(std::uint64_t seed);

/// A problem whose information is Lipschitz in the pose: range or range-bearing without limits of
/// range or view, no world, every target out of reach by more than a metre.
OwnedProblem smooth_problem(std::uint64_t seed);

/// `steps` random primitives in the plane around the origin, then a stop at 2 m/s².
models::Trajectory random_teammate(std::mt19937_64& rng, Time around, int steps, double step_s);

double uniform(std::mt19937_64& rng, double low, double high);
int pick(std::mt19937_64& rng, int low, int high);  ///< both ends included
/// A damped oscillator's, of the size of a random problem; one in two with the same A on both axes.
models::Surroundings random_surroundings(std::mt19937_64& rng);
/// Makes damped oscillators of the double integrators in `problem`.
void let_oscillate(std::mt19937_64& rng, planner::SearchProblem& problem);
/// The same where `seed` is a multiple of three.
inline void let_one_in_three_oscillate(std::uint64_t seed, std::mt19937_64& rng,
                                       planner::SearchProblem& problem) {
  if (seed % 3 == 0) {
    let_oscillate(rng, problem);
  }
}
/// Symmetric positive definite n × n with eigenvalues between 10^-decades and 1, times `scale`.
Eigen::MatrixXd random_spd(std::mt19937_64& rng, int n, double scale, double decades);

}  // namespace vantage::test
