#include <algorithm>
#include <cmath>
#include <vector>

#include "models/mapping/beam_information.hpp"

namespace vantage::models {
namespace {

// The events of a beam, ordered by range; the last one is "nothing hit".
struct Event {
  double range_m = 0.0;
  double p = 0.0;
  double w = 0.0;
};

void list_events(const BeamProfile& beam, const BeamSensor& sensor, std::vector<Event>& events) {
  events.clear();
  double reach = 1.0;          // probability that no earlier cell is occupied
  double squared_reach = 1.0;  // the same probability as `reach`, but with squared odds
  for (std::size_t j = 0; j < beam.occupancy.size(); ++j) {
    const double o = beam.occupancy[j];
    const double q = o * o / (o * o + (1.0 - o) * (1.0 - o));
    events.push_back({sensor.mean_range_m(0.5 * (beam.enter_m[j] + beam.exit_m[j])), reach * o,
                      squared_reach * q});
    reach *= 1.0 - o;
    squared_reach *= 1.0 - q;
  }
  events.push_back({sensor.range_max_m, reach, squared_reach});
}

}  // namespace

BeamInformation csqmi(const BeamProfile& beam, const BeamSensor& sensor, double cutoff_sigmas) {
  thread_local std::vector<Event> events;
  list_events(beam, sensor, events);
  const double cutoff_m = cutoff_sigmas * sensor.sigma_m;
  const double exponent = -0.25 / (sensor.sigma_m * sensor.sigma_m);
  double pKp = 0.0;
  double pKw = 0.0;
  bool dropped = false;
  for (std::size_t l = 0; l < events.size(); ++l) {
    const Event& far = events[l];
    pKp += far.p * far.p;
    pKw += far.p * far.w;
    for (std::size_t j = l; j-- > 0;) {
      const Event& near = events[j];
      const double gap_m = far.range_m - near.range_m;
      if (gap_m > cutoff_m) {
        dropped = true;
        break;
      }
      const double K = std::exp(exponent * gap_m * gap_m);
      pKp += 2.0 * K * far.p * near.p;
      pKw += K * (far.p * near.w + near.p * far.w);
    }
  }
  // The neglected part of each sum is at most ε, because the probabilities sum to 1.
  const double epsilon = dropped ? std::exp(-0.25 * cutoff_sigmas * cutoff_sigmas) : 0.0;
  return {std::max(0.0, std::log(pKp) - 2.0 * std::log(pKw)),
          std::max(std::log1p(epsilon / pKp), 2.0 * std::log1p(epsilon / pKw))};
}

}  // namespace vantage::models
