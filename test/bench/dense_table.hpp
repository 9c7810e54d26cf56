#pragma once

namespace vantage::bench {

/// Prints to stderr, so that --benchmark_format=json stays clean, for each number of targets, steps
/// and obstacles, what forward value iteration costs on the engine and on the dense reference, run
/// after one another on the same problems. CPU time of one thread, the least of several
/// repetitions, mean over problems; the dense reference looks fewer steps ahead where it must, at
/// which the engine has to find the same cost.
void print_dense_table();

}  // namespace vantage::bench
