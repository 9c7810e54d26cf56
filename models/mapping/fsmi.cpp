#include <algorithm>
#include <cmath>
#include <vector>

#include "models/mapping/beam_information.hpp"

namespace vantage::models {
namespace {

// Returns KL(posterior ‖ prior) of a cell when its odds are multiplied by `ratio`, nats.
double kl_divergence_nats(double occupancy, double log_ratio, double ratio) {
  const double o = occupancy;
  if (o <= 0.0 || o >= 1.0) {
    return 0.0;
  }
  const double posterior = o * ratio / (1.0 - o + o * ratio);
  return posterior * log_ratio - std::log1p(o * (ratio - 1.0));
}

double normal_cdf(double x) { return 0.5 * std::erfc(-x * 0.70710678118654752440); }

// Returns ∫ C(z) N(z; mean, σ²) dz over the z within the cutoff. C is a step function:
// `information_nats[k]` from begin_m[k] on, and 0 before begin_m[0].
double expected_nats(const std::vector<double>& begin_m,
                     const std::vector<double>& information_nats, double mean_m, double sigma_m,
                     double cutoff_sigmas, std::size_t& first) {
  const double cutoff_m = cutoff_sigmas * sigma_m;
  while (first + 1 < begin_m.size() && begin_m[first + 1] <= mean_m - cutoff_m) {
    ++first;
  }
  double sum_nats = 0.0;
  double below = normal_cdf((begin_m[first] - mean_m) / sigma_m);
  for (std::size_t k = first; k < begin_m.size() && begin_m[k] < mean_m + cutoff_m; ++k) {
    const double above =
        k + 1 == begin_m.size() ? 1.0 : normal_cdf((begin_m[k + 1] - mean_m) / sigma_m);
    sum_nats += information_nats[k] * (above - below);
    below = above;
  }
  return sum_nats;
}

}  // namespace

BeamInformation fsmi(const BeamProfile& beam, const BeamSensor& sensor,
                     const InverseBeamModel& inverse, double cutoff_sigmas) {
  if (beam.size() == 0) {
    return {};
  }
  thread_local std::vector<double> begin_m;
  thread_local std::vector<double> information_nats;
  begin_m.assign(beam.enter_m.begin(), beam.enter_m.end());
  begin_m.push_back(beam.exit_m.back());
  for (double& edge_m : begin_m) {
    edge_m = std::min(edge_m, sensor.no_hit_range_m());
  }
  information_nats.clear();
  const double hit_ratio = std::exp(inverse.hit_log_odds);
  const double miss_ratio = std::exp(inverse.miss_log_odds);
  double misses_nats = 0.0;
  double max_nats = 0.0;
  for (const double o : beam.occupancy) {
    information_nats.push_back(misses_nats +
                               kl_divergence_nats(o, inverse.hit_log_odds, hit_ratio));
    max_nats = std::max(max_nats, information_nats.back());
    misses_nats += kl_divergence_nats(o, inverse.miss_log_odds, miss_ratio);
  }
  information_nats.push_back(misses_nats);
  max_nats = std::max(max_nats, misses_nats);

  double sum_nats = 0.0;
  double reach = 1.0;
  std::size_t first = 0;  // means ascend, so this index never decreases
  for (std::size_t j = 0; j < beam.occupancy.size(); ++j) {
    const double o = beam.occupancy[j];
    if (reach * o > 0.0) {
      const double mean_m = sensor.mean_range_m(0.5 * (beam.enter_m[j] + beam.exit_m[j]));
      sum_nats +=
          reach * o *
          expected_nats(begin_m, information_nats, mean_m, sensor.sigma_m, cutoff_sigmas, first);
    }
    reach *= 1.0 - o;
  }
  if (reach > 0.0) {
    sum_nats += reach * expected_nats(begin_m, information_nats, sensor.range_max_m, sensor.sigma_m,
                                      cutoff_sigmas, first);
  }
  return {sum_nats, max_nats * 2.0 * normal_cdf(-cutoff_sigmas)};
}

}  // namespace vantage::models
