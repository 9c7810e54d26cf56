#pragma once

#include <cstdint>

#include "test/planner/problem/random_problem.hpp"

namespace vantage::test {

/// Returns a problem drawn by `seed`: a robot among planar targets of all kinds that the lattice
/// bound supports. Some targets are on the path of a control, so that measurements from 1 mm occur.
OwnedProblem lattice_problem(std::uint64_t seed);

}  // namespace vantage::test
