#include "estimator/tracks/labelled/association.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::estimator {
namespace {

/// Cost of an impossible pair: e^−1e5 is 0 compared with any odds.
constexpr double kForbidden = 1e5;
constexpr int kRoundsMax = 200;
constexpr double kSettled = 1e-9;

}  // namespace

Association::Association(int tracks_max, int detections_max)
    : solver_(tracks_max, tracks_max + detections_max) {
  const std::size_t tracks = index(tracks_max);
  const std::size_t detections = index(detections_max);
  odds_.reserve(tracks * detections);
  probabilities_.reserve(tracks * detections);
  is_grouped_.reserve(tracks);
  is_in_group_.reserve(detections);
  group_tracks_.reserve(tracks);
  group_detections_.reserve(detections);
  const std::size_t subsets = std::size_t{1}
                              << index(std::min({kExactMax, tracks_max, detections_max}));
  forward_.reserve(std::max((std::max(tracks, detections) + 1) * subsets, tracks * detections));
  backward_.reserve(std::max(2 * subsets, tracks * detections));
  cost_.reserve(tracks * (tracks + detections));
  best_.reserve(tracks);
}

void Association::start(int tracks, int detections) {
  tracks_ = tracks;
  detections_ = detections;
  odds_.assign(index(tracks) * index(detections), 0.0);
  probabilities_.assign(odds_.size(), 0.0);
}

std::span<const int> Association::best() {
  const int columns = detections_ + tracks_;  // each track has a column for being missed
  cost_.assign(index(tracks_) * index(columns), 0.0);
  for (int i = 0; i < tracks_; ++i) {
    for (int j = 0; j < detections_; ++j) {
      cost_[index(i) * index(columns) + index(j)] =
          odds(i, j) > 0.0 ? std::min(kForbidden, -std::log(odds(i, j))) : kForbidden;
    }
  }
  const std::span<const int> column = solver_.solve(cost_, tracks_, columns);
  best_.assign(column.begin(), column.end());
  for (int& of : best_) {
    of = of < detections_ ? of : -1;
  }
  return best_;
}

void Association::solve() {
  std::fill(probabilities_.begin(), probabilities_.end(), 0.0);
  is_grouped_.assign(index(tracks_), 0);
  for (int i = 0; i < tracks_; ++i) {
    if (is_grouped_[index(i)] != 0) {
      continue;
    }
    gather_group(i);
    if (group_detections_.empty()) {
      continue;
    }
    has_tracks_as_rows_ = group_tracks_.size() >= group_detections_.size();
    if (std::min(group_tracks_.size(), group_detections_.size()) <= index(kExactMax)) {
      solve_exactly();
    } else {
      solve_by_messages();
    }
  }
}

void Association::gather_group(int first_track) {
  group_tracks_.assign(1, first_track);
  group_detections_.clear();
  is_grouped_[index(first_track)] = 1;
  is_in_group_.assign(index(detections_), 0);
  for (std::size_t next = 0; next < group_tracks_.size(); ++next) {
    for (int j = 0; j < detections_; ++j) {
      if (is_in_group_[index(j)] != 0 || !(odds(group_tracks_[next], j) > 0.0)) {
        continue;
      }
      is_in_group_[index(j)] = 1;
      group_detections_.push_back(j);
      for (int i = 0; i < tracks_; ++i) {
        if (is_grouped_[index(i)] == 0 && odds(i, j) > 0.0) {
          is_grouped_[index(i)] = 1;
          group_tracks_.push_back(i);
        }
      }
    }
  }
}

double Association::group_odds(int row, int column) const {
  return has_tracks_as_rows_ ? odds(group_tracks_[index(row)], group_detections_[index(column)])
                             : odds(group_tracks_[index(column)], group_detections_[index(row)]);
}

void Association::set_group_probability(int row, int column, double probability) {
  const int track = group_tracks_[index(has_tracks_as_rows_ ? row : column)];
  const int detection = group_detections_[index(has_tracks_as_rows_ ? column : row)];
  probabilities_[at(track, detection)] = probability;
}

