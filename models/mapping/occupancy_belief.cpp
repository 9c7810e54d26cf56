#include "models/mapping/occupancy_belief.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"

namespace vantage::models {

double probability_of(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

double log_odds_of(double probability) { return std::log(probability / (1.0 - probability)); }

double binary_entropy_nats(double probability) {
  const double p = probability;
  return p <= 0.0 || p >= 1.0 ? 0.0 : -p * std::log(p) - (1.0 - p) * std::log1p(-p);
}

OccupancyBelief::OccupancyBelief(const GridGeometry& geometry, double clamp_log_odds)
    : geometry_(geometry),
      clamp_log_odds_(clamp_log_odds),
      log_odds_(index(geometry.size()), 0.0),
      occupancy_(index(geometry.size()), 0.5) {
  require(clamp_log_odds > 0.0, "the clamp of the log-odds must be > 0");
}

void OccupancyBelief::add_log_odds(int cell, double delta) {
  const double sum = std::clamp(log_odds_[index(cell)] + delta, -clamp_log_odds_, clamp_log_odds_);
  log_odds_[index(cell)] = sum;
  occupancy_[index(cell)] = sum >= clamp_log_odds_    ? 1.0
                            : sum <= -clamp_log_odds_ ? 0.0
                                                      : probability_of(sum);
}

double OccupancyBelief::entropy_nats(int cell) const {
  return binary_entropy_nats(probability_of(log_odds(cell)));
}

double OccupancyBelief::entropy_nats() const {
  double sum_nats = 0.0;
  for (int cell = 0; cell < geometry_.size(); ++cell) {
    sum_nats += entropy_nats(cell);
  }
  return sum_nats;
}

}  // namespace vantage::models
