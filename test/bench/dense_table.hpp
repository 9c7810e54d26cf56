#pragma once

namespace vantage::bench {

/// Prints the cost of forward value iteration on the engine and on the dense reference, for each
/// number of targets, steps and obstacles. Prints to stderr, so that --benchmark_format=json stays
/// valid. Engine and reference solve the same problems one after the other. The cost is CPU time of
/// one thread: the minimum over several repetitions, averaged over the problems. The dense
/// reference has a shorter horizon where necessary; at that horizon the engine must find the same
/// cost.
void print_dense_table();

}  // namespace vantage::bench
