#include "localizer/judge/judge.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "core/check.hpp"
#include "localizer/judge/score.hpp"
#include "localizer/team_smoother.hpp"

namespace vantage::localizer {
namespace {

constexpr double kUnjudgedS = 60.0;                       // s; not judged after an unknown start
constexpr double kStartSigma = 0.01;                      // m and rad; 1σ of a known start
const Duration kHindsightPass = std::chrono::seconds(2);  // time between two passes of the smoother

struct Span {
  std::int64_t first = 0;  ///< index of the first instant; instants are kIncrement apart
  std::int64_t last = 0;
};

Time time_of(std::int64_t step) { return from_utime(step * kIncrement.count()); }

Span span_of(const Recording& recording) {
  Time begin = Time::min();
  Time end = Time::max();
  for (const RobotRecording& robot : recording) {
    require(!robot.odometry.empty(), "every robot must have odometry");
    begin = std::max(begin, robot.odometry.front().stamp.time);
    end = std::min(end, robot.odometry.back().stamp.time);
  }
  const std::int64_t width = kIncrement.count();
  const Span span{(to_utime(begin) + width - 1) / width, to_utime(end) / width};
  require(span.first < span.last, "the robots' odometry must overlap in time");
  return span;
}

/// Returns the first true pose at or after `time`.
Pose2 start_of(const TruePath& truth, Time time) {
  for (; time <= truth.end(); time += std::chrono::milliseconds(10)) {
    if (const auto pose = truth.at(time)) {
      return *pose;
    }
  }
  throw UsageError("a known start requires a true pose after the start of the evaluated time");
}

/// Calls `use` once for each frame stamped ≤ `until`, starting at frame `next`. The sightings
/// passed to `use` have corrected times.
void pass_frames(const RobotRecording& robot, const scenario::SightingSpec& camera,
                 std::size_t& next, Time until,
                 const std::function<void(std::span<const models::Sighting>)>& use) {
  for (; next < robot.frames.size() && robot.frames[next].stamp <= until; ++next) {
    std::vector<models::Sighting> corrected = robot.frames[next].sightings;
    for (models::Sighting& sighting : corrected) {
      sighting.time = robot.frames[next].stamp - from_seconds(camera.stamp_delay_s);
    }
    use(corrected);
  }
}

/// Returns the number of bytes of a POSE message without header.
std::size_t bytes_of(const models::PoseEstimate& message) {
  constexpr std::size_t kFixed = 190;
  return kFixed + 24 * message.increments.size() + 28 * message.sightings.size();
}

/// Indices of the next inputs of a robot in its recording.
struct Cursor {
  std::size_t odometry = 0;
  std::size_t frame = 0;
};

/// Passes the inputs of one robot stamped ≤ `now` to its localiser.
void add_inputs(const RobotRecording& inputs, const scenario::SightingSpec& camera, Time now,
                Cursor& cursor, RobotLocalizer& localizer) {
  for (; cursor.odometry < inputs.odometry.size() &&
         inputs.odometry[cursor.odometry].stamp.time <= now;
       ++cursor.odometry) {
    localizer.add_odometry(inputs.odometry[cursor.odometry]);
  }
  pass_frames(inputs, camera, cursor.frame, now,
              [&](std::span<const models::Sighting> frame) { localizer.add_sightings(frame); });
}

/// Exchanges one message of each robot; each receiver misses it with the probability `loss`.
/// Returns the number of bytes sent.
std::size_t exchange(std::vector<RobotLocalizer>& localizers, double loss, std::mt19937_64& rng,
                     models::PoseEstimate& message) {
  std::uniform_real_distribution<double> uniform;
  std::size_t bytes = 0;
  for (std::size_t from = 0; from < localizers.size(); ++from) {
    localizers[from].write_message(message);
    bytes += bytes_of(message);
    for (std::size_t to = 0; to < localizers.size(); ++to) {
      if (to != from && uniform(rng) >= loss) {
        localizers[to].add_teammate(message);
      }
    }
  }
  return bytes;
}

JudgeFigures judge_team(const scenario::LocalizerSpec& spec, const Recording& recording,
                        const JudgeOptions& options, const std::vector<bool>& trusted) {
  const Span span = span_of(recording);
  const std::size_t robots = recording.size();
  std::vector<RobotLocalizer> localizers;
  for (std::size_t robot = 0; robot < robots; ++robot) {
    RobotLocalizer& localizer = localizers.emplace_back(spec, static_cast<int>(robot));
    for (std::size_t each = 0; options.is_start_known && each < robots; ++each) {
      localizer.place(static_cast<int>(each), start_of(recording[each].truth, time_of(span.first)),
                      kStartSigma * kStartSigma * Eigen::Matrix3d::Identity());
    }
  }
  Score score(recording, trusted, options);
  std::mt19937_64 rng(options.seed);
  std::vector<Cursor> cursors(robots);
  for (std::size_t robot = 0; robot < robots; ++robot) {
    pass_frames(recording[robot], spec.robots[robot].sightings, cursors[robot].frame,
                time_of(span.first) - Duration{1}, [](auto) {});
  }
  models::PoseEstimate message;
  std::vector<double> placed_after_s(robots, -1.0);
  std::size_t bytes = 0;
  for (std::int64_t step = span.first; step <= span.last; ++step) {
    const Time now = time_of(step);
    for (std::size_t robot = 0; robot < robots; ++robot) {
      RobotLocalizer& localizer = localizers[robot];
      add_inputs(recording[robot], spec.robots[robot].sightings, now, cursors[robot], localizer);
      localizer.advance_to(now);
      const double since_s = to_seconds(now - time_of(span.first));
      if (localizer.is_placed() && placed_after_s[robot] < 0.0) {
        placed_after_s[robot] = since_s;
      }
      if (!options.is_start_known && since_s < kUnjudgedS) {
        continue;
      }
      if (localizer.is_placed()) {
        score.add(robot, now, localizer.pose(), localizer.covariance());
      } else {
        score.add_missing(robot, now);
      }
    }
    if ((step - span.first) % options.message_every == 0) {
      bytes += exchange(localizers, options.loss, rng, message);
    }
  }
  JudgeFigures figures = score.figures(landmarks_of(localizers.front().team()));
  figures.placed_after_s = placed_after_s;
  figures.bytes_per_robot_s = static_cast<double>(bytes) / static_cast<double>(robots) /
                              to_seconds(time_of(span.last) - time_of(span.first));
  figures.filter = localizers.front().team().counts();
  figures.inputs = localizers.front().counts();
  return figures;
}

/// One joint filter over all data. It records its steps for estimates in hindsight.
class JointRun {
 public:
  JointRun(const scenario::LocalizerSpec& spec, const Recording& recording, Span span)
      : spec_(spec), filter_(spec), searches_(recording.size()), increments_(recording.size()) {
    for (std::size_t robot = 0; robot < recording.size(); ++robot) {
      motions_.emplace_back(spec.robots[robot].drive);
      pass_frames(recording[robot], spec.robots[robot].sightings, next_frame_[robot],
                  time_of(span.first) - Duration{1}, [](auto) {});
    }
  }

