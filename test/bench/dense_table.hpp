#pragma once

namespace vantage::bench {

/// Prints the cost of forward value iteration on the engine and on the dense reference, for each
/// number of targets, steps and obstacles. Prints to stderr, so that --benchmark_format=json stays
/// clean. Both run one after the other on the same problems. CPU time of one thread, the least of
/// several repetitions, mean over problems. The dense reference has a shorter horizon where
/// necessary; there the engine must find the same cost.
void print_dense_table();

}  // namespace vantage::bench
