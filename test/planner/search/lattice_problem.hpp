#pragma once

#include <cstdint>

#include "test/planner/problem/random_problem.hpp"

namespace vantage::test {

/// Returns a robot among planar targets of every kind that a lattice bounds, drawn by `seed`. Some
/// targets are on the path of a control, so that measurements from a millimetre occur.
OwnedProblem lattice_problem(std::uint64_t seed);

}  // namespace vantage::test
