#include "planner/tour/tour_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.hpp"
#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

constexpr double kReach = 0.6;   // share of the range at which a robot has reached a stop
constexpr double kEnough = 0.7;  // share of a visit's saved cost after which a stop is done
// Weight of a discovery: a discovered target can also be visited after the horizon.
constexpr double kDiscoveryWeight = 4.0;

// Sorts indices by their value, smallest first; equal values by index.
constexpr auto kBefore = [](const auto& a, const auto& b) {
  return a.key < b.key || (a.key == b.key && a.index < b.index);
};

double cost_of(const SearchProblem& problem, const models::StateMatrix& covariance) {
  return problem.cost == CostKind::kLogDet ? models::log_det(covariance) : covariance.trace();
}

// Returns the belief of target m at the horizon's end, after the teammates' planned measurements if
// `has_teammates`.
models::Gaussian belief_at_end(const SearchProblem& problem, std::size_t m, bool has_teammates) {
  const SearchTarget& target = problem.targets[m];
  models::Gaussian belief = target.prior;
  for (std::size_t t = 0; t < index(problem.horizon_steps); ++t) {
    belief = models::predict(belief, target.model, problem.step_s);
    if (has_teammates && !problem.fixed_information.empty() &&
        problem.fixed_information[m][t].size() > 0) {
      const models::StateMatrix& fixed = problem.fixed_information[m][t];
      belief.covariance = fixed.rows() == target.model.position_dim
                              ? models::update_covariance(belief.covariance, fixed)
                              : models::update_state_covariance(belief.covariance, fixed);
    }
  }
  return belief;
}

// Returns the information of one measurement from half the range, straight ahead.
models::PositionMatrix information_of_look(const SearchProblem& problem,
                                           const models::PositionVector& mean_m) {
  models::PositionMatrix M = models::PositionMatrix::Zero(mean_m.size(), mean_m.size());
  for (const models::SensorModel& sensor : problem.sensors) {
    M += models::information(
        sensor, {{mean_m(0) - 0.5 * sensor.range_max_m, mean_m(1), 0.0}, problem.height_m}, mean_m);
  }
  return M;
}

/// A visit: one measurement per step for `visit_s`, at least one.
class Visit {
 public:
  Visit(const SearchProblem& problem, const models::TargetModel& model, double visit_s,
        const models::PositionVector& mean_m)
      : looks_(std::max(1, static_cast<int>(std::lround(visit_s / problem.step_s)))),
        look_(information_of_look(problem, mean_m)),
        step_(model.transition(problem.step_s)),
        noise_(model.process_noise(problem.step_s, 1)) {}

  /// Returns the covariance after a visit that begins with `before`.
  [[nodiscard]] models::StateMatrix after(const models::StateMatrix& before) const {
    models::StateMatrix P = models::update_covariance(before, look_);
    for (int k = 1; k < looks_; ++k) {
      const models::StateMatrix predicted = step_ * P * step_.transpose() + noise_;
      P = models::update_covariance(predicted, look_);
    }
    return P;
  }

 private:
  int looks_;
  models::PositionMatrix look_;
  models::StateMatrix step_;
  models::StateMatrix noise_;
};

// Returns the probability that a planar Gaussian error with this mean variance is within
// `radius_m`.
double probability_within(double radius_m, double variance_m2) {
  return 1.0 - std::exp(-0.5 * radius_m * radius_m / variance_m2);
}

}  // namespace

TourPlanner::TourPlanner(int targets_max)
    : geodesics_(kStopsMax),
      tours_(kStopsMax, 1 + kTeammatesMax, kSamples),
      solver_(kStopsMax, 1 + kTeammatesMax) {
  ranked_.reserve(std::max(index(targets_max), std::size_t{256}));
  beliefs_.reserve(kStopsMax);
  targets_.reserve(kStopsMax);
  positions_m_.reserve(kStopsMax);
  opens_.reserve(kStopsMax);
  dones_.reserve(kStopsMax);
  starts_.reserve(1 + kTeammatesMax);
  tour_.reserve(kStopsMax);
}

