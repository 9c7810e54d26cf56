#include "localizer/judge/judge.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "localizer/team_smoother.hpp"

namespace vantage::localizer {
namespace {

constexpr double kUnjudgedS = 60.0;    // after an unknown start, this time is not judged
constexpr double kInside2 = 5.991465;  // 95 % quantile of χ² with 2 degrees of freedom
constexpr double kInside3 = 7.814728;
constexpr double kStartSigma = 0.01;                      // m and rad; 1σ of a known start
const Duration kHindsightPass = std::chrono::seconds(2);  // time between two passes of the smoother

/// Returns the rotation and translation that moves `from` to `to` with the least squared error.
Pose2 alignment_of(const std::vector<Eigen::Vector2d>& from,
                   const std::vector<Eigen::Vector2d>& to) {
  if (from.empty()) {
    return {};
  }
  Eigen::Vector2d mean_from = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_to = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) {
    mean_from += from[k] / static_cast<double>(from.size());
    mean_to += to[k] / static_cast<double>(from.size());
  }
  double cosine = 0.0;
  double sine = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const Eigen::Vector2d p = from[k] - mean_from;
    const Eigen::Vector2d q = to[k] - mean_to;
    cosine += p.dot(q);
    sine += p.x() * q.y() - p.y() * q.x();
  }
  Pose2 to_from_from{0.0, 0.0, std::atan2(sine, cosine)};
  const Eigen::Vector2d origin_m = mean_to - to_from_from * mean_from;
  to_from_from.x_m = origin_m.x();
  to_from_from.y_m = origin_m.y();
  return to_from_from;
}

/// Returns the root mean square distance of the points `from`, moved by `to_from_from`, from `to`.
double rmse_of(const Pose2& to_from_from, const std::vector<Eigen::Vector2d>& from,
               const std::vector<Eigen::Vector2d>& to) {
  double squares = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    squares += (to_from_from * from[k] - to[k]).squaredNorm();
  }
  return from.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(from.size()));
}

/// Collects estimates and computes the figures.
class Score {
 public:
  Score(const Recording& recording, const std::vector<bool>& trusted, const JudgeOptions& options)
      : recording_(recording),
        trusted_(trusted),
        watch_(options.watch),
        hidden_(options.hidden_landmarks) {}

  void add(std::size_t robot, Time time, const Pose2& pose, const Eigen::Matrix3d& covariance) {
    if (watch_) {
      watch_(robot, time, pose, covariance);
    }
    if (const auto truth = recording_[robot].truth.at(time)) {
      samples_.push_back({robot, pose, *truth, covariance});
    }
  }
  /// Counts an instant at which `robot` should have a pose.
  void add_missing(std::size_t robot, Time time) {
    missing_ += recording_[robot].truth.at(time) ? 1 : 0;
  }

