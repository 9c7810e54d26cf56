#pragma once

#include "models/belief/mixture.hpp"

namespace vantage::estimator {

using models::Component;
using models::Mixture;

/// Returns mean and covariance of the mixture; weights are normalised.
/// Precondition: not empty, of positive weight.
models::Gaussian moments(const Mixture& mixture);

/// Reduces the mixture to at most `count` components, heaviest first. The sum of the weights does
/// not change. Components of less than `weight_min` of the sum are dropped first, except the
/// heaviest. Then each component, starting with the heaviest, is merged with the components that
/// have a mean within `merge_sigma` of its mean, by its covariance. Components beyond `count` are
/// merged into the nearest remaining component, so no weight is lost. A merged component has the
/// moments of its parts. Allocates nothing.
/// Cost: O(n²) distances.
/// Source: Vo, Ma, The Gaussian mixture probability hypothesis density filter (2006), table II;
/// unlike there, no weight is lost.
void reduce(Mixture& mixture, int count, double merge_sigma, double weight_min);

}  // namespace vantage::estimator