  TeamFilter& filter() { return filter_; }
  TeamSmoother& smoother() { return smoother_; }

  /// Processes the step that ends at `to`.
  void step(const Recording& recording, Time from, Time to) {
    struct Frame {
      Time time{};
      std::size_t robot = 0;
      std::vector<models::Sighting> sightings;
    };
    std::vector<Frame> frames;
    for (std::size_t robot = 0; robot < recording.size(); ++robot) {
      const RobotRecording& inputs = recording[robot];
      for (std::size_t& next = next_odometry_[robot];
           next < inputs.odometry.size() && inputs.odometry[next].stamp.time <= to; ++next) {
        const models::OdometryReport& odometry = inputs.odometry[next];
        require(odometry.kind == models::OdometryKind::kCommand,
                "smoothing with later data requires odometry of kind kCommand");
        motions_[robot].command(odometry.stamp.time, odometry.motion_body.x(),
                                odometry.motion_body.z());
      }
      // Hindsight may use a frame at its corrected time, although it was stamped later.
      const auto& camera = spec_.robots[robot].sightings;
      pass_frames(
          inputs, camera, next_frame_[robot], to + from_seconds(camera.stamp_delay_s),
          [&](std::span<const models::Sighting> frame) {
            frames.push_back(
                {std::clamp(frame.front().time, from, to), robot, {frame.begin(), frame.end()}});
          });
    }
    std::stable_sort(frames.begin(), frames.end(),
                     [](const Frame& a, const Frame& b) { return a.time < b.time; });
    Time now = from;
    for (const Frame& frame : frames) {
      advance(now, frame.time);
      now = frame.time;
      observe(frame.robot, frame.sightings);
    }
    advance(now, to);
  }