std::span<const TourStop> TourPlanner::plan(const SearchProblem& problem,
                                            std::span<const FixedTeammate> teammates,
                                            const scenario::TourSpec& spec,
                                            const TourRegions& regions, const Deadline& deadline) {
  problem_ = &problem;
  regions_ = &regions;
  spec_ = spec;
  tour_.clear();
  speed_mps_ = 0.0;
  for (const models::UnicycleControl& control : problem.controls) {
    speed_mps_ = std::max(speed_mps_, control.speed_mps);
  }
  if (speed_mps_ <= 0.0 || spec.horizon_s <= 0.0) {
    return tour_;
  }
  reach_m_ = speed_mps_ * problem.step_s * problem.horizon_steps;
  double range_max_m = 0.0;
  for (const models::SensorModel& sensor : problem.sensors) {
    range_max_m = std::max(range_max_m, sensor.range_max_m);
  }
  near_m_ = kReach * range_max_m;
  choose_teammates(teammates);
  choose_stops();
  tours_.resize(static_cast<int>(targets_.size()), static_cast<int>(starts_.size()),
                spec.horizon_s / (kSamples - 1), spec.visit_s);
  measure_travel();
  for (int stop = 0; stop < tours_.stop_count(); ++stop) {
    tabulate_gains(stop);
  }
  solver_.solve(tours_, deadline);
  write_tour();
  return tour_;
}

void TourPlanner::choose_teammates(std::span<const FixedTeammate> teammates) {
  starts_.assign(1, {problem_->start.position_m(), 0.0});
  ranked_.clear();
  for (std::size_t i = 0; i < teammates.size() && ranked_.size() < ranked_.capacity(); ++i) {
    if (!teammates[i].jammed) {
      const models::Trajectory& trajectory = teammates[i].trajectory;
      const Eigen::Vector2d end_m =
          models::at(trajectory, models::end_time(trajectory)).world_from_body.position_m();
      ranked_.push_back({(end_m - starts_[0].position_m).norm(), static_cast<int>(i)});
    }
  }
  std::sort(ranked_.begin(), ranked_.end(), kBefore);
  for (std::size_t k = 0; k < std::min(ranked_.size(), index(kTeammatesMax)); ++k) {
    const models::Trajectory& trajectory = teammates[index(ranked_[k].index)].trajectory;
    const Time end = models::end_time(trajectory);
    starts_.push_back({models::at(trajectory, end).world_from_body.position_m(),
                       std::max(0.0, to_seconds(end - problem_->start_time))});
  }
}

void TourPlanner::choose_stops() {
  ranked_.clear();
  for (std::size_t m = 0; m < problem_->targets.size() && m < ranked_.capacity(); ++m) {
    ranked_.push_back(
        {-cost_of(*problem_, problem_->targets[m].prior.covariance), static_cast<int>(m)});
  }
  if (ranked_.size() > index(kStopsMax)) {
    std::sort(ranked_.begin(), ranked_.end(), kBefore);
    ranked_.resize(index(kStopsMax));
  }
  beliefs_.clear();
  targets_.clear();
  positions_m_.clear();
  opens_.clear();
  dones_.clear();
  for (const Ranked& each : ranked_) {
    const models::Gaussian belief = belief_at_end(*problem_, index(each.index), starts_.size() > 1);
    Eigen::Vector2d position_m = belief.mean.head<2>();
    if (problem_->world != nullptr) {
      const models::Rectangle& bounds = problem_->world->bounds;
      position_m = position_m.cwiseMax(bounds.min_m).cwiseMin(bounds.max_m);
    }
    beliefs_.push_back(belief);
    targets_.push_back(each.index);
    positions_m_.push_back(position_m);
  }
}

