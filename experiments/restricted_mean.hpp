#pragma once

#include <vector>

namespace vantage::experiments {

/// How long nothing was observed, in steps; cut off by the end of the task unless an observation
/// ended it.
struct Wait {
  int steps = 0;
  bool is_ended = true;
};

/// Σ S(t) over t = 0 … until − 1: Kaplan and Meier's mean of the waits, none counted beyond
/// `until`. S(t), the share of waits that last longer than t, is Π_{s ≤ t} (1 − d_s / n_s) over the
/// lengths s, d_s the waits that ended after s steps and n_s those that lasted s or longer; beyond
/// the longest wait it stays as it is. Of waits that all ended it is their mean with the longer
/// ones counted as `until`; of none that ended it is `until`, and of no waits, too. Precondition:
/// all steps ≥ 1. O(n log n). Source: Kaplan, Meier, 1958; Irwin, 1949.
double restricted_mean(std::vector<Wait> waits, int until);

/// Restricted means, up to the task's length, of the steps that landmarks go unobserved.
struct TimeUnobserved {
  double by_landmark = 0.0;  ///< the mean over landmarks of each one's own
  double pooled = 0.0;       ///< of the waits of all landmarks together
};

/// Of WatchRun::seen, [step][landmark]. A wait begins at the start or with an observation, and ends
/// with the next; the one after the last observation is cut off.
/// Precondition: at least a step and a landmark.
TimeUnobserved time_unobserved(const std::vector<std::vector<char>>& seen);

}  // namespace vantage::experiments
