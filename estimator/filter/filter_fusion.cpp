#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Cholesky>

#include "estimator/filter/distributed_filter.hpp"
#include "estimator/posterior/confinement.hpp"

// Fusion of teammates' beliefs.

namespace vantage::estimator {
namespace {

/// Returns √det Ω, the weight of a belief in a fusion; 0 when Ω is not positive definite.
double weight_of(const models::StateMatrix& Omega) {
  const Eigen::LLT<models::StateMatrix> root(Omega);
  return root.info() == Eigen::Success ? root.matrixLLT().diagonal().prod() : 0.0;
}

/// Returns the κ in [0, 1] that maximises det((1 − κ) A + κ B). log det is concave in κ, so its
/// slope tr((B − A) Ω⁻¹) decreases. Bisection finds the zero of the slope to 1/4096.
double intersection_weight(const models::StateMatrix& A, const models::StateMatrix& B) {
  const models::StateMatrix D = B - A;
  const auto is_rising = [&](double kappa) {
    const Eigen::LLT<models::StateMatrix> root(A + kappa * D);
    return root.info() == Eigen::Success && root.solve(D).trace() > 0.0;
  };
  if (!is_rising(0.0)) {
    return 0.0;
  }
  if (is_rising(1.0)) {
    return 1.0;
  }
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (low + high);
    (is_rising(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

void DistributedFilter::collect_beliefs(const StepInput& input, StepRecord& record) {
  in_range_.clear();
  const Duration age_max = from_seconds(spec_.belief_age_max_s);
  for (const models::RobotBelief* belief : input.beliefs) {
    if (belief->stamp.time > input.time) {
      ++counters_.future_beliefs;
    } else if (input.time - belief->stamp.time > age_max) {
      ++counters_.stale_beliefs;
    } else if (spec_.communication_range_m <= 0.0 ||
               distance_m(belief->viewpoint, viewpoint_) > spec_.communication_range_m) {
      ++counters_.out_of_range_beliefs;
    } else {
      in_range_.push_back(belief);
    }
  }
  degree_ = static_cast<int>(in_range_.size());
  for (const models::RobotBelief* belief : in_range_) {
    record.has_belief_of_end = record.has_belief_of_end || belief->stamp.time == input.time;
    if (multi_target_) {
      add_labelled_belief(*belief, record);
    } else {
      add_belief(*belief, record);
    }
    merge_grid(*belief);
  }
}

std::optional<models::Information> DistributedFilter::kept_inside(
    const models::Information& information) const {
  const auto belief = models::to_gaussian(information);
  if (!spec_.estimator.targets_stay_inside || !belief) {
    return information;
  }
  const models::Gaussian inside = confine(*belief, free_space_);
  const bool is_same = inside.mean == belief->mean && inside.covariance == belief->covariance;
  return is_same ? information : models::to_information(inside);
}

void DistributedFilter::add_belief(const models::RobotBelief& belief, StepRecord& record) {
  // The first step (no time_) starts without tracks, and the belief may contain observations made
  // since the start of the step.
  const bool is_of_start = time_ && belief.stamp.time <= record.from;
  const Time now = is_of_start ? record.from : record.to;
  ReceivedTable& all_received = is_of_start ? record.received_at_start : record.received_at_end;
  for (const models::TargetBelief& target : belief.targets) {
    if (target.target_id < 0 || target.target_id >= spec_.target_count) {
      ++counters_.unknown_ids;
      continue;
    }
    const int dim = spec_.estimator.target_model.dim();
    if (target.information.vector.size() != dim || target.information.matrix.rows() != dim ||
        target.information.matrix.cols() != dim) {
      ++counters_.malformed_beliefs;
      continue;
    }
    auto now_known = propagate(spec_.estimator.target_model, spec_.step_s, target.information,
                               target.last_seen, belief.stamp.time, now);
    // Without kept_inside(), a belief predicted into a wall would be too confident.
    if (now_known && belief.stamp.time < now) {
      now_known = kept_inside(*now_known);
    }
    if (!now_known) {
      ++counters_.singular;
      continue;
    }
    const double weight = weight_of(now_known->matrix);
    if (!(weight > 0.0) || !std::isfinite(weight)) {
      ++counters_.singular;
      continue;
    }
    ReceivedTrack* const received = all_received.find(target.target_id);
    if (received == nullptr) {
      all_received.put(
          {target.target_id,
           {true, {weight * now_known->vector, weight * now_known->matrix}, target.last_seen},
           weight});
    } else {
      received->track.information.vector += weight * now_known->vector;
      received->track.information.matrix += weight * now_known->matrix;
      received->track.last_seen = std::max(received->track.last_seen, target.last_seen);
      received->weight += weight;
    }
  }
}

void DistributedFilter::add_labelled_belief(const models::RobotBelief& belief, StepRecord& record) {
  const Time belief_at = belief.stamp.time;
  if (belief_at < record.from) {
    return;  // belief of a step that was reconciled already, or too old
  }
  // A belief of instant `from` contains no observation of this step and is used before them. A
  // later belief is used after all of them.
  const Time at = belief_at == record.from && record.from < record.to ? record.from : record.to;
  const models::TargetModel& model = spec_.estimator.target_model;
  const int sender = record.received_labels.empty() ? 0 : record.received_labels.back().sender + 1;
  for (const models::TargetBelief& target : belief.targets) {
    const auto believed = target.information.vector.size() == model.dim()
                              ? models::to_gaussian(target.information)
                              : std::nullopt;
    if (target.target_id < models::kTrackLabelMin) {
      ++counters_.unknown_ids;
    } else if (!believed || record.received_labels.size() >= spec_.team.size() * labelled_.size()) {
      ++counters_.malformed_beliefs;  // more tracks than any teammate in this scenario sends
    } else {
      record.received_labels.push_back(
          {sender, at, target.target_id,
           models::predict_unseen(*believed, model, to_seconds(at - belief_at),
                                  to_seconds(belief_at - target.last_seen), spec_.step_s),
           target.last_seen});
    }
  }
}

void DistributedFilter::merge_grid(const models::RobotBelief& belief) {
  if (belief.last_seen_utime.empty()) {
    return;
  }
  // No cell can have been seen after the instant of the message.
  const bool is_one_grid = spec_.neighbourhood_m > 0.0 || belief.grid == grid_.geometry();
  if (!is_one_grid ||
      !grid_.merge(belief.grid, belief.last_seen_utime, to_utime(belief.stamp.time))) {
    ++counters_.grid_mismatches;
  }
}

void DistributedFilter::fuse(const ReceivedTable& all_received) {
  for (const auto& [target_id, received, received_weight] : all_received) {
    const models::Information theirs{received.information.vector / received_weight,
                                     received.information.matrix / received_weight};
    KnownTrack* const known = tracks_.find(target_id);
    if (known == nullptr) {
      tracks_.put({target_id, {true, theirs, received.last_seen}});
      continue;
    }
    Track& own = known->track;
    if (received.last_seen < own.doubted) {
      continue;  // the belief is older than the doubted detection; it would undo doubt()
    }
    // Without a newer detection, the teammates' beliefs differ only in missed detections. Beliefs
    // contain only moments; if moments differ, the more confident ones are more likely to be wrong.
    if (!known->samples.empty() && received.last_seen <= own.last_seen) {
      continue;
    }
    const double kappa = intersection_weight(own.information.matrix, theirs.matrix);
    const models::Information both{
        own.information.vector + kappa * (theirs.vector - own.information.vector),
        own.information.matrix + kappa * (theirs.matrix - own.information.matrix)};
    if (kappa > 0.0) {
      known->samples.clear();
      own.information = both;
      own.last_seen = std::max(own.last_seen, received.last_seen);
    }
  }
}

void DistributedFilter::reconcile_labels(const StepRecord& record, Time at) {
  received_labels_.assign(record.received_labels.begin(), record.received_labels.end());
  const std::span<ReceivedLabel> all(received_labels_);
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].sender == all[begin].sender) {
      ++end;
    }
    if (all[begin].at == at) {
      const Reconciled done = reconcile(labelled_, all.subspan(begin, end - begin));
      counters_.reconciled.relabelled += done.relabelled;
      counters_.reconciled.adopted += done.adopted;
      counters_.reconciled.taken_over += done.taken_over;
    }
  }
}

}  // namespace vantage::estimator