 private:
  void advance(Time from, Time to) {
    if (to <= from) {
      return;
    }
    for (std::size_t robot = 0; robot < motions_.size(); ++robot) {
      static_cast<void>(motions_[robot].advance_to(from));
      increments_[robot] = motions_[robot].advance_to(to);
      searches_[robot].advance(to_seconds(to - from), increments_[robot]);
    }
    smoother_.begin_step(filter_, from);
    filter_.advance(to_seconds(to - from), increments_);
    smoother_.end_step(filter_);
  }
  void observe(std::size_t robot, std::span<const models::Sighting> sightings) {
    const int index = static_cast<int>(robot);
    if (filter_.is_placed(index)) {
      filter_.observe(index, sightings);
    } else if (const auto start = searches_[robot].observe(spec_, index, sightings)) {
      filter_.place(index, start->world_from_body, start->covariance);
    }
  }

  const scenario::LocalizerSpec& spec_;
  TeamFilter filter_;
  TeamSmoother smoother_;
  std::vector<CommandedMotion> motions_;
  std::vector<StartSearch> searches_;
  std::vector<Eigen::Vector3d> increments_;
  std::vector<std::size_t> next_odometry_ = std::vector<std::size_t>(increments_.size(), 0);
  std::vector<std::size_t> next_frame_ = std::vector<std::size_t>(increments_.size(), 0);
};

/// Judges the estimates of a JointRun.
class HindsightJudge {
 public:
  HindsightJudge(const Recording& recording, const JudgeOptions& options,
                 const std::vector<bool>& trusted, Time begin)
      : score_(recording, trusted, options),
        begin_(begin),
        judged_until_(begin),
        is_start_known_(options.is_start_known),
        placed_after_s_(recording.size(), -1.0) {}

  /// Records which robots have a pose at `now`.
  void note_placed(const TeamFilter& filter, Time now) {
    for (std::size_t robot = 0; robot < placed_after_s_.size(); ++robot) {
      if (placed_after_s_[robot] < 0.0 && filter.is_placed(static_cast<int>(robot))) {
        placed_after_s_[robot] = to_seconds(now - begin_);
      }
    }
  }

  /// Judges the unjudged grid instants before `until` with the data that `run` contains, and drops
  /// their record.
  void judge_until(JointRun& run, Time until) {
    if (until <= judged_until_) {
      return;
    }
    run.smoother().smooth(
        run.filter(), [&](Time time, const Eigen::VectorXd& state, const Eigen::MatrixXd& P) {
          if (time >= judged_until_ && time < until && to_utime(time) % kIncrement.count() == 0) {
            add(time, state, P);
          }
        });
    judged_until_ = until;
    run.smoother().forget_before(until);
  }

  [[nodiscard]] JudgeFigures figures(const TeamFilter& filter) const {
    JudgeFigures out = score_.figures(landmarks_of(filter));
    out.placed_after_s = placed_after_s_;
    return out;
  }

 private:
  void add(Time time, const Eigen::VectorXd& state, const Eigen::MatrixXd& P) {
    const double since_s = to_seconds(time - begin_);
    if (!is_start_known_ && since_s < kUnjudgedS) {
      return;
    }
    for (std::size_t robot = 0; robot < placed_after_s_.size(); ++robot) {
      const int i = static_cast<int>(robot) * TeamFilter::kRobotDim;
      if (placed_after_s_[robot] >= 0.0 && placed_after_s_[robot] <= since_s) {
        score_.add(robot, time, {state(i), state(i + 1), state(i + 2)}, P.block<3, 3>(i, i));
      } else {
        score_.add_missing(robot, time);
      }
    }
  }

