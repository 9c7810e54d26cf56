#include "planner/search/lattice_bound.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "core/infinity.hpp"
#include "models/sensor/law.hpp"

namespace vantage::planner {
namespace {

constexpr double kEdge_rad = 1e-6;
constexpr double kCellsPerStep[] = {12.0, 8.0, 6.0, 4.0, 3.0, 2.0, 1.5, 1.0};  // finest first
constexpr double kFloatRounding = 1e-5;                                        // of sums of floats
constexpr std::size_t kCellNodes = 4;  // a look from a cell takes the time of so many nodes …

// How much of a strength counts linearly, and e to the power of what the rest tells of each state.
struct Capped {
  double kept = 0.0;
  double more = 1.0;
};

// The least over b' of `per_strength` b' + weight ln((b + known) / (b' + known)).
Capped capped(double strength, double per_strength, double weight, double known) {
  const double kept = std::max(0.0, weight / per_strength - known);
  return kept < strength ? Capped{kept, (strength + known) / (kept + known)}
                         : Capped{strength, 1.0};
}

// The largest angle that all turns are whole multiples of; 0: none was found.
double unit_of_turns(const SearchProblem& problem) {
  double least_rad = kInfinity;
  for (const models::UnicycleControl& control : problem.controls) {
    const double turn_rad = std::abs(control.yaw_rate_radps) * problem.step_s;
    least_rad = turn_rad > 0.0 ? std::min(least_rad, turn_rad) : least_rad;
  }
  if (!std::isfinite(least_rad)) {
    return 1.0;
  }
  constexpr double kClose = 1e-9;
  for (int parts = 1; parts <= 4; ++parts) {
    const double unit_rad = least_rad / parts;
    bool whole = true;
    for (const models::UnicycleControl& control : problem.controls) {
      const double turns = control.yaw_rate_radps * problem.step_s / unit_rad;
      whole = whole && std::abs(turns - std::round(turns)) < kClose;
    }
    if (whole) {
      return unit_rad;
    }
  }
  return 0.0;
}

}  // namespace

LatticeBound::LatticeBound(int targets_max, int horizon_max, std::size_t states_max)
    : cost_(targets_max, horizon_max),
      states_(kWaitsMax * states_max),
      squares_(kWaitsMax * states_max / 2),
      looks_(states_max / 2) {
  const auto half_max = static_cast<std::size_t>(kCellsPerStep[0]) * (index(horizon_max) + 1) + 4;
  sensors_.reserve(8);
  turns_.reserve(kMaxControls);
  ends_.reserve(kMaxControls);
  looked_.resize(3 * index(targets_max) * index(horizon_max));
  levels_.resize(index(horizon_max + 1));
  rows_.resize(index(horizon_max + 1) * (half_max + 1));
  beside_m_.reserve(index(targets_max));
  arounds_.resize(index(targets_max));
  row_.resize(2 * half_max + 1);
  rare_row_.resize(2 * half_max + 1);
  all_round_ = ReservedArray<float>(row_.size() * row_.size());
  rare_ = ReservedArray<float>(row_.size() * row_.size());
  constexpr std::size_t kHeadingsMax = 1024;
  shifts_.reserve(kHeadingsMax * kMaxControls);
}

void LatticeBound::prefault() {
  states_.prefault();
  squares_.prefault();
  looks_.prefault();
  all_round_.prefault();
  rare_.prefault();
}

void LatticeBound::reset(const SearchProblem& problem, const BeliefTable& beliefs) {
  problem_ = &problem;
  beliefs_ = &beliefs;
  targets_ = beliefs.target_count();
  horizon_ = problem.horizon_steps;
  cost_.reset(problem, beliefs, InformationMeasure::kLogDet);
  unit_rad_ = unit_of_turns(problem);
  applies_ = beliefs.cost() == CostKind::kLogDet && unit_rad_ > 0.0 && targets_ > 0;
  turn_most_ = 0;
  step_m_ = kEdge_m;
  turns_.clear();
  ends_.clear();
  for (const models::UnicycleControl& control : problem.controls) {
    const int turn =
        applies_
            ? static_cast<int>(std::lround(control.yaw_rate_radps * problem.step_s / unit_rad_))
            : 0;
    turn_most_ = std::max(turn_most_, std::abs(turn));
    turns_.push_back({0, 0, turn});
    ends_.push_back(models::step_unicycle({}, control, problem.step_s));
    step_m_ = std::max(step_m_, ends_.back().position_m().norm() + kEdge_m);
  }
  sensors_.clear();
  sight_m_ = 0.0;
  for (const models::SensorModel& model : problem.sensors) {
    const models::SensorLaw& law = model.kind.law();
    if (law.planar_law == nullptr) {
      applies_ = false;
      return;
    }
    const models::PlanarLaw planar = law.planar_law(model);
    sensors_.push_back({model.range_max_m, model.range_min_m, std::min(kPi, 0.5 * model.fov_rad),
                        planar.along_per_m2, planar.across_per_rad2, planar.all_ways_per_m2,
                        1.0 / model.range_max_m, model.variance_floor,
                        model.variance_grows_with_range});
    sight_m_ = std::max(sight_m_, model.range_max_m);
  }
  for (int m = 0; m < targets_; ++m) {
    applies_ = applies_ && beliefs.layout(m) != BlockLayout::kSpatial;
  }
  find_rare();
}

void LatticeBound::find_rare() {
  constexpr double kBesideMost_m = 0.2;
  constexpr double kBesideLeast_m = 0.02;
  beside_m_.assign(index(targets_), 0.0);
  waits_ = 1;
  if (sensors_.size() > 1) {
    return;  // of what is rare add_rewards() takes the most of one look
  }
  // Ways of one and of two steps.
  double least_m[kWaitsMax] = {0.0, kInfinity, kInfinity};
  double most_m[kWaitsMax] = {};
  for (const Pose2& first : ends_) {
    least_m[1] = std::min(least_m[1], first.position_m().norm());
    most_m[1] = std::max(most_m[1], first.position_m().norm());
    for (const models::UnicycleControl& control : problem_->controls) {
      const double way_m =
          models::step_unicycle(first, control, problem_->step_s).position_m().norm();
      least_m[2] = std::min(least_m[2], way_m);
      most_m[2] = std::max(most_m[2], way_m);
    }
  }
  // How near at most so that nothing leads from (i, k) to (j, k + steps); less than 0: something.
  const auto slack_m = [&](int i, int j) {
    double slack = kInfinity;
    for (int steps = i == j ? 1 : 0; steps < kWaitsMax; ++steps) {
      for (int k = 1; k + steps <= horizon_; ++k) {
        const double way_m =
            (beliefs_->mean_m(j, k + steps).head<2>() - beliefs_->mean_m(i, k).head<2>()).norm();
        slack = std::min(slack, std::max(least_m[steps] - way_m, way_m - most_m[steps]));
      }
    }
    return slack - kEdge_m;
  };
  for (int m = 0; m < targets_; ++m) {
    models::Rectangle& around = arounds_[index(m)];
    around = {beliefs_->mean_m(m, 1).head<2>(), beliefs_->mean_m(m, 1).head<2>()};
    for (int k = 2; k <= horizon_; ++k) {
      around.min_m = around.min_m.cwiseMin(beliefs_->mean_m(m, k).head<2>());
      around.max_m = around.max_m.cwiseMax(beliefs_->mean_m(m, k).head<2>());
    }
    double near_m = std::min(kBesideMost_m, 0.5 * slack_m(m, m));
    const double far_m = most_m[kWaitsMax - 1] + 2.0 * kBesideMost_m + kEdge_m;
    for (int other = 0; other < m; ++other) {
      const models::Rectangle& its = arounds_[index(other)];
      const bool is_far = (around.min_m.array() - its.max_m.array() > far_m).any() ||
                          (its.min_m.array() - around.max_m.array() > far_m).any();
      if (beside_m_[index(other)] > 0.0 && !is_far) {
        near_m = std::min({near_m, slack_m(m, other) - beside_m_[index(other)],
                           slack_m(other, m) - beside_m_[index(other)]});
      }
    }
    if (near_m >= kBesideLeast_m) {
      beside_m_[index(m)] = near_m;
      waits_ = kWaitsMax;
    }
  }
}

void LatticeBound::begin(float* reference) const {
  constexpr double kShare = 0.1;
  for (int m = 0; m < targets_; ++m) {
    for (int k = 1; k <= horizon_; ++k) {
      const double away_m =
          (beliefs_->mean_m(m, k).head<2>() - problem_->start.position_m()).norm();
      double strength = 0.0;
      for (const Sensor& sensor : sensors_) {
        const double middle_m = 0.5 * sensor.range_max_m;
        if (away_m < sensor.range_max_m + k * step_m_) {
          strength +=
              sensor.all_ways + 0.5 * (sensor.along + sensor.across / (middle_m * middle_m));
        }
      }
      float* const R = reference + 3 * cost_.at(m, k);
      R[0] = R[2] = static_cast<float>(kShare * strength);
      R[1] = 0.0F;
    }
  }
}

bool LatticeBound::work(std::size_t nodes) {
  *work_nodes_ += 1 + static_cast<std::int64_t>(nodes);
  return !deadline_->expired(*work_nodes_);
}

void LatticeBound::mark_reached(const Pose2& at, int depth, LinearisedCost& cost) const {
  for (int m = 0; m < targets_; ++m) {
    for (int k = depth + 1; k <= horizon_; ++k) {
      const double away_m = (beliefs_->mean_m(m, k).head<2>() - at.position_m()).norm();
      if (away_m < sight_m_ + (k - depth) * step_m_ + kEdge_m) {
        cost.set_reached(m, k);
      }
    }
  }
}

bool LatticeBound::lay_out(std::size_t states) {
  const int steps = horizon_ - depth_;
  states = std::min(states, states_.size());
  for (const double ratio : kCellsPerStep) {
    cell_m_ = step_m_ / ratio;
    std::size_t begin = 0;
    for (int t = 1; t <= steps; ++t) {
      Level& level = levels_[index(t)];
      const auto extent = [&](int u) {
        return static_cast<int>(std::floor(u * ratio + 0.5 + kEdge_m / cell_m_));
      };
      level.turns = t * turn_most_;
      level.extent = extent(t);
      level.half = extent(t - 1) + static_cast<int>(std::ceil(ratio)) + 2;
      level.begin = begin;
      begin += level.size();
    }
    if (begin > states || levels_[index(steps)].size() > looks_.size()) {
      continue;
    }
    const Level& last = levels_[index(steps)];
    const std::size_t row_stride = rows_.size() / levels_.size();
    if (index(last.half) >= row_stride || index(last.width()) > row_.size()) {
      continue;
    }
    for (int t = 1; t <= steps; ++t) {
      for (int j = 0; j <= levels_[index(t)].half; ++j) {
        const double off_m = std::max(0.0, (j - 0.5) * cell_m_ - kEdge_m);
        const double left_m2 = t * step_m_ * (t * step_m_) - off_m * off_m;
        rows_[index(t) * row_stride + index(j)] =
            left_m2 < 0.0
                ? -1
                : std::min(
                      levels_[index(t)].extent,
                      static_cast<int>(std::floor((std::sqrt(left_m2) + kEdge_m) / cell_m_ + 0.5)));
      }
    }
    shift_turns_ = last.turns;
    const std::size_t shifts = index(2 * shift_turns_ + 1) * ends_.size();
    if (shifts > shifts_.capacity()) {
      return false;
    }
    shifts_.clear();
    for (int n = -shift_turns_; n <= shift_turns_; ++n) {
      const double yaw_rad = from_.yaw_rad + n * unit_rad_;
      const double c = std::cos(yaw_rad) / cell_m_;
      const double s = std::sin(yaw_rad) / cell_m_;
      for (std::size_t u = 0; u < ends_.size(); ++u) {
        const double x = c * ends_[u].x_m - s * ends_[u].y_m;
        const double y = s * ends_[u].x_m + c * ends_[u].y_m;
        shifts_.push_back({static_cast<int>(std::floor(x - kEdge_m)),
                           static_cast<int>(std::floor(y - kEdge_m)), turns_[u].turn});
      }
    }
    return true;
  }
  return false;
}

int LatticeBound::reach_of_row(int t, int j) const {
  return rows_[index(t) * (rows_.size() / levels_.size()) + index(std::abs(j))];
}

bool LatticeBound::clear_level(int t) {
  const Level& level = levels_[index(t)];
  std::fill_n(all_round_.data(), level.plane(), 0.0F);
  std::fill_n(rare_.data(), level.plane(), 0.0F);
  for (int n = -level.turns; n <= level.turns; ++n) {
    std::fill_n(looks_.data() + index(n + level.turns) * level.plane(), level.plane(), 0.0F);
    if (!work(level.plane() / kMovesANode)) {
      return false;
    }
  }
  return true;
}

// long: distances and directions that a cell offers, then what they are worth.
LatticeBound::Look LatticeBound::look(int m, int k, const Sensor& sensor, double dx_m, double dy_m,
                                      double half_cell_m) const {
  const double ax_m = std::abs(dx_m);
  const double ay_m = std::abs(dy_m);
  const double nx_m = std::max(0.0, ax_m - half_cell_m);
  const double ny_m = std::max(0.0, ay_m - half_cell_m);
  const double near2_m2 = nx_m * nx_m + ny_m * ny_m;
  if (near2_m2 >= sensor.range_max_m * sensor.range_max_m) {
    return {};
  }
  const double fx_m = ax_m + half_cell_m;
  const double fy_m = ay_m + half_cell_m;
  if (fx_m * fx_m + fy_m * fy_m < sensor.range_min_m * sensor.range_min_m) {
    return {};
  }
  // What directions towards the cell may ask of the gradient: ½ tr G ± A cos 2(θ − θ₀).
  const LinearisedCost::Gradient& g = told_->gradient(m, k);
  const double mean = 0.5 * (g.xx + g.yy);
  const double half_difference = 0.5 * (g.xx - g.yy);
  const double amplitude = std::sqrt(half_difference * half_difference + g.xy * g.xy);
  const double center2_m2 = dx_m * dx_m + dy_m * dy_m;
  const double sin2_spread = 2.0 * half_cell_m * half_cell_m / center2_m2;
  double most = amplitude;
  double least = -amplitude;
  Look out;
  out.half_angle_rad = kPi;
  if (sin2_spread < 1.0) {
    const double spread_rad = std::asin(std::sqrt(sin2_spread));
    out.half_angle_rad = std::min(kPi, sensor.half_fov_rad + spread_rad + kEdge_rad);
    const double cos_2 = (dx_m * dx_m - dy_m * dy_m) / center2_m2;
    const double sin_2 = 2.0 * dx_m * dy_m / center2_m2;
    const double here = half_difference * cos_2 + g.xy * sin_2;
    const double turned = std::abs(g.xy * cos_2 - half_difference * sin_2);
    const double cos_spread = 1.0 - 2.0 * sin2_spread;  // of twice the angle
    const double sin_spread = 2.0 * std::sqrt(sin2_spread * (1.0 - sin2_spread));
    if (here < amplitude * cos_spread) {
      most = here * cos_spread + turned * sin_spread;
    }
    if (-here < amplitude * cos_spread) {
      least = here * cos_spread - turned * sin_spread;
    }
  }
  if (sensor.half_fov_rad >= kPi) {
    out.half_angle_rad = kPi;
  }
  const double weight = told_->weight(k);
  const double per_along = mean + most;
  const double per_across = mean - least;
  const double known = told_->known(m, k);
  const auto value = [&](double r_m) {
    const double growth =
        sensor.grows ? std::max(sensor.variance_floor, r_m * sensor.growth_per_m) : 1.0;
    const Capped forth = capped(sensor.along / growth + sensor.all_ways, per_along, weight, known);
    const Capped side =
        capped(sensor.across / (r_m * r_m * growth) + sensor.all_ways, per_across, weight, known);
    out.along = forth.kept;
    out.across = side.kept;
    const double more = forth.more * side.more;
    return per_along * forth.kept + per_across * side.kept +
           (more > 1.0 ? weight * std::log(more) : 0.0);
  };
  const double r_m = std::max({std::sqrt(near2_m2), sensor.range_min_m, models::kLeastRange_m});
  const double beside_m = beside_m_[index(m)];
  out.beside = r_m < beside_m ? value(r_m) : 0.0;
  out.reward = value(std::max(r_m, beside_m));
  out.beside = std::max(0.0, out.beside - out.reward);
  return out;
}

// long: the loops over targets, sensors and cells, and what each needs only once.
bool LatticeBound::add_rewards(int t) {
  const int k = depth_ + t;
  const Level& level = levels_[index(t)];
  const int width = level.width();
  const double half_cell_m = 0.5 * cell_m_ + kEdge_m;
  const double period = 2.0 * kPi / unit_rad_;
  float* const planes = looks_.data() + index(level.turns) * level.plane();
  const auto stride = static_cast<std::ptrdiff_t>(level.plane());
  for (int m = 0; m < targets_; ++m) {
    if (!told_->is_reached(m, k)) {
      continue;
    }
    const Eigen::Vector2d away_m = beliefs_->mean_m(m, k).head<2>() - from_.position_m();
    for (const Sensor& sensor : sensors_) {
      const double within_m = sensor.range_max_m + half_cell_m;
      const int low =
          std::max(-level.extent, static_cast<int>(std::ceil((away_m.y() - within_m) / cell_m_)));
      const int high =
          std::min(level.extent, static_cast<int>(std::floor((away_m.y() + within_m) / cell_m_)));
      for (int j = low; j <= high; ++j) {
        const double dy_m = away_m.y() - j * cell_m_;
        const double ny_m = std::max(0.0, std::abs(dy_m) - half_cell_m);
        const double across2_m2 = sensor.range_max_m * sensor.range_max_m - ny_m * ny_m;
        const int reach = reach_of_row(t, j);
        if (across2_m2 <= 0.0 || reach < 0) {
          continue;
        }
        const double wide_m = std::sqrt(across2_m2) + half_cell_m;
        const int left =
            std::max(-reach, static_cast<int>(std::ceil((away_m.x() - wide_m) / cell_m_)));
        const int right =
            std::min(reach, static_cast<int>(std::floor((away_m.x() + wide_m) / cell_m_)));
        for (int i = left; i <= right; ++i) {
          const double dx_m = away_m.x() - i * cell_m_;
          const Look seen = look(m, k, sensor, dx_m, dy_m, half_cell_m);
          if (seen.reward <= 0.0) {
            continue;
          }
          const auto reward = static_cast<float>(seen.reward);
          const std::ptrdiff_t cell = (j + level.half) * width + i + level.half;
          float& rare = rare_[static_cast<std::size_t>(cell)];
          rare = std::max(rare, static_cast<float>(seen.beside));
          if (seen.half_angle_rad >= kPi) {
            all_round_[static_cast<std::size_t>(cell)] += reward;
            continue;
          }
          const double bearing = (std::atan2(dy_m, dx_m) - from_.yaw_rad) / unit_rad_;
          const double spread = seen.half_angle_rad / unit_rad_;
          double middle = bearing - period * std::floor((bearing + spread + level.turns) / period);
          for (; middle - spread <= level.turns; middle += period) {
            const int first = std::max(-level.turns, static_cast<int>(std::ceil(middle - spread)));
            const int last = std::min(level.turns, static_cast<int>(std::floor(middle + spread)));
            for (int n = first; n <= last; ++n) {
              planes[n * stride + cell] += reward;
            }
          }
        }
        if (right >= left && !work(kCellNodes * index(right - left + 1))) {
          return false;
        }
      }
    }
  }
  return true;
}

LatticeBound::Answer LatticeBound::cost_to_go(const Pose2& at, int depth, const Blocks& blocks,
                                              float* reference, double share, std::size_t states,
                                              const Deadline& deadline, std::int64_t& work_nodes) {
  deadline_ = &deadline;
  work_nodes_ = &work_nodes;
  cost_.clear_reached();
  mark_reached(at, depth, cost_);
  double base = 0.0;
  std::size_t touched = 0;
  const double* packed = blocks.packed;
  for (int m = 0; m < targets_; ++m) {
    const double* block = beliefs_->open_loop(m, depth);
    if (touched < blocks.targets.size() && blocks.targets[touched] == m) {
      block = packed;
      packed += packed_size(beliefs_->layout(m));
      ++touched;
    }
    base += cost_.linearise(m, depth, block, reference);
    if (!work(kTargetNodes)) {
      return {-kInfinity, true};
    }
  }
  const bool betters = share > 0.0;
  std::fill(looked_.begin(), looked_.end(), 0.0F);
  const Path path =
      best_path(at, depth, cost_, betters ? looked_.data() : nullptr, states, deadline, work_nodes);
  const double cost = base - path.gained - kFloatRounding * (1.0 + path.gained);
  if (betters && !path.expired && path.gained < kInfinity) {
    for (int m = 0; m < targets_; ++m) {
      for (std::size_t i = 3 * cost_.at(m, depth + 1); i < 3 * cost_.at(m, horizon_) + 3; ++i) {
        reference[i] += static_cast<float>(share) * (looked_[i] - reference[i]);
      }
    }
  }
  return {std::isnan(cost) ? -kInfinity : cost, path.expired};
}

LatticeBound::Path LatticeBound::best_path(const Pose2& at, int depth, const LinearisedCost& cost,
                                           float* looked, std::size_t states,
                                           const Deadline& deadline, std::int64_t& work_nodes) {
  from_ = at;
  depth_ = depth;
  told_ = &cost;
  deadline_ = &deadline;
  work_nodes_ = &work_nodes;
  if (!lay_out(states)) {
    return {kInfinity, false};
  }
  for (int t = horizon_ - depth_; t >= 1; --t) {
    if (!clear_level(t) || !add_rewards(t) || !gather(t)) {
      return {kInfinity, true};
    }
  }
  const double most = best_first_step();
  return {most, looked != nullptr && !follow_best(looked)};
}

}  // namespace vantage::planner
