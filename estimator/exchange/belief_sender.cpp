#include "estimator/exchange/belief_sender.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "core/index.hpp"
#include "estimator/tracks/gaussian/track.hpp"

namespace vantage::estimator {
namespace {

/// Assumed probabilities that a teammate misses a message, and that it is out of range of the
/// teammate that sent a received message.
constexpr double kMissed = 0.3;
constexpr double kOutOfRange = 0.3;
/// Maximum time without a message. Teammates must receive messages at least this often to list this
/// robot as a neighbour.
constexpr Duration kPresencePeriod{2'000'000};
/// Share of a message that targets may use if there are also cells to send.
constexpr double kTargetShare = 0.6;
/// Bytes of one encoded run of cells in most cases: up to two bytes of skip, one of length and one
/// of age. Longer runs are rare, and may exceed the budget slightly.
constexpr std::size_t kRunBytes = 4;

bool is_set(const models::Information& information) { return information.matrix.size() > 0; }

/// Bytes of the fixed fields of compact_belief_t, without the robot's name.
constexpr std::size_t kHeadBytes = 8 + 24 + 5 + 8 + 32 + 4 + 24 + 8 + 4;
std::size_t target_bytes(int dim) {
  const auto n = static_cast<std::size_t>(dim);
  return 4 + 1 + 4 * n + 2 * n + 1 + n * (n - 1) + 4;
}

double log_det_of(const models::StateMatrix& Omega) {
  const Eigen::LLT<models::StateMatrix> root(Omega);
  return 2.0 * root.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

void BeliefSender::receive(const models::RobotBelief& belief) {
  const auto heard = heard_.find(belief.robot);
  const bool is_new = heard == heard_.end() || belief.stamp.time - heard->second > kSilenceMax;
  heard_[belief.robot] = belief.stamp.time;
  if (is_new) {
    for (auto& [id, known] : known_) {
      known.sent = known.previous = known.received = {};
    }
    std::fill(cells_utime_.begin(), cells_utime_.end(), models::VisibilityGrid::kNeverSeen);
  }
  const int dim = spec_.estimator.target_model.dim();
  for (const models::TargetBelief& target : belief.targets) {
    if (target.information.vector.size() != dim) {
      continue;  // the filter counts it as malformed
    }
    Known& known = known_[target.target_id];
    const auto now = belief.stamp.time < now_
                         ? propagate(spec_.estimator.target_model, spec_.step_s, target.information,
                                     target.last_seen, belief.stamp.time, now_)
                         : std::optional(target.information);
    if (!now) {
      continue;
    }
    const bool is_better =
        !is_set(known.received) || log_det_of(now->matrix) > log_det_of(known.received.matrix);
    if (is_better) {
      known.received = *now;
      known.last_seen = std::max(known.last_seen, target.last_seen);
    }
  }
  if (!belief.last_seen_utime.empty() && cells_utime_.size() == index(grid_.size())) {
    models::merge_stamps(grid_, cells_utime_, belief.grid, belief.last_seen_utime,
                         to_utime(belief.stamp.time));
  }
}

void BeliefSender::predict(Time now) {
  for (auto& [id, known] : known_) {
    for (models::Information* each : {&known.sent, &known.previous, &known.received}) {
      const auto later = is_set(*each) ? propagate(spec_.estimator.target_model, spec_.step_s,
                                                   *each, known.last_seen, now_, now)
                                       : std::nullopt;
      *each = later.value_or(models::Information{});
    }
  }
  now_ = now;
}

// Covariance intersection uses a belief whenever tr(Ω_own Σ_theirs) is larger than the dimension.
double BeliefSender::gain_over(const models::Gaussian& own,
                               const models::Information& theirs) const {
  const auto n = static_cast<double>(own.mean.size());
  models::StateMatrix other;
  if (is_set(theirs) && theirs.matrix.rows() == own.covariance.rows()) {
    const auto gaussian = models::to_gaussian(theirs);
    if (!gaussian) {
      return 0.0;
    }
    other = gaussian->covariance;
  } else {  // teammates do not know the target: use the prior of an undiscovered target
    const double undiscovered = spec_.estimator.undiscovered_position_sigma_m;
    const Eigen::Vector2d half = 0.5 * (spec_.world.bounds.max_m - spec_.world.bounds.min_m);
    const double sigma_m = undiscovered > 0.0 ? undiscovered : half.norm();
    models::StateVector variance = models::StateVector::Constant(
        own.mean.size(),
        spec_.estimator.prior_velocity_sigma_mps * spec_.estimator.prior_velocity_sigma_mps);
    variance.head(spec_.estimator.target_model.position_dim).setConstant(sigma_m * sigma_m);
    other = variance.asDiagonal();
  }
  const Eigen::LLT<models::StateMatrix> root(own.covariance);
  if (root.info() != Eigen::Success) {
    return 0.0;
  }
  const double by_trace = 0.5 * n * std::log(std::max(root.solve(other).trace() / n, 1.0));
  const double by_volume = 0.5 * (models::log_det(other) - models::log_det(own.covariance));
  return std::max({by_trace, by_volume, 0.0});
}

double BeliefSender::gain_of(const models::TargetBelief& own, const Known& known, bool is_observed,
                             Time now) const {
  const auto belief = models::to_gaussian(own.information);
  if (!belief) {
    return 0.0;
  }
  const double over_sent = gain_over(*belief, known.sent);
  const double over_previous =
      is_set(known.previous) || is_set(known.sent) ? gain_over(*belief, known.previous) : over_sent;
  double gain = (1.0 - kMissed) * over_sent + kMissed * over_previous;
  if (is_set(known.received)) {
    const double over_received = std::min(gain_over(*belief, known.received), over_sent);
    gain = kOutOfRange * gain + (1.0 - kOutOfRange) * over_received;
  }
  if (is_observed) {
    gain *= kMissed;
  }
  const bool is_due = now - known.sent_at >= kWholePeriod;
  return is_due ? std::max(gain, kGainMin_nats) : gain;
}

void BeliefSender::add_targets(const models::RobotBelief& own, std::span<const Candidate> order,
                               std::size_t bytes_max, models::CompactBelief& out) {
  std::size_t bytes = 0;
  for (const Candidate& candidate : order) {
    const models::TargetBelief& target = own.targets[candidate.index];
    const std::size_t more = target_bytes(static_cast<int>(target.information.vector.size()));
    if (bytes + more > bytes_max) {
      break;
    }
    const auto rounded = models::compact(target, own.stamp.time);
    if (!rounded) {
      ++unsendable_;
      continue;
    }
    bytes += more;
    out.targets.push_back(*rounded);
    Known& known = known_[target.target_id];
    known.previous = std::exchange(known.sent, target.information);
    known.last_seen = std::max(known.last_seen, target.last_seen);
    known.sent_at = own.stamp.time;
  }
  std::sort(out.targets.begin(), out.targets.end(),
            [](const auto& a, const auto& b) { return a.target_id < b.target_id; });
}

void BeliefSender::add_cells(const models::RobotBelief& own, std::size_t bytes_max,
                             models::CompactBelief& out) {
  const models::GridGeometry& grid = own.grid;
  if (grid.rows == 0 || bytes_max < kRunBytes) {
    return;
  }
  // Returns the age code of a cell that teammates do not know well enough.
  const auto code_of = [&](int cell) -> std::optional<std::uint8_t> {
    const std::int64_t seen_utime = own.last_seen_utime[index(cell)];
    const bool is_news = seen_utime != models::VisibilityGrid::kNeverSeen &&
                         seen_utime - cells_utime_[index(cell)] >= kCellStep.count();
    return is_news ? models::cell_age_code(own.stamp.time - from_utime(seen_utime)) : std::nullopt;
  };
  struct Run {
    int begin = 0;
    int length = 0;
    std::uint8_t code = 0;
  };
  // Selects whole rows, starting with the row after the last one that was sent. If already the
  // first row is too large, its first runs are sent; the others follow in the next message.
  const std::size_t runs_max = bytes_max / kRunBytes;
  std::vector<Run> runs;
  int done = 0;
  for (; done < grid.rows; ++done) {
    const int first = (next_row_ + done) % grid.rows * grid.columns;
    const std::size_t before = runs.size();
    for (int cell = first; cell < first + grid.columns; ++cell) {
      const auto code = code_of(cell);
      if (!code) {
        continue;
      }
      const bool is_next = runs.size() > before && runs.back().code == *code &&
                           runs.back().begin + runs.back().length == cell;
      if (is_next) {
        ++runs.back().length;
      } else {
        runs.push_back({cell, 1, *code});
      }
    }
    const bool fits = runs.size() <= runs_max;
    if (!fits) {
      runs.resize(done == 0 ? runs_max : before);
    }
    for (std::size_t i = before; i < runs.size(); ++i) {
      const auto begin = own.last_seen_utime.begin() + runs[i].begin;
      std::copy_n(begin, runs[i].length, cells_utime_.begin() + runs[i].begin);
    }
    if (!fits) {
      break;
    }
  }
  next_row_ = (next_row_ + done) % grid.rows;
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.begin < b.begin; });
  int end = 0;
  for (const Run& run : runs) {
    models::append_run(out.runs, run.begin - end, run.length, run.code);
    end = run.begin + run.length;
  }
}

void BeliefSender::follow_grid(const models::RobotBelief& own) {
  if (!(grid_ == own.grid)) {
    std::vector<std::int64_t> moved(index(own.grid.size()), models::VisibilityGrid::kNeverSeen);
    if (!cells_utime_.empty()) {
      models::merge_stamps(own.grid, moved, grid_, cells_utime_, to_utime(own.stamp.time));
    }
    grid_ = own.grid;
    cells_utime_ = std::move(moved);
    next_row_ = forget_row_ = 0;
  }
  if (grid_.rows > 0 && !own.last_seen_utime.empty()) {
    const int rows = (grid_.rows + kGridPeriodSteps - 1) / kGridPeriodSteps;
    for (int i = 0; i < rows; ++i) {
      const auto begin = cells_utime_.begin() + forget_row_ * grid_.columns;
      std::fill_n(begin, grid_.columns, models::VisibilityGrid::kNeverSeen);
      forget_row_ = (forget_row_ + 1) % grid_.rows;
    }
  }
}

std::vector<BeliefSender::Candidate> BeliefSender::candidates(const models::RobotBelief& own,
                                                              std::span<const int> observed) {
  for (auto& [id, known] : known_) {
    known.is_present = false;
  }
  std::vector<Candidate> order;
  for (std::size_t i = 0; i < own.targets.size(); ++i) {
    Known& known = known_[own.targets[i].target_id];
    known.is_present = true;
    const bool is_observed =
        std::find(observed.begin(), observed.end(), own.targets[i].target_id) != observed.end();
    const double gain = gain_of(own.targets[i], known, is_observed, own.stamp.time);
    if (gain >= kGainMin_nats) {
      order.push_back({gain, i});
    }
  }
  // A received target that the filter did not take over is not kept, so that a broken teammate
  // cannot fill the memory.
  std::erase_if(known_, [](const auto& each) { return !each.second.is_present; });
  std::stable_sort(order.begin(), order.end(),
                   [](const Candidate& a, const Candidate& b) { return a.gain > b.gain; });
  return order;
}

std::optional<models::CompactBelief> BeliefSender::select(const models::RobotBelief& own,
                                                          std::span<const int> observed,
                                                          std::size_t payload_max) {
  const Time now = own.stamp.time;
  predict(now);
  std::erase_if(heard_, [&](const auto& each) { return now - each.second > kSilenceMax; });
  follow_grid(own);
  const std::vector<Candidate> order = candidates(own, observed);
  if (payload_max < kPayloadMin) {
    return std::nullopt;
  }
  models::CompactBelief out;
  out.stamp.time = now;
  out.robot = own.robot;
  out.step = own.step;
  out.viewpoint = own.viewpoint;
  out.grid = own.grid;
  const std::size_t head = kHeadBytes + own.robot.size();
  const std::size_t room = payload_max - std::min(payload_max, head);
  std::size_t wanted = 0;
  for (const Candidate& each : order) {
    wanted += target_bytes(static_cast<int>(own.targets[each.index].information.vector.size()));
  }
  const auto reserved = static_cast<std::size_t>(kTargetShare * static_cast<double>(room));
  if (!own.last_seen_utime.empty()) {
    add_cells(own, room - std::min(wanted, reserved), out);
  }
  add_targets(own, order, room - std::min(room, out.runs.size()), out);
  if (out.targets.empty() && out.runs.empty() && now - sent_at_ < kPresencePeriod) {
    return std::nullopt;
  }
  sent_at_ = now;
  return out;
}

}  // namespace vantage::estimator
