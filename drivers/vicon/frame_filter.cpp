#include "drivers/vicon/frame_filter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/index.hpp"
#include "core/utf8.hpp"

namespace vantage::drivers::vicon {
namespace {

/// Datagrams may be reordered by a few frames; a larger step back is a restart of the server.
constexpr std::int32_t kOvertakenMax = 10;
constexpr int kOldNumbersMax = 3;
/// A larger step ahead is a restart of the server, not a loss of frames.
constexpr std::int32_t kLostMax = 10'000;
constexpr Duration kForgetAfter = std::chrono::seconds(60);
/// Largest correction of a capture time that keeps capture times increasing; a larger step back
/// means that the stack's clock was set.
constexpr Duration kClockStep = std::chrono::seconds(1);
constexpr double kMicrosecond_s = 1e-6;
constexpr std::size_t kNameBytesMax = 128;
/// A jump to within this distance of another body counts as a swap of names.
constexpr double kSwapDistance_m = 0.3;
/// A body within this distance of its own prediction is assumed to have the correct name.
constexpr double kOwnPosition_m = 0.05;
/// Minimum reduction per name of the distances to the predictions; a larger reduction proves a swap
/// of names.
constexpr double kSwapGain_m = 0.05;
constexpr std::size_t kComparedMax = 64;

/// True for a name that a message may contain: UTF-8 without control characters.
bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= kNameBytesMax && is_utf8(name) &&
         std::none_of(name.begin(), name.end(), [](char c) {
           const auto byte = static_cast<unsigned char>(c);
           return byte < 0x20 || byte == 0x7F;
         });
}

}  // namespace

FrameFilter::FrameFilter(const GateSettings& gate, Duration latency_assumed, Publish publish)
    : gate_(gate),
      latency_assumed_(latency_assumed),
      publish_(std::move(publish)),
      assignment_(static_cast<int>(kComparedMax), static_cast<int>(kComparedMax)) {
  bodies_.reserve(kBodiesMax);  // pointers into `bodies_` stay valid
  compared_.reserve(kComparedMax);
  predicted_m_.reserve(kBodiesMax);
  cost_m_.reserve(kComparedMax * kComparedMax);
}

void FrameFilter::on_opened() {
  last_number_.reset();
  old_numbers_ = 0;
  clock_.restart();
  waits_since_.reset();
  is_behind_ = false;
  waited_ = echo_taken_ = {};
}

bool FrameFilter::is_next(std::uint32_t number) {
  if (last_number_) {
    // difference modulo 2³², since the counter may wrap
    const auto ahead = static_cast<std::int32_t>(number - *last_number_);
    if (ahead == 0) {
      ++counts_.frames_repeated;
      return false;
    }
    if (ahead < 0 && ahead >= -kOvertakenMax && ++old_numbers_ < kOldNumbersMax) {
      ++counts_.frames_late;
      return false;
    }
    if (ahead < 0 || ahead > kLostMax) {
      ++counts_.server_restarts;
      clock_.restart();
    } else {
      counts_.frames_lost += ahead - 1;
    }
    number_ += ahead;
  }
  old_numbers_ = 0;
  last_number_ = number;
  return true;
}

// Returns the stated latency even if it is long: with the assumed latency, an old frame would
// appear new.
Duration FrameFilter::latency_of(const SeenFrame& seen) {
  if (!seen.latency_s) {
    return latency_assumed_;
  }
  if (!(*seen.latency_s >= 0.0 && *seen.latency_s <= kLatencyPossible_s)) {
    ++counts_.latencies_refused;
    return latency_assumed_;
  }
  return from_seconds(*seen.latency_s);
}

Duration FrameFilter::wait_of(const SeenFrame& seen, Duration latency) {
  if (!seen.number && !seen.server_time_us) {
    return {};
  }
  if (seen.echo && seen.echo->arrived > echo_taken_) {
    echo_taken_ = seen.echo->arrived;
    clock_.on_echo(seen.echo->sent, seen.echo->arrived);
  }
  FrameTiming timing;
  timing.tick = seen.server_time_us.value_or(number_);
  timing.stated_tick_s = seen.server_time_us  ? kMicrosecond_s
                         : seen.rate_hz > 0.0 ? 1.0 / seen.rate_hz
                                              : 0.0;
  timing.sent = seen.sent;
  timing.pinged = seen.echo ? std::optional(seen.echo->sent) : std::nullopt;
  return clock_.lateness(timing, seen.arrival.steady, latency);
}

