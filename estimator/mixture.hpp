#pragma once

#include "models/belief/mixture.hpp"

namespace vantage::estimator {

using models::Component;
using models::Mixture;

/// Returns mean and covariance of the mixture; weights are normalised.
/// Precondition: not empty, of positive weight.
models::Gaussian moments(const Mixture& mixture);

/// Reduces the mixture to at most `count` components, heaviest first; the sum of the weights is
/// kept. Components of less than `weight_min` of the sum are dropped first, except the heaviest.
/// Then each component, from the heaviest on, is merged with those that have means within
/// `merge_sigma` of its own, by its own covariance. Components beyond `count` are merged into their
/// nearest one, so no weight is lost. A merged component has the moments of its parts. Allocates
/// nothing.
/// Cost: O(n²) distances.
/// Source: Vo, Ma, The Gaussian mixture probability hypothesis density filter (2006), table II;
/// without its loss of weight.
void reduce(Mixture& mixture, int count, double merge_sigma, double weight_min);

}  // namespace vantage::estimator
