#include "estimator/tracks/labelled/mixture.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include <Eigen/Cholesky>

#include "core/index.hpp"

namespace vantage::estimator {
namespace {

double distance2(const Component& from, const models::StateVector& to) {
  const models::StateVector off = to - from.belief.mean;
  return off.dot(from.belief.covariance.llt().solve(off));
}

/// Merges `other` into `one`; the result has the moments of the two together.
void merge(Component& one, const Component& other) {
  const double weight = one.weight + other.weight;
  const double share = other.weight / weight;
  const models::StateVector off = other.belief.mean - one.belief.mean;
  one.belief.covariance = ((1.0 - share) * one.belief.covariance + share * other.belief.covariance +
                           (share * (1.0 - share)) * off * off.transpose())
                              .eval();
  one.belief.mean += share * off;
  one.weight = weight;
}

bool is_heavier(const Component& a, const Component& b) { return a.weight > b.weight; }

}  // namespace

models::Gaussian moments(const Mixture& mixture) {
  Component sum = mixture.front();
  for (std::size_t i = 1; i < mixture.size(); ++i) {
    if (mixture[i].weight > 0.0) {
      merge(sum, mixture[i]);
    }
  }
  return sum.belief;
}

void reduce(Mixture& mixture, int count, double merge_sigma, double weight_min) {
  double total = 0.0;
  double heaviest = 0.0;
  for (const Component& component : mixture) {
    total += component.weight;
    heaviest = std::max(heaviest, component.weight);
  }
  const double least = std::min(heaviest, weight_min * total);
  std::erase_if(mixture, [&](const Component& c) { return c.weight < least; });
  std::sort(mixture.begin(), mixture.end(), is_heavier);
  for (std::size_t i = 0; i < mixture.size(); ++i) {
    const Component seed = mixture[i];
    for (std::size_t j = i + 1; j < mixture.size();) {
      if (distance2(seed, mixture[j].belief.mean) > merge_sigma * merge_sigma) {
        ++j;
        continue;
      }
      merge(mixture[i], mixture[j]);
      mixture.erase(mixture.begin() + static_cast<std::ptrdiff_t>(j));
    }
  }
  while (mixture.size() > index(count)) {
    const Component last = mixture.back();
    mixture.pop_back();
    const auto nearest =
        std::min_element(mixture.begin(), mixture.end(), [&](const auto& a, const auto& b) {
          return distance2(a, last.belief.mean) < distance2(b, last.belief.mean);
        });
    merge(*nearest, last);
  }
  std::sort(mixture.begin(), mixture.end(), is_heavier);
  double kept = 0.0;
  for (const Component& component : mixture) {
    kept += component.weight;
  }
  for (Component& component : mixture) {
    component.weight *= total / kept;
  }
}

}  // namespace vantage::estimator