  Score score_;
  Time begin_;
  Time judged_until_;  ///< end of the judged time, exclusive
  bool is_start_known_;
  std::vector<double> placed_after_s_;
};

JudgeFigures judge_hindsight(const scenario::LocalizerSpec& spec, const Recording& recording,
                             const JudgeOptions& options, const std::vector<bool>& trusted) {
  const Span span = span_of(recording);
  const Time begin = time_of(span.first);
  JointRun run(spec, recording, span);
  for (std::size_t robot = 0; options.is_start_known && robot < recording.size(); ++robot) {
    run.filter().place(static_cast<int>(robot), start_of(recording[robot].truth, begin),
                       kStartSigma * kStartSigma * Eigen::Matrix3d::Identity());
  }
  HindsightJudge judge(recording, options, trusted, begin);
  for (std::int64_t step = span.first; step <= span.last; ++step) {
    const Time now = time_of(step);
    if (step > span.first) {
      run.step(recording, time_of(step - 1), now);
    }
    judge.note_placed(run.filter(), now);
    // The filter contains frames stamped up to one step after `now`. An estimate that waited for
    // the next pass would contain more than hindsight_s of later data.
    if (std::isfinite(options.hindsight_s) && (now - begin) % kHindsightPass == Duration{0}) {
      judge.judge_until(run, now - from_seconds(options.hindsight_s) + kHindsightPass + kIncrement);
    }
  }
  judge.judge_until(run, time_of(span.last + 1));
  JudgeFigures figures = judge.figures(run.filter());
  figures.filter = run.filter().counts();
  return figures;
}

}  // namespace

JudgeFigures judge(const scenario::LocalizerSpec& spec, const Recording& recording,
                   const JudgeOptions& options, const std::vector<bool>& heading_trusted) {
  require(recording.size() == spec.robots.size(),
          "the recording must have the robots of the specification");
  require(heading_trusted.empty() || heading_trusted.size() == recording.size(),
          "heading_trusted must have one entry per robot");
  for (const RobotRecording& robot : recording) {
    require(!robot.truth.empty(), "every robot must have true poses");
  }
  return options.hindsight_s > 0.0 ? judge_hindsight(spec, recording, options, heading_trusted)
                                   : judge_team(spec, recording, options, heading_trusted);
}

std::vector<TruePath> smoothed_paths(const scenario::LocalizerSpec& spec,
                                     const Recording& recording) {
  require(recording.size() == spec.robots.size(),
          "the recording must have the robots of the specification");
  const Span span = span_of(recording);
  JointRun run(spec, recording, span);
  std::vector<std::int64_t> placed(recording.size(), -1);
  for (std::int64_t step = span.first + 1; step <= span.last; ++step) {
    run.step(recording, time_of(step - 1), time_of(step));
    for (std::size_t robot = 0; robot < placed.size(); ++robot) {
      if (placed[robot] < 0 && run.filter().is_placed(static_cast<int>(robot))) {
        placed[robot] = step;
      }
    }
  }
  // The smoother passes backwards, and paths must ascend in time.
  struct Timed {
    Time time{};
    Pose2 pose;
  };
  std::vector<std::vector<Timed>> backwards(recording.size());
  run.smoother().smooth(
      run.filter(), [&](Time time, const Eigen::VectorXd& state, const Eigen::MatrixXd&) {
        for (std::size_t robot = 0; robot < placed.size(); ++robot) {
          const int i = static_cast<int>(robot) * TeamFilter::kRobotDim;
          if (placed[robot] >= 0 && time >= time_of(placed[robot])) {
            backwards[robot].push_back({time, {state(i), state(i + 1), state(i + 2)}});
          }
        }
      });
  std::vector<TruePath> paths(recording.size());
  for (std::size_t robot = 0; robot < paths.size(); ++robot) {
    for (auto each = backwards[robot].rbegin(); each != backwards[robot].rend(); ++each) {
      paths[robot].add(each->time, each->pose);
    }
  }
  return paths;
}

}  // namespace vantage::localizer
