#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/deadline.hpp"
#include "core/index.hpp"

namespace vantage::planner {

/// Problem of assigning stops and their order to robots, as tables.
///
/// Robots start at their own positions and visit the stops of their tours in order. A visit of stop
/// i that begins at time a has the gain gain_at(i, a) and lasts `visit_s`. A stop is visited at
/// most once. The gains are tabulated at the multiples of `sample_s` and linear in between; a visit
/// after the last sample gains nothing.
class TourProblem {
 public:
  TourProblem(int stops_max, int robots_max, int samples);

  /// Sets the size; all tables must then be filled.
  /// @throws UsageError when the size exceeds the capacity or a time is not > 0
  void resize(int stops, int robots, double sample_s, double visit_s);

  [[nodiscard]] int stop_count() const { return stops_; }
  [[nodiscard]] int robot_count() const { return robots_; }
  [[nodiscard]] int sample_count() const { return samples_; }
  [[nodiscard]] double sample_s() const { return sample_s_; }
  [[nodiscard]] double visit_s() const { return visit_s_; }

  /// Travel time between two stops, s.
  double& travel_s(int i, int j) { return travels_s_[index(i * stops_ + j)]; }
  [[nodiscard]] double travel_s(int i, int j) const { return travels_s_[index(i * stops_ + j)]; }
  /// Time at which a robot can be at its first stop, s.
  double& start_s(int robot, int stop) { return starts_s_[index(robot * stops_ + stop)]; }
  [[nodiscard]] double start_s(int robot, int stop) const {
    return starts_s_[index(robot * stops_ + stop)];
  }
  /// Gain of a visit of `stop` at sample k, ≥ 0.
  double& gain(int stop, int k) { return gains_[index(stop * samples_ + k)]; }
  [[nodiscard]] double gain(int stop, int k) const { return gains_[index(stop * samples_ + k)]; }

  /// Returns the gain of a visit at `arrival_s` ≥ 0.
  [[nodiscard]] double gain_at(int stop, double arrival_s) const {
    const double at = arrival_s * per_sample_;
    if (!(at < samples_ - 1)) {
      return 0.0;
    }
    const int k = static_cast<int>(at);
    const double* const low = &gains_[index(stop * samples_ + k)];
    return low[0] + (at - k) * (low[1] - low[0]);
  }

 private:
  int stops_max_;
  int robots_max_;
  int samples_;
  int stops_ = 0;
  int robots_ = 0;
  double sample_s_ = 1.0;
  double per_sample_ = 1.0;
  double visit_s_ = 0.0;
  std::vector<double> travels_s_;
  std::vector<double> starts_s_;
  std::vector<double> gains_;
};

/// Returns the total gain of one tour.
double gain_of_tour(const TourProblem& problem, int robot, std::span<const std::uint16_t> tour);

/// Anytime solver of TourProblem: allocates the stops to the robots and orders them so that the sum
/// of the gains is large.
///
/// Stops are inserted in descending order of their gain at time 0, each where it raises the sum
/// most. Then moves are applied while one raises the sum: reversal of a part of a tour (2-opt), and
/// transfer of one to three consecutive stops to another position or robot (or-opt), or out of all
/// tours. Unvisited stops are then inserted again. Every intermediate state is a valid solution, so
/// a deadline only ends the improvement. The work is counted in evaluated visits; with a node
/// budget the result is a function of the problem. Allocates nothing after construction.
class TourSolver {
 public:
  TourSolver(int stops_max, int robots_max);

  /// Solves `problem` until no move improves the sum or `deadline` expires.
  void solve(const TourProblem& problem, const Deadline& deadline);

  /// Returns the stops of a robot in the order of visits.
  [[nodiscard]] std::span<const std::uint16_t> tour(int robot) const {
    return {tours_.data() + index(robot) * stops_max_, counts_[index(robot)]};
  }
  /// Returns the sum of the gains.
  [[nodiscard]] double gain() const;
  [[nodiscard]] std::int64_t work_nodes() const { return work_nodes_; }
  /// True if no move improves the sum.
  [[nodiscard]] bool is_finished() const { return is_finished_; }

 private:
  static constexpr std::size_t kMovedMax = 3;

  [[nodiscard]] std::uint16_t* begin(int robot) {
    return tours_.data() + index(robot) * stops_max_;
  }
  double gain_of(int robot, std::span<const std::uint16_t> tour);
  bool expired();
  void insert_all();
  /// Inserts `stop` where the sum rises most; false if it rises nowhere.
  bool insert(std::uint16_t stop);
  bool reverse_parts();
  bool transfer_parts();
  bool transfer(int robot, std::size_t from, std::size_t count);
  void set_tour(int robot, std::span<const std::uint16_t> tour);

  const TourProblem* problem_ = nullptr;
  const Deadline* deadline_ = nullptr;
  std::size_t stops_max_;
  std::vector<std::uint16_t> tours_;  ///< indexed by [robot][position]
  std::vector<std::size_t> counts_;
  std::vector<double> sums_;              ///< gain of each tour
  std::vector<std::uint16_t> order_;      ///< stops by descending gain at time 0
  std::vector<std::uint8_t> is_visited_;  ///< one entry per stop
  std::vector<std::uint16_t> trial_;
  std::vector<std::uint16_t> rest_;
  std::int64_t work_nodes_ = 0;
  bool is_finished_ = false;
};

}  // namespace vantage::planner
