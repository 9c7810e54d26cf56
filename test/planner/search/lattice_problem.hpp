#pragma once

#include <cstdint>

#include "test/planner/problem/random_problem.hpp"

namespace vantage::test {

/// A robot among planar targets, of every kind that a lattice bounds, drawn by `seed`; some are
/// right on the way of some control, so that looks from a millimetre occur.
OwnedProblem lattice_problem(std::uint64_t seed);

}  // namespace vantage::test