void TourPlanner::measure_travel() {
  geodesics_.reset(problem_->world, positions_m_);
  GeodesicTable::VisibleCorners visible;
  for (int robot = 0; robot < tours_.robot_count(); ++robot) {
    const Start& start = starts_[index(robot)];
    geodesics_.find_visible_corners(start.position_m, visible);
    for (int stop = 0; stop < tours_.stop_count(); ++stop) {
      tours_.start_s(robot, stop) =
          start.free_s + std::max(0.0, geodesics_.path_m(visible, stop) - near_m_) / speed_mps_;
    }
  }
  for (int i = 0; i < tours_.stop_count(); ++i) {
    geodesics_.find_visible_corners(positions_m_[index(i)], visible);
    for (int j = 0; j < i; ++j) {
      const double travel_s = std::max(0.0, geodesics_.path_m(visible, j) - near_m_) / speed_mps_;
      tours_.travel_s(i, j) = travel_s;
      tours_.travel_s(j, i) = travel_s;
    }
  }
}

const TourRegions::Region* TourPlanner::region_of(int m) const {
  const auto& all = regions_->regions;
  const auto found = std::lower_bound(
      all.begin(), all.end(), m,
      [](const TourRegions::Region& each, int landmark) { return each.landmark < landmark; });
  return found != all.end() && found->landmark == m ? &*found : nullptr;
}

double TourPlanner::found_at(int stop, const models::StateMatrix& covariance) const {
  const TourRegions::Region* const region = region_of(targets_[index(stop)]);
  return region != nullptr ? kDiscoveryWeight * region->expected_targets
                           : probability_within(0.5 / kReach * near_m_,
                                                0.5 * (covariance(0, 0) + covariance(1, 1)));
}

// Sums the saved cost of a visit at each sample, by the trapezoidal rule.
void TourPlanner::tabulate_gains(int stop) {
  const bool is_region = region_of(targets_[index(stop)]) != nullptr;
  const SearchTarget& target =
      is_region ? regions_->undiscovered : problem_->targets[index(targets_[index(stop)])];
  const double sample_s = tours_.sample_s();
  const models::StateMatrix A = target.model.transition(sample_s);
  const models::StateMatrix W = target.model.process_noise(
      sample_s, std::max(1, static_cast<int>(std::lround(sample_s / problem_->step_s))));
  const auto later = [&](const models::StateMatrix& P) -> models::StateMatrix {
    return A * P * A.transpose() + W;
  };
  // The landmark of a region is planar, also if the targets are not.
  models::PositionVector mean_m = target.prior.mean.head(target.model.position_dim);
  const Eigen::Index known = std::min(mean_m.size(), beliefs_[index(stop)].mean.size());
  mean_m.head(known) = beliefs_[index(stop)].mean.head(known);
  const Visit visit(*problem_, target.model, spec_.visit_s, mean_m);
  const models::StateMatrix now =
      is_region ? target.prior.covariance : beliefs_[index(stop)].covariance;
  std::array<double, kSamples> unvisited{};
  models::StateMatrix open = now;
  for (int k = 0; k < kSamples; ++k) {
    open = k > 0 ? later(open) : open;
    unvisited[index(k)] = cost_of(*problem_, open);
  }
  opens_.push_back(unvisited[0]);
  // The landmark of a region needs one measurement only.
  const double visited_now = is_region ? unvisited[0] : cost_of(*problem_, visit.after(now));
  dones_.push_back(unvisited[0] - kEnough * std::max(0.0, unvisited[0] - visited_now));
  open = now;
  for (int k = 0; k + 1 < kSamples; ++k) {
    open = k > 0 ? later(open) : open;
    models::StateMatrix visited = visit.after(open);
    double saved = unvisited[index(k)] - cost_of(*problem_, visited);
    double sum = 0.0;
    for (int l = k + 1; l < kSamples; ++l) {
      visited = later(visited);
      const double then = unvisited[index(l)] - cost_of(*problem_, visited);
      sum += 0.5 * (saved + then);
      saved = then;
    }
    const double gain = found_at(stop, open) * sum * sample_s / problem_->step_s;
    tours_.gain(stop, k) = std::isfinite(gain) ? std::max(0.0, gain) : 0.0;
  }
  tours_.gain(stop, kSamples - 1) = 0.0;
}

