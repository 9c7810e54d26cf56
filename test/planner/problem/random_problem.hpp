#pragma once

#include <cstdint>
#include <random>

#include "planner/problem/owned_problem.hpp"

namespace vantage::test {

using planner::OwnedProblem;

/// Returns a small problem drawn by `seed`, with one or two of the five sensor kinds, all target
/// models in all dimensions, 1–6 targets, 1–5 steps and either cost. World, distance field,
/// required stop and teammates' information are optional. |U|^T ≤ 700, so that exhaustive search is
/// cheap.
OwnedProblem random_problem(std::uint64_t seed);

/// Returns a problem in which information is Lipschitz in the pose: range or range-bearing sensors
/// without limits of range or view, no world, and all targets out of reach by more than a metre.
OwnedProblem smooth_problem(std::uint64_t seed);

/// Returns a motion of `steps` random primitives in the plane around the origin, followed by a stop
/// at 2 m/s².
models::Trajectory random_teammate(std::mt19937_64& rng, Time around, int steps, double step_s);

double uniform(std::mt19937_64& rng, double low, double high);
int pick(std::mt19937_64& rng, int low, int high);  ///< includes both limits
/// Returns a point with coordinates in [low, high). Equal for all compilers, which evaluate the
/// arguments of a call in different orders.
Eigen::Vector2d random_point(std::mt19937_64& rng, double low, double high);
/// Returns the parameters of a damped oscillator. Every second one has the same A on both axes.
models::DampedOscillator random_oscillator(std::mt19937_64& rng);
/// Turns the double integrators of `problem` into damped oscillators.
void let_oscillate(std::mt19937_64& rng, planner::SearchProblem& problem);
/// Calls let_oscillate() if `seed` is a multiple of three.
inline void let_one_in_three_oscillate(std::uint64_t seed, std::mt19937_64& rng,
                                       planner::SearchProblem& problem) {
  if (seed % 3 == 0) {
    let_oscillate(rng, problem);
  }
}
/// Adds a terminal value to `problem`: a tour of most of its targets, in random order, with stops
/// at random positions and straight travel.
void add_random_tour(std::mt19937_64& rng, planner::SearchProblem& problem);
/// Returns a symmetric positive definite n × n matrix with eigenvalues between 10^-decades and 1,
/// times `scale`.
Eigen::MatrixXd random_spd(std::mt19937_64& rng, int n, double scale, double decades);

}  // namespace vantage::test
