#pragma once

#include <vector>

namespace vantage::experiments {

/// Time without an observation, in steps. It is censored if the task ended before the next
/// observation.
struct Wait {
  int steps = 0;
  bool is_ended = true;
};

/// Returns the Kaplan–Meier restricted mean of the waits, Σ S(t) over t = 0 … until − 1. S(t), the
/// share of waits longer than t, is Π_{s ≤ t} (1 − d_s / n_s) over the lengths s. d_s is the number
/// of waits that ended after s steps, and n_s the number of those that lasted s or longer. S is
/// constant beyond the longest wait. If all waits ended, the result is their mean, with each wait
/// limited to `until`. If no wait ended, or `waits` is empty, the result is `until`. Precondition:
/// all steps ≥ 1. Cost: O(n log n).
/// Source: Kaplan, Meier, 1958; Irwin, 1949.
double restricted_mean(std::vector<Wait> waits, int until);

/// Restricted means of the steps that landmarks are unobserved, up to the task's length.
struct TimeUnobserved {
  double by_landmark = 0.0;  ///< mean over landmarks of each landmark's restricted mean
  double pooled = 0.0;       ///< restricted mean of all landmarks' waits together
};

/// Computes the restricted means of WatchRun::seen, [step][landmark]. A wait begins at the start or
/// with an observation, and ends with the next observation. The wait after the last observation is
/// censored. Precondition: at least one step and one landmark.
TimeUnobserved time_unobserved(const std::vector<std::vector<char>>& seen);

}  // namespace vantage::experiments