void FrameFilter::watch_backlog(Duration now) {
  if (waited_ <= kQueuedMax) {
    waits_since_.reset();
  } else if (!waits_since_) {
    waits_since_ = now;
  }
  is_behind_ = waits_since_ && now - *waits_since_ >= kBehindFor;
}

Time FrameFilter::capture_time(Time arrival, Duration since_capture) {
  Time capture = arrival - since_capture;
  // Latencies may jump and frames may arrive simultaneously, but capture times must increase.
  const Time next = last_capture_ + Duration{1};
  if (capture < next && next - capture < kClockStep && next <= arrival) {
    capture = next;
  }
  last_capture_ = capture;
  return capture;
}

FrameFilter::Body* FrameFilter::find(const std::string& name, std::size_t hint) {
  if (hint < bodies_.size() && bodies_[hint].name == name) {
    return &bodies_[hint];  // servers usually send bodies in a constant order
  }
  const auto found = std::find_if(bodies_.begin(), bodies_.end(),
                                  [&](const Body& body) { return body.name == name; });
  return found == bodies_.end() ? nullptr : &*found;
}

FrameFilter::Body* FrameFilter::add(const std::string& name) {
  if (!is_name(name) || bodies_.size() == kBodiesMax) {
    ++counts_.names_refused;
    return nullptr;
  }
  bodies_.push_back({name, PoseGate(gate_)});
  out_.bodies.emplace_back();
  out_.bodies.back().name = name;
  return &bodies_.back();
}

void FrameFilter::accept(const SeenFrame& seen) {
  if (seen.number && !is_next(*seen.number)) {
    return;
  }
  const Duration latency = latency_of(seen);
  waited_ = wait_of(seen, latency);
  watch_backlog(seen.arrival.steady);
  if (waited_ > kWaitedMax || (waited_ > kQueuedMax && !clock_.is_standing())) {
    ++counts_.frames_queued;
    return;
  }
  counts_.frames_waited += waited_ > kQueuedMax ? 1 : 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].is_in_frame = false;
    bodies_[i].is_swapped = false;
    bodies_[i].seen = nullptr;
    out_.bodies[i].occluded = true;
    out_.bodies[i].world_from_body = {};
  }
  const auto listed = seen.bodies();
  for (std::size_t i = 0; i < listed.size(); ++i) {
    Body* body = find(listed[i].name, i);
    body = body == nullptr ? add(listed[i].name) : body;
    if (body == nullptr) {
      continue;
    }
    if (body->is_in_frame) {
      ++counts_.names_twice;
      continue;
    }
    body->is_in_frame = true;
    body->last_listed = seen.arrival.steady;
    body->seen = &listed[i];
  }
  find_swaps(seen.arrival.steady);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].seen != nullptr) {
      place(*bodies_[i].seen, bodies_[i], seen.arrival.steady, out_.bodies[i]);
    }
  }
  forget(seen);
  out_.arrival = seen.arrival.utime;
  out_.stamp.time = capture_time(seen.arrival.utime, latency + waited_);
  out_.frame_number = seen.number ? std::int64_t{*seen.number} : out_.frame_number + 1;
  ++counts_.frames;
  publish_(out_);
}

void FrameFilter::compare(std::size_t body) {
  if (std::find(compared_.begin(), compared_.end(), body) == compared_.end() &&
      compared_.size() < kComparedMax) {
    compared_.push_back(body);
  }
}