  /// @param filter  filter that contains the landmarks
  [[nodiscard]] JudgeFigures figures(const TeamFilter& filter) const {
    JudgeFigures out;
    Pose2 world_from_map;
    if (!hidden_.empty()) {
      std::vector<Eigen::Vector2d> from;
      std::vector<Eigen::Vector2d> to;
      for (const Sample& sample : samples_) {
        from.push_back(sample.pose.position_m());
        to.push_back(sample.truth.position_m());
      }
      world_from_map = alignment_of(from, to);
      judge_landmarks(filter, world_from_map, out);
    }
    std::vector<double> all;
    std::vector<std::vector<double>> by_robot(recording_.size());
    std::vector<double> yaw;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(world_from_map.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    for (const Sample& sample : samples_) {
      const Pose2 pose = world_from_map * sample.pose;
      const Eigen::Matrix3d P3 = turn * sample.covariance * turn.transpose();
      const Eigen::Vector3d error(pose.x_m - sample.truth.x_m, pose.y_m - sample.truth.y_m,
                                  wrap_to_pi(pose.yaw_rad - sample.truth.yaw_rad));
      by_robot[sample.robot].push_back(error.head<2>().norm());
      all.push_back(error.head<2>().norm());
      const Eigen::Matrix2d P = P3.topLeftCorner<2, 2>();
      const double of_position = error.head<2>().dot(P.inverse() * error.head<2>());
      out.nees_position += of_position;
      out.inside_position += of_position <= kInside2 ? 1 : 0;
      if (trusted_.empty() || trusted_[sample.robot]) {
        yaw.push_back(std::abs(error.z()));
        const double of_pose = error.dot(P3.inverse() * error);
        out.nees_pose += of_pose;
        out.inside_pose += of_pose <= kInside3 ? 1 : 0;
      }
    }
    for (const std::vector<double>& errors : by_robot) {
      out.robot_position_m.push_back(figures_of(errors));
    }
    out.position_m = figures_of(all);
    out.yaw_rad = figures_of(yaw);
    const double positions = std::max(1.0, static_cast<double>(all.size()));
    const double poses = std::max(1.0, static_cast<double>(yaw.size()));
    out.nees_position /= positions;
    out.inside_position /= positions;
    out.nees_pose /= poses;
    out.inside_pose /= poses;
    out.without_pose = missing_;
    return out;
  }

 private:
  static ErrorFigures figures_of(std::vector<double> errors) {
    ErrorFigures out;
    out.count = static_cast<int>(errors.size());
    if (errors.empty()) {
      return out;
    }
    std::sort(errors.begin(), errors.end());
    double squares = 0.0;
    for (const double error : errors) {
      squares += error * error;
    }
    const auto quantile = [&](double share) {
      return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
    };
    out.rmse = std::sqrt(squares / static_cast<double>(errors.size()));
    out.median = quantile(0.5);
    out.p95 = quantile(0.95);
    out.max = errors.back();
    return out;
  }

  void judge_landmarks(const TeamFilter& filter, const Pose2& world_from_map,
                       JudgeFigures& out) const {
    std::vector<Eigen::Vector2d> to;
    for (std::size_t k = 0; k < filter.mapped().size(); ++k) {
      const auto truth = std::find_if(
          hidden_.begin(), hidden_.end(),
          [&](const scenario::LandmarkSpec& each) { return each.id == filter.mapped()[k]; });
      if (truth != hidden_.end()) {
        out.landmarks_m.push_back(filter.landmark_m(static_cast<int>(k)));
        to.push_back(truth->position_m);
      }
    }
    out.landmarks_rmse_m = rmse_of(world_from_map, out.landmarks_m, to);
    out.landmarks_own_rmse_m = rmse_of(alignment_of(out.landmarks_m, to), out.landmarks_m, to);
  }

  struct Sample {
    std::size_t robot = 0;
    Pose2 pose;
    Pose2 truth;
    Eigen::Matrix3d covariance;
  };
  const Recording& recording_;
  std::vector<bool> trusted_;
  PoseWatch watch_;
  std::vector<scenario::LandmarkSpec> hidden_;
  std::vector<Sample> samples_;
  int missing_ = 0;
};

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
    require(!robot.truth.empty(), "every robot must have true poses");
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

/// Calls `use` with the sightings of each frame stamped ≤ `until`, with corrected times, from
/// `next` on.
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

/// Positions of a robot in its lists of inputs.
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
  JudgeFigures figures = score.figures(localizers.front().team());
  figures.placed_after_s = placed_after_s;
  figures.bytes_per_robot_s = static_cast<double>(bytes) / static_cast<double>(robots) /
                              to_seconds(time_of(span.last) - time_of(span.first));
  figures.filter = localizers.front().team().counts();
  figures.inputs = localizers.front().counts();
  return figures;
}

/// One joint filter over all data, with its record for hindsight.
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
    JudgeFigures out = score_.figures(filter);
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
  return options.hindsight_s > 0.0 ? judge_hindsight(spec, recording, options, heading_trusted)
                                   : judge_team(spec, recording, options, heading_trusted);
}

}  // namespace vantage::localizer
