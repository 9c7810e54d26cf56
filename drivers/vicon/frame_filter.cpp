#include "drivers/vicon/frame_filter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/utf8.hpp"

namespace vantage::drivers::vicon {
namespace {

/// Datagrams overtake each other by a few frames; farther back is a server that began anew.
constexpr std::int32_t kOvertakenMax = 10;
constexpr int kOldNumbersMax = 3;
/// A jump ahead by more is a server that began anew, not frames that were lost.
constexpr std::int32_t kLostMax = 10'000;
constexpr Duration kForgetAfter = std::chrono::seconds(60);
/// Captures may be put right by less; beyond it the stack's clock has been set.
constexpr Duration kClockStep = std::chrono::seconds(1);
constexpr std::size_t kNameBytesMax = 128;
/// As near to another body as this, a jump is a swap of names.
constexpr double kSwapDistance_m = 0.3;

/// UTF-8 without control characters: what a message may carry.
bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= kNameBytesMax && is_utf8(name) &&
         std::none_of(name.begin(), name.end(), [](char c) {
           const auto byte = static_cast<unsigned char>(c);
           return byte < 0x20 || byte == 0x7F;
         });
}

}  // namespace

FrameFilter::FrameFilter(const GateSettings& gate, Duration latency_assumed, Publish publish)
    : gate_(gate), latency_assumed_(latency_assumed), publish_(std::move(publish)) {
  bodies_.reserve(kBodiesMax);  // pointers into it stay good
}

void FrameFilter::on_opened() {
  last_number_.reset();
  old_numbers_ = 0;
  clock_.restart();
}

bool FrameFilter::is_next(std::uint32_t number) {
  if (last_number_) {
    // Modulo 2³²: the counter may wrap.
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

// Too long a latency is not answered by the assumed one, which is short: a frame would be said to
// be new the older it is, and whoever holds because frames are late would fly on.
Duration FrameFilter::latency_of(const SeenFrame& seen) {
  if (!seen.latency_s) {
    return latency_assumed_;
  }
  if (!(*seen.latency_s >= 0.0 && *seen.latency_s <= kLatencyPossible_s)) {
    ++counts_.latencies_refused;
    return latency_assumed_;
  }
  counts_.latencies_bounded += *seen.latency_s > kLatencyMax_s ? 1 : 0;
  return from_seconds(std::min(*seen.latency_s, kLatencyMax_s));
}

Duration FrameFilter::waited(const SeenFrame& seen, Duration latency) {
  if (!seen.number && !seen.server_time_us) {
    return {};
  }
  const std::int64_t tick = seen.number ? number_ : *seen.server_time_us;
  return clock_.lateness(tick, seen.arrival.steady - latency);
}

Time FrameFilter::capture_time(Time arrival, Duration since_capture) {
  Time capture = arrival - since_capture;
  // Latencies jump, and frames of one instant arrive together; time must not stand still for that.
  const Time next = last_capture_ + Duration{1};
  if (capture < next && next - capture < kClockStep && next <= arrival) {
    capture = next;
  }
  last_capture_ = capture;
  return capture;
}

FrameFilter::Body* FrameFilter::find(const std::string& name, std::size_t hint) {
  if (hint < bodies_.size() && bodies_[hint].name == name) {
    return &bodies_[hint];  // servers keep their order, mostly
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
  const Duration waited_for = waited(seen, latency);
  if (waited_for > kQueuedMax) {
    ++counts_.frames_queued;
    return;
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].is_in_frame = false;
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
    place(listed[i], *body, seen.arrival.steady,
          out_.bodies[static_cast<std::size_t>(body - bodies_.data())]);
  }
  forget(seen);
  out_.arrival = seen.arrival.utime;
  out_.stamp.time = capture_time(seen.arrival.utime, latency + waited_for);
  out_.frame_number = seen.number ? std::int64_t{*seen.number} : out_.frame_number + 1;
  ++counts_.frames;
  publish_(out_);
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
  switch (seen.sight) {
    case Sight::kAbsent:
      return false;
    case Sight::kZero:
      ++counts_.poses_zero;
      return false;
    case Sight::kNotAPose:
      ++counts_.poses_refused;
      return false;
    case Sight::kSeen:
      break;
  }
  const auto is_other = [&](const Eigen::Vector3d& position_m) {
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& other) {
      return &other != &body && other.gate.last() &&
             now - other.gate.last_time() <= gate_.lost_after &&
             (other.gate.last()->translation_m - position_m).norm() < kSwapDistance_m;
    });
  };
  switch (body.gate.judge(now, seen.world_from_body, is_other)) {
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
