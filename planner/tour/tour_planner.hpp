#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/deadline.hpp"
#include "planner/problem/fixed_information.hpp"
#include "planner/problem/problem.hpp"
#include "planner/problem/terminal_value.hpp"
#include "planner/search/geodesic.hpp"
#include "planner/tour/tour_solver.hpp"
#include "scenario/tour_spec.hpp"

namespace vantage::planner {

/// One stop of a planned tour.
struct TourStop {
  int target = 0;  ///< target of the stop, index into SearchProblem::targets
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double arrival_s = 0.0;   ///< s after the problem's start
  double rate_per_s = 0.0;  ///< gain lost per second of later arrival, ≥ 0
  double path_s = 0.0;      ///< s; travel and visits from the first stop to this one
  double open = 0.0;        ///< see TerminalValue::Stop
  double done = 0.0;
};

/// Unexplored regions as stops of a tour.
struct TourRegions {
  /// A target that was not discovered, at the problem's start.
  SearchTarget undiscovered;
  struct Region {
    int landmark = 0;  ///< index into SearchProblem::targets of the landmark in the region
    double expected_targets = 0.0;  ///< expected number of undiscovered targets in the region
  };
  std::vector<Region> regions;  ///< by ascending landmark
};

/// Planner of the order in which a robot visits the targets of a search problem beyond its horizon.
///
/// Every target of the problem is a stop at its mean at the horizon's end. It is a real target, a
/// component of a mixture, or the landmark of an unexplored region. The gain of a visit at time a
/// is the cost that its measurements save (log det or trace, summed over steps of step_s until
/// horizon_s). Without a visit the covariance follows the target's motion model. A visit measures
/// once per step for visit_s, from half the sensor's range, straight ahead. The gain is multiplied
/// by the probability that the target is within half the range of its mean. A visit of an
/// unexplored region gains what the visit of one undiscovered target saves, times the weighted
/// expected number of undiscovered targets in the region. The planned measurements of teammates are
/// assumed to be made. Travel times are shortest paths around obstacles at the greatest speed,
/// shortened by 0.6 of the sensor's range per stop. In the terminal value a stop is done when the
/// plan has reduced the cost of its covariance by 0.7 of the reduction by one visit.
///
/// In a team, the stops are allocated to all robots: the teammates start where and when their plans
/// end. The robot's own tour is the result. Only the kStopsMax targets with the greatest covariance
/// and the kTeammatesMax nearest teammates take part.
///
/// plan() allocates nothing after construction. Its work is bounded by a number of evaluated
/// visits, so the tour is a function of its arguments. Source: ours, as a travelling repairman
/// problem with gains that depend on time. Yuan et al., RA-L 2025 (arXiv 2510.10421) also choose
/// the next target in a layer above a motion planner.
class TourPlanner {
 public:
  static constexpr int kStopsMax = 128;
  static constexpr int kTeammatesMax = 7;
  /// Maximum number of evaluated visits per plan, which take a few milliseconds.
  static constexpr std::int64_t kVisitsMax = 400'000;

  explicit TourPlanner(int targets_max);

  /// Plans the tour of a valid problem. `teammates` are the robots that share the stops. If there
  /// are none, the fixed information of the problem is ignored too. The result is valid until the
  /// next call.
  std::span<const TourStop> plan(const SearchProblem& problem,
                                 std::span<const FixedTeammate> teammates,
                                 const scenario::TourSpec& spec, const TourRegions& regions = {},
                                 const Deadline& deadline = Deadline::nodes(kVisitsMax));

  /// Returns the terminal value of the last planned tour. Stops without a rate are left out.
  /// Allocates the result.
  [[nodiscard]] TerminalValue terminal_value() const;

  /// Returns the solver of the last plan, for its gain and work.
  [[nodiscard]] const TourSolver& solver() const { return solver_; }

 private:
  static constexpr int kSamples = 9;
  static constexpr int kSide = 41;  ///< number of points per side of the terminal value's grid

  void choose_stops();
  void choose_teammates(std::span<const FixedTeammate> teammates);
  void measure_travel();
  void tabulate_gains(int stop);
  /// Returns the expected number of targets that a visit finds; discoveries are weighted.
  [[nodiscard]] double found_at(int stop, const models::StateMatrix& covariance) const;
  /// Returns the region with target m as its landmark, or null.
  [[nodiscard]] const TourRegions::Region* region_of(int m) const;
  void write_tour();

  const SearchProblem* problem_ = nullptr;
  const TourRegions* regions_ = nullptr;
  scenario::TourSpec spec_;
  double speed_mps_ = 0.0;
  double reach_m_ = 0.0;
  double near_m_ = 0.0;  ///< distance at which a stop counts as reached
  GeodesicTable geodesics_;
  TourProblem tours_;
  TourSolver solver_;
  struct Ranked {
    double key = 0.0;
    int index = 0;
  };
  struct Start {
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
    double free_s = 0.0;  ///< s after the problem's start
  };
  std::vector<Ranked> ranked_;
  std::vector<models::Gaussian> beliefs_;  ///< belief about each stop's target at the horizon's end
  std::vector<int> targets_;               ///< index of each stop's target
  std::vector<double> opens_;              ///< `open` of each stop; see TerminalValue::Stop
  std::vector<double> dones_;              ///< `done` of each stop; see TerminalValue::Stop
  std::vector<Eigen::Vector2d> positions_m_;
  std::vector<Start> starts_;  ///< start of each robot; the first is this robot
  std::vector<TourStop> tour_;
};

}  // namespace vantage::planner