// Long function: it selects the bodies, solves one assignment problem and marks swapped bodies.
void FrameFilter::find_swaps(Duration now) {
  const auto has_pose = [&](std::size_t i) {
    return bodies_[i].seen != nullptr && bodies_[i].seen->pose_state == PoseState::kSeen;
  };
  const auto position_m = [&](std::size_t i) -> const Eigen::Vector3d& {
    return bodies_[i].seen->world_from_body.translation_m;
  };
  predicted_m_.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].gate.is_predicted(now)) {
      predicted_m_[i] = bodies_[i].gate.predicted_m(now);
    }
  }
  // Only a body that is away from its own prediction and nearer to another body's prediction can be
  // swapped.
  compared_.clear();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!has_pose(i) || !bodies_[i].gate.is_predicted(now)) {
      continue;
    }
    double nearest_m = (position_m(i) - predicted_m_[i]).norm();
    if (nearest_m <= kOwnPosition_m) {
      continue;
    }
    std::size_t nearest = i;
    for (std::size_t j = 0; j < bodies_.size(); ++j) {
      const bool is_near =
          bodies_[j].gate.is_predicted(now) && (position_m(i) - predicted_m_[j]).norm() < nearest_m;
      nearest_m = is_near ? (position_m(i) - predicted_m_[j]).norm() : nearest_m;
      nearest = is_near ? j : nearest;
    }
    if (nearest != i) {
      compare(i);
      compare(nearest);
    }
  }
  std::partition(compared_.begin(), compared_.end(), has_pose);
  const auto rows =
      static_cast<std::size_t>(std::count_if(compared_.begin(), compared_.end(), has_pose));
  cost_m_.clear();
  double as_named_m = 0.0;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < compared_.size(); ++column) {
      cost_m_.push_back((position_m(compared_[row]) - predicted_m_[compared_[column]]).norm());
    }
    as_named_m += cost_m_[row * compared_.size() + row];
  }
  const auto columns =
      assignment_.solve(cost_m_, static_cast<int>(rows), static_cast<int>(compared_.size()));
  double as_assigned_m = 0.0;
  int changed = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    as_assigned_m += cost_m_[row * compared_.size() + index(columns[row])];
    changed += columns[row] == static_cast<int>(row) ? 0 : 1;
  }
  if (changed == 0 || as_named_m - as_assigned_m <= kSwapGain_m * changed) {
    return;
  }
  for (std::size_t row = 0; row < rows; ++row) {
    bodies_[compared_[row]].is_swapped = columns[row] != static_cast<int>(row);
  }
}

void FrameFilter::forget(const SeenFrame& seen) {
  for (std::size_t i = bodies_.size(); i-- > 0;) {
    const bool is_gone = seen.is_complete_list
                             ? !bodies_[i].is_in_frame
                             : seen.arrival.steady - bodies_[i].last_listed > kForgetAfter;
    if (is_gone) {
      bodies_.erase(bodies_.begin() + static_cast<std::ptrdiff_t>(i));
      out_.bodies.erase(out_.bodies.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

void FrameFilter::place(const SeenBody& seen, Body& body, Duration now, models::MocapBody& out) {
  out.occluded = !is_good(seen, body, now);
  if (!out.occluded) {
    out.world_from_body = seen.world_from_body;
  } else {
    out.world_from_body = {};
  }
}

bool FrameFilter::is_good(const SeenBody& seen, Body& body, Duration now) {
  switch (seen.pose_state) {
    case PoseState::kAbsent:
      return false;
    case PoseState::kZero:
      ++counts_.poses_zero;
      return false;
    case PoseState::kNotAPose:
      ++counts_.poses_refused;
      return false;
    case PoseState::kSeen:
      break;
  }
  const auto is_other = [&](const Eigen::Vector3d& position_m) {
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& other) {
      return &other != &body && other.gate.last() &&
             now - other.gate.last_time() <= gate_.lost_after &&
             (other.gate.last()->translation_m - position_m).norm() < kSwapDistance_m;
    });
  };
  switch (body.gate.judge(now, seen.world_from_body, is_other, body.is_swapped)) {
    case Verdict::kGood:
      return true;
    case Verdict::kStuck:
      ++counts_.poses_stuck;
      return false;
    case Verdict::kOutlier:
      ++(body.gate.is_swap_suspected() ? counts_.poses_swapped : counts_.poses_outlying);
      return false;
    case Verdict::kFlip:
      ++counts_.poses_flipped;
      return false;
    case Verdict::kUnconfirmed:
      ++counts_.poses_unconfirmed;
      return false;
  }
  return false;
}

}  // namespace vantage::drivers::vicon
