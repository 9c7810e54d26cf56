#include "localizer/robot_localizer.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/check.hpp"

namespace vantage::localizer {
namespace {

/// Maximum delay of a sighting after its corrected time, in increments (kIncrement).
constexpr std::int64_t kLatencyCells = 2;
/// Factor of the variances of a motion that is guessed from the previous one.
constexpr double kGuessNoiseScale = 30.0;
// 1σ of the change of a robot's speed and turn rate per second, and limits of this change.
constexpr double kGuessAcceleration_mps2 = 1.0;
constexpr double kGuessSpeedMax_mps = 0.5;
constexpr double kGuessTurnAcceleration_radps2 = 2.0;
constexpr double kGuessTurnMax_radps = 1.0;
constexpr double kAgeMaxS = 1e6;  // s; age reported if there was no observation

/// Returns the displacement during the share [from, to) of a motion with a constant twist, in the
/// body frame at the start of this share.
Eigen::Vector3d part_of(const Eigen::Vector3d& motion, double from, double to) {
  const double angle_rad = from * motion.z();
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return (to - from) * Eigen::Vector3d(c * motion.x() + s * motion.y(),
                                       -s * motion.x() + c * motion.y(), motion.z());
}

/// Returns the variance that the error of a guessed motion gains between `from_s` and `to_s` after
/// the last known motion. The error is that of a constant acceleration, until the limit of speed.
double guess_variance(double from_s, double to_s, double acceleration, double speed_max) {
  const auto sigma = [&](double t_s) {
    return std::min(0.5 * acceleration * t_s * t_s, speed_max * t_s);
  };
  return sigma(to_s) * sigma(to_s) - sigma(from_s) * sigma(from_s);
}

/// Returns the total displacement of `first` followed by `second`.
Eigen::Vector3d followed_by(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  const double c = std::cos(first.z());
  const double s = std::sin(first.z());
  return first + Eigen::Vector3d(c * second.x() - s * second.y(), s * second.x() + c * second.y(),
                                 second.z());
}

}  // namespace

std::int64_t RobotLocalizer::cell_of(Time time) {
  const std::int64_t us = to_utime(time);
  const std::int64_t width = kIncrement.count();
  return us >= 0 ? us / width : (us - width + 1) / width;
}

Time RobotLocalizer::start_of(std::int64_t cell) { return from_utime(cell * kIncrement.count()); }

RobotLocalizer::RobotLocalizer(const scenario::LocalizerSpec& spec, int robot)
    : spec_(spec),
      robot_(robot),
      motion_([&] {
        require(robot >= 0 && robot < static_cast<int>(spec.robots.size()),
                "robot must be an index of localizer.robots");
        return spec.robots[static_cast<std::size_t>(robot)].drive;
      }()),
      tracks_(spec.robots.size()),
      base_(spec),
      newest_(spec),
      increments_(spec.robots.size(), Eigen::Vector3d::Zero()),
      guesses_(spec.robots.size()),
      next_sighting_(spec.robots.size(), 0),
      next_fix_(spec.robots.size(), 0) {
  for (Track& track : tracks_) {
    track.sightings.reserve(kSightings);
    track.fixes.reserve(kFixes);
  }
}

void RobotLocalizer::place(int robot, const Pose2& world_from_body,
                           const Eigen::Matrix3d& covariance) {
  base_.place(robot, world_from_body, covariance);
}

void RobotLocalizer::add_increment(std::int64_t cell, Track& track,
                                   const Eigen::Vector3d& increment) {
  track.cells[static_cast<std::size_t>(cell % kCells)] = {cell, increment};
  track.newest = std::max(track.newest, cell);
}

void RobotLocalizer::add_odometry(const models::OdometryReport& odometry) {
  if (odometry.kind == models::OdometryKind::kCommand) {
    counts_.refused +=
        motion_.command(odometry.stamp.time, odometry.motion_body.x(), odometry.motion_body.z())
            ? 0
            : 1;
    return;
  }
  is_commanded_ = false;
  const Time end = odometry.stamp.time;
  const Time start = end - odometry.interval;
  if (start < partial_to_ || start < Time{}) {
    ++counts_.refused;
    return;
  }
  // Divides the increment among the cells that it overlaps. After a gap, the first cell is complete
  // only if the increment begins with it.
  if (start != partial_to_) {
    partial_.setZero();
    is_partial_whole_ = start == start_of(cell_of(start));
  }
  const double whole_s = to_seconds(odometry.interval);
  for (Time from = start; from < end;) {
    const std::int64_t cell = cell_of(from);
    const Time to = std::min(end, start_of(cell + 1));
    partial_ =
        followed_by(partial_, part_of(odometry.motion_body, to_seconds(from - start) / whole_s,
                                      to_seconds(to - start) / whole_s));
    if (to == start_of(cell + 1)) {
      if (is_partial_whole_) {
        add_increment(cell, own(), partial_);
      }
      partial_.setZero();
      is_partial_whole_ = true;
    }
    from = to;
  }
  partial_to_ = end;
}

void RobotLocalizer::add_sighting(Track& track, const models::Sighting& sighting) {
  // A sensor reports an identified body once per frame, but several bodies without an id.
  const auto key = [](const models::Sighting& each) {
    return std::tuple(each.time, each.id, each.id == kNoBodyId ? each.bearing_rad : 0.0);
  };
  const auto after = std::upper_bound(
      track.sightings.begin(), track.sightings.end(), sighting,
      [&](const models::Sighting& a, const models::Sighting& b) { return key(a) < key(b); });
  if (after != track.sightings.begin() && key(*std::prev(after)) == key(sighting)) {
    return;  // known from an earlier message
  }
  if (track.sightings.size() == static_cast<std::size_t>(kSightings)) {
    ++counts_.lost_sightings;
    return;
  }
  track.sightings.insert(after, sighting);
}

void RobotLocalizer::add_sightings(std::span<const models::Sighting> sightings) {
  for (const models::Sighting& sighting : sightings) {
    counts_.late_sightings += sighting.time < start_of(base_cell_) ? 1 : 0;
    add_sighting(own(), sighting);
    last_observation_ = std::max(last_observation_, sighting.time);
  }
}

void RobotLocalizer::add_fix(int robot, Time time, const PoseBelief& fix) {
  std::vector<Fix>& fixes = tracks_[static_cast<std::size_t>(robot)].fixes;
  // A fix at the end of a cell belongs to this cell, so that the estimate at that time contains it.
  time -= Duration{1};
  if (time < start_of(base_cell_) || (!fixes.empty() && time <= fixes.back().time)) {
    ++counts_.late_fixes;
    return;
  }
  if (fixes.size() == static_cast<std::size_t>(kFixes)) {
    fixes.erase(fixes.begin());
  }
  fixes.push_back({time, fix});
  if (robot == robot_) {
    last_fix_ = time;
    last_observation_ = std::max(last_observation_, time);
  }
}

void RobotLocalizer::add_teammate(const models::PoseEstimate& estimate) {
  const auto mate = std::find_if(
      spec_.robots.begin(), spec_.robots.end(),
      [&](const scenario::LocalizedRobotSpec& each) { return each.name == estimate.robot; });
  const auto index = static_cast<int>(mate - spec_.robots.begin());
  const std::int64_t first = cell_of(estimate.increments_from);
  const auto increments = static_cast<std::int64_t>(estimate.increments.size());
  if (mate == spec_.robots.end() || index == robot_ || estimate.increment != kIncrement ||
      estimate.increments_from != start_of(first) || first < 0 || increments > kMessageIncrements ||
      first + increments > cell_of(estimate.stamp.time)) {
    ++counts_.refused;
    return;
  }
  Track& track = tracks_[static_cast<std::size_t>(index)];
  std::int64_t cell = first;
  for (const Eigen::Vector3d& increment : estimate.increments) {
    if (cell >= base_cell_) {
      add_increment(cell, track, increment);
    }
    ++cell;
  }
  const std::int64_t known_until = std::max(track.complete_until, base_cell_);
  if (first <= known_until) {
    track.complete_until = std::max(track.complete_until, cell - kLatencyCells);
  }
  for (const models::Sighting& sighting : estimate.sightings) {
    if (sighting.time >= start_of(base_cell_)) {
      add_sighting(track, sighting);
    }
  }
}

void RobotLocalizer::set_increments(std::int64_t cell, Time from, Time to, bool is_base) {
  const double width_s = to_seconds(kIncrement);
  const double from_share = to_seconds(from - start_of(cell)) / width_s;
  const double to_share = to_seconds(to - start_of(cell)) / width_s;
  for (std::size_t robot = 0; robot < tracks_.size(); ++robot) {
    const Track& track = tracks_[robot];
    guesses_[robot] = {};
    // An unknown increment is assumed to equal the newest earlier one.
    std::int64_t last_known =
        std::max(std::min(track.newest, cell - kMessageIncrements), first_cell_ - 1);
    Eigen::Vector3d whole = Eigen::Vector3d::Zero();
    for (std::int64_t known = cell; known >= 0 && known > cell - kMessageIncrements; --known) {
      const Cell& candidate = track.cells[static_cast<std::size_t>(known % kCells)];
      if (candidate.index == known) {
        whole = candidate.increment;
        last_known = known;
        break;
      }
    }
    if (last_known < cell) {
      const Time known_until = start_of(last_known + 1);
      const double from_s = to_seconds(from - known_until);
      const double to_s = to_seconds(to - known_until);
      guesses_[robot] = {
          kGuessNoiseScale,
          guess_variance(from_s, to_s, kGuessAcceleration_mps2, kGuessSpeedMax_mps),
          guess_variance(from_s, to_s, kGuessTurnAcceleration_radps2, kGuessTurnMax_radps)};
      counts_.missing_increments += is_base && from == start_of(cell) ? 1 : 0;
    }
    increments_[robot] = part_of(whole, from_share, to_share);
  }
}

void RobotLocalizer::seek(Time time) {
  for (std::size_t robot = 0; robot < tracks_.size(); ++robot) {
    const auto first_from = [time](const auto& items) {
      const auto next = std::lower_bound(items.begin(), items.end(), time,
                                         [](const auto& item, Time t) { return item.time < t; });
      return static_cast<std::size_t>(next - items.begin());
    };
    next_sighting_[robot] = first_from(tracks_[robot].sightings);
    next_fix_[robot] = first_from(tracks_[robot].fixes);
  }
}

RobotLocalizer::Event RobotLocalizer::next_event(Time end) const {
  Event event{end, tracks_.size(), false};
  for (std::size_t robot = 0; robot < tracks_.size(); ++robot) {
    const auto& sightings = tracks_[robot].sightings;
    if (next_sighting_[robot] < sightings.size() &&
        sightings[next_sighting_[robot]].time < event.time) {
      event = {sightings[next_sighting_[robot]].time, robot, false};
    }
  }
  for (std::size_t robot = 0; robot < tracks_.size(); ++robot) {
    const auto& fixes = tracks_[robot].fixes;
    if (next_fix_[robot] < fixes.size() && fixes[next_fix_[robot]].time < event.time) {
      event = {fixes[next_fix_[robot]].time, robot, true};
    }
  }
  return event;
}

void RobotLocalizer::apply(TeamFilter& filter, const Event& event, bool is_base) {
  Track& track = tracks_[event.robot];
  const int robot = static_cast<int>(event.robot);
  if (event.is_fix) {
    const PoseBelief& fix = track.fixes[next_fix_[event.robot]++].belief;
    filter.place(robot, fix.world_from_body, fix.covariance);
    if (is_base) {
      track.search.clear();
    }
    return;
  }
  const std::size_t first = next_sighting_[event.robot];
  std::size_t last = first;
  while (last < track.sightings.size() && track.sightings[last].time == event.time) {
    ++last;
  }
  next_sighting_[event.robot] = last;
  const std::span<const models::Sighting> frame(track.sightings.data() + first, last - first);
  if (is_base && !filter.is_placed(robot)) {
    if (const auto start = track.search.observe(spec_, robot, frame)) {
      filter.place(robot, start->world_from_body, start->covariance);
      track.search.clear();
    }
  } else {
    filter.observe(robot, frame);
  }
}

void RobotLocalizer::run(TeamFilter& filter, std::int64_t from, std::int64_t to, bool is_base) {
  seek(start_of(from));
  for (std::int64_t cell = from; cell < to; ++cell) {
    const Time end = start_of(cell + 1);
    for (Time time = start_of(cell); time < end;) {
      const Event event = next_event(end);
      if (event.time > time) {
        set_increments(cell, time, event.time, is_base);
        const double duration_s = to_seconds(event.time - time);
        filter.advance(duration_s, increments_, guesses_);
        for (std::size_t robot = 0; is_base && robot < tracks_.size(); ++robot) {
          tracks_[robot].search.advance(duration_s, increments_[robot]);
        }
        time = event.time;
      }
      if (event.robot < tracks_.size()) {
        apply(filter, event, is_base);
      }
    }
  }
}

void RobotLocalizer::forget_before(Time time) {
  for (Track& track : tracks_) {
    const auto keep = std::lower_bound(
        track.sightings.begin(), track.sightings.end(), time,
        [](const models::Sighting& sighting, Time t) { return sighting.time < t; });
    track.sightings.erase(track.sightings.begin(), keep);
    std::erase_if(track.fixes, [&](const Fix& fix) { return fix.time < time; });
  }
}

void RobotLocalizer::advance_to(Time now) {
  const std::int64_t cell = cell_of(now);
  if (cell <= now_cell_) {
    return;
  }
  if (base_cell_ < 0) {
    first_cell_ = cell;
    base_cell_ = cell;
    now_cell_ = cell;
    static_cast<void>(motion_.advance_to(start_of(cell)));
  }
  for (; now_cell_ < cell; ++now_cell_) {
    if (is_commanded_) {
      add_increment(now_cell_, own(), motion_.advance_to(start_of(now_cell_ + 1)));
    }
  }
  now_ = start_of(cell);

  // The base filter waits for the data of each robot that sent any in the last kMessageIncrements
  // steps.
  own().complete_until = cell - kLatencyCells;
  const std::int64_t oldest = cell - kMessageIncrements;
  std::int64_t complete = cell - kLatencyCells;
  for (const Track& track : tracks_) {
    if (track.complete_until >= oldest) {
      complete = std::min(complete, track.complete_until);
    }
  }
  if (complete > base_cell_) {
    run(base_, base_cell_, complete, true);
    base_cell_ = complete;
  }
  newest_.assign(base_);
  run(newest_, base_cell_, cell, false);
  forget_before(std::min(start_of(base_cell_), start_of(oldest)));
}

void RobotLocalizer::write_message(models::PoseEstimate& message) const {
  const std::int64_t first = std::max<std::int64_t>(now_cell_ - kMessageIncrements, 0);
  message.robot = spec_.robots[static_cast<std::size_t>(robot_)].name;
  message.stamp.time = now_;
  const bool is_fixed = last_fix_ != Time::min() && now_ - last_fix_ <= 2 * kIncrement;
  message.source = !is_placed() ? models::PoseSource::kNone
                   : is_fixed   ? models::PoseSource::kMotionCapture
                                : models::PoseSource::kLocalizer;
  message.world_from_body = is_placed() ? pose() : Pose2{};
  message.covariance = is_placed() ? covariance() : Eigen::Matrix3d::Identity();
  const auto& sightings = own().sightings;
  message.age_s = last_observation_ == Time::min()
                      ? kAgeMaxS
                      : std::clamp(to_seconds(now_ - last_observation_), 0.0, kAgeMaxS);
  message.increment = kIncrement;
  message.increments.clear();
  message.increments_from = start_of(first);
  const auto at = [this](std::int64_t cell) -> const Cell& {
    return own().cells[static_cast<std::size_t>(cell % kCells)];
  };
  // The newest cells are unknown until the next report of the odometer.
  std::int64_t last = now_cell_;
  while (last > first && at(last - 1).index != last - 1) {
    --last;
  }
  for (std::int64_t cell = first; cell < last; ++cell) {
    if (at(cell).index == cell) {
      message.increments.push_back(at(cell).increment);
    } else {  // a gap: begin after it
      message.increments.clear();
      message.increments_from = start_of(cell + 1);
    }
  }
  message.sightings.clear();
  const std::size_t count = std::min(sightings.size(), static_cast<std::size_t>(kMessageSightings));
  message.sightings.assign(sightings.end() - static_cast<std::ptrdiff_t>(count), sightings.end());
}

}  // namespace vantage::localizer
