#pragma once

#include "models/belief/mixture.hpp"

namespace vantage::estimator {

using models::Component;
using models::Mixture;

/// Mean and covariance of the whole; weights are taken by their share of the sum. Precondition: not
/// empty, of positive weight.
models::Gaussian moments(const Mixture& mixture);

/// Leaves at most `count` components, heaviest first, of weights that add up to what they were.
/// Beginning with the heaviest, each takes up those whose means are within `merge_sigma` of its own
/// by its own covariance, and becomes the Gaussian of their moments; what is left beyond `count`
/// goes the same way to its nearest, so that no weight is lost. Components of less than
/// `weight_min` of the sum are dropped first (the heaviest never).
/// Allocates nothing. Cost: O(n²) distances.
/// Source: Vo, Ma, The Gaussian mixture probability hypothesis density filter (2006), table II;
/// without its loss of weight.
void reduce(Mixture& mixture, int count, double merge_sigma, double weight_min);

}  // namespace vantage::estimator