void TourPlanner::write_tour() {
  const std::span<const std::uint16_t> tour = solver_.tour(0);
  double at_s = 0.0;
  double path_s = 0.0;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    if (i > 0) {
      path_s += tours_.visit_s() + geodesics_.path_between_m(tour[i - 1], tour[i]) / speed_mps_;
    }
    at_s = i == 0 ? tours_.start_s(0, tour[0])
                  : at_s + tours_.visit_s() + tours_.travel_s(tour[i - 1], tour[i]);
    if (!std::isfinite(at_s)) {
      return;
    }
    const double later_s = at_s + tours_.sample_s();
    const double lost = tours_.gain_at(tour[i], at_s) - tours_.gain_at(tour[i], later_s);
    tour_.push_back({targets_[tour[i]], positions_m_[tour[i]], at_s,
                     std::max(0.0, lost / tours_.sample_s()), path_s, opens_[tour[i]],
                     dones_[tour[i]]});
  }
}

// Long function: it chooses the stops, then fills the grid in two passes.
TerminalValue TourPlanner::terminal_value() const {
  std::vector<TerminalValue::Stop> stops;
  std::vector<int> points;  // indices into positions_m_
  double first_s = 0.0;
  for (const TourStop& stop : tour_) {
    if (stop.rate_per_s <= 0.0 || stops.size() == index(TerminalValue::kStopsMax)) {
      continue;
    }
    first_s = stops.empty() ? stop.path_s : first_s;
    stops.push_back(
        {stop.target, spec_.weight * stop.rate_per_s, stop.path_s - first_s, stop.open, stop.done});
    const auto found = std::find(targets_.begin(), targets_.end(), stop.target);
    points.push_back(static_cast<int>(found - targets_.begin()));
  }
  if (stops.empty() || spec_.weight <= 0.0) {
    return {};
  }
  points.resize(std::min(points.size(), index(TerminalValue::kFieldsMax)));

  TerminalValue::Fields fields;
  fields.side = kSide;
  fields.cell_m = 2.0 * reach_m_ / (kSide - 1);
  fields.min_m = problem_->start.position_m().array() - reach_m_;
  constexpr std::size_t kPoints = index(kSide) * index(kSide);
  fields.times_s.resize(points.size() * kPoints);
  const auto position_m = [&](std::size_t at) -> Eigen::Vector2d {
    const Eigen::Vector2d cell(static_cast<double>(at % kSide), static_cast<double>(at / kSide));
    Eigen::Vector2d p_m = fields.min_m + fields.cell_m * cell;
    if (problem_->world != nullptr) {
      const models::Rectangle& bounds = problem_->world->bounds;
      p_m = p_m.cwiseMax(bounds.min_m).cwiseMin(bounds.max_m);
    }
    return p_m;
  };
  std::vector<std::size_t> open;
  std::vector<std::size_t> blocked;
  for (std::size_t at = 0; at < kPoints; ++at) {
    GeodesicTable::VisibleCorners visible;
    geodesics_.find_visible_corners(position_m(at), visible);
    bool is_open = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double time_s = geodesics_.path_m(visible, points[i]) / speed_mps_;
      fields.times_s[i * kPoints + at] = time_s;
      is_open = is_open && std::isfinite(time_s);
    }
    (is_open ? open : blocked).push_back(at);
  }
  if (open.empty()) {
    return {};
  }
  // Points inside obstacles get the times of the nearest open point, for all stops, so that the
  // triangle inequality also holds there.
  for (const std::size_t at : blocked) {
    const Eigen::Vector2d p_m = position_m(at);
    const std::size_t nearest =
        *std::min_element(open.begin(), open.end(), [&](std::size_t a, std::size_t b) {
          return (position_m(a) - p_m).squaredNorm() < (position_m(b) - p_m).squaredNorm();
        });
    for (std::size_t i = 0; i < points.size(); ++i) {
      fields.times_s[i * kPoints + at] = fields.times_s[i * kPoints + nearest];
    }
  }
  return {std::move(stops), std::move(fields)};
}

}  // namespace vantage::planner