// F_r(S): sum over all assignments of the rows before r that use exactly the columns S. B_r(S): sum
// over all assignments of the rows from r on, when the columns S are already used. β_rc = odds_rc
// Σ_{S ∌ c} F_r(S) B_{r+1}(S ∪ c) / F(all).
void Association::solve_exactly() {
  const int rows = static_cast<int>(std::max(group_tracks_.size(), group_detections_.size()));
  const int columns = static_cast<int>(std::min(group_tracks_.size(), group_detections_.size()));
  const std::size_t subsets = std::size_t{1} << index(columns);
  const auto bit = [](int c) { return std::size_t{1} << index(c); };
  // Each row is divided by its sum; otherwise large odds of many rows would overflow.
  const auto share_of = [&](int r) {
    double sum = 1.0;
    for (int c = 0; c < columns; ++c) {
      sum += group_odds(r, c);
    }
    return 1.0 / sum;
  };
  forward_.assign(index(rows + 1) * subsets, 0.0);
  forward_[0] = 1.0;
  for (int r = 0; r < rows; ++r) {
    const double* const before = &forward_[index(r) * subsets];
    double* const after = &forward_[index(r + 1) * subsets];
    const double share = share_of(r);
    for (std::size_t S = 0; S < subsets; ++S) {
      after[S] += share * before[S];
    }
    for (int c = 0; c < columns; ++c) {
      const double weight = share * group_odds(r, c);
      for (std::size_t S = 0; weight > 0.0 && S < subsets; ++S) {
        if ((S & bit(c)) == 0) {
          after[S | bit(c)] += weight * before[S];
        }
      }
    }
  }
  double total = 0.0;
  for (std::size_t S = 0; S < subsets; ++S) {
    total += forward_[index(rows) * subsets + S];
  }
  backward_.assign(2 * subsets, 1.0);
  double* later = backward_.data();
  double* here = later + subsets;
  for (int r = rows - 1; r >= 0; --r) {
    const double* const before = &forward_[index(r) * subsets];
    const double share = share_of(r);
    for (std::size_t S = 0; S < subsets; ++S) {
      here[S] = share * later[S];
    }
    for (int c = 0; c < columns; ++c) {
      const double weight = share * group_odds(r, c);
      double with = 0.0;
      for (std::size_t S = 0; weight > 0.0 && S < subsets; ++S) {
        if ((S & bit(c)) == 0) {
          with += before[S] * later[S | bit(c)];
          here[S] += weight * later[S | bit(c)];
        }
      }
      set_group_probability(r, c, weight * with / total);
    }
    std::swap(here, later);
  }
}

// Source: Williams, Lau, Approximate evaluation of marginal association probabilities with belief
// propagation (2014).
void Association::solve_by_messages() {
  const std::size_t m = group_detections_.size();
  forward_.assign(group_tracks_.size() * m, 1.0);   // messages to track i from detection j
  backward_.assign(group_tracks_.size() * m, 0.0);  // messages to detection j from track i
  const auto v = [&](std::size_t i, std::size_t j) {
    return odds(group_tracks_[i], group_detections_[j]);
  };
  double change = 1.0;
  for (int round = 0; round < kRoundsMax && change > kSettled; ++round) {
    for (std::size_t i = 0; i < group_tracks_.size(); ++i) {
      double sum = 1.0;
      for (std::size_t j = 0; j < m; ++j) {
        sum += v(i, j) * forward_[i * m + j];
      }
      for (std::size_t j = 0; j < m; ++j) {
        backward_[i * m + j] = v(i, j) / (sum - v(i, j) * forward_[i * m + j]);
      }
    }
    change = 0.0;
    for (std::size_t j = 0; j < m; ++j) {
      double sum = 1.0;
      for (std::size_t i = 0; i < group_tracks_.size(); ++i) {
        sum += backward_[i * m + j];
      }
      for (std::size_t i = 0; i < group_tracks_.size(); ++i) {
        const double message = 1.0 / (sum - backward_[i * m + j]);
        change = std::max(change, std::abs(message - forward_[i * m + j]));
        forward_[i * m + j] = message;
      }
    }
  }
  for (std::size_t i = 0; i < group_tracks_.size(); ++i) {
    double sum = 1.0;
    for (std::size_t j = 0; j < m; ++j) {
      sum += v(i, j) * forward_[i * m + j];
    }
    for (std::size_t j = 0; j < m; ++j) {
      probabilities_[at(group_tracks_[i], group_detections_[j])] =
          v(i, j) * forward_[i * m + j] / sum;
    }
  }
}

double Association::miss_probability(int track) const {
  double seen = 0.0;
  for (int j = 0; j < detections_; ++j) {
    seen += probability(track, j);
  }
  return std::max(0.0, 1.0 - seen);
}

double Association::unassigned_probability(int detection) const {
  double somebodys = 0.0;
  for (int i = 0; i < tracks_; ++i) {
    somebodys += probability(i, detection);
  }
  return std::max(0.0, 1.0 - somebodys);
}

}  // namespace vantage::estimator
