#include "test/sim/autopilot/drill.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "core/axes.hpp"
#include "wire/mavlink/single.hpp"

namespace vantage::test {
namespace {

using models::AutopilotDialect;
using wire::mavlink::f32;

constexpr float kHeightM = 1.2F;
constexpr double kSpeedMps = 1.0;
constexpr double kBrakeMps2 = 2.0;
constexpr double kMoveS = 2.25;                    // s; duration of a motion, acceleration included
constexpr double kRampS = kSpeedMps / kBrakeMps2;  // s; acceleration or braking
constexpr double kStopM = 0.5 * kSpeedMps * kSpeedMps / kBrakeMps2;  // m; stopping distance
constexpr double kMovedM = kStopM + kSpeedMps * (kMoveS - kRampS);   // m; path length in kMoveS
constexpr double kBrakedS = 0.4;  // s; braking time until the kind of set-point changes
constexpr double kPathPeriodS = 0.1;

/// A point of a reference trajectory along x.
struct Line {
  double x_m = 0.0;
  double v_mps = 0.0;
  double a_mps2 = 0.0;
};
/// Returns the reference at `t_s` after a start from rest.
Line moving(double t_s) {
  if (t_s < kRampS) {
    return {0.5 * kBrakeMps2 * t_s * t_s, kBrakeMps2 * t_s, kBrakeMps2};
  }
  return {kStopM + kSpeedMps * (t_s - kRampS), kSpeedMps, 0.0};
}
/// Returns the reference at `t_s` after braking starts at kSpeedMps.
Line braking(double t_s) {
  if (t_s < kRampS) {
    return {kSpeedMps * t_s - 0.5 * kBrakeMps2 * t_s * t_s, kSpeedMps - kBrakeMps2 * t_s,
            -kBrakeMps2};
  }
  return {kStopM, 0.0, 0.0};
}

class Player {
 public:
  Player(const DrillCase& drill, ScriptedStation& station) : drill_(drill), station_(station) {
    station_.recording = &recording_;
  }

  Recording play() {
    wake_up();
    if (drill_.drill == Drill::kArming) {
      arming();
    } else if (is_flying()) {
      is_on_path_ = true;
      mark("hover");
      hold(3.0);
      switch (drill_.drill) {
        case Drill::kMotion:
          motion();
          break;
        case Drill::kPosesStop:
          mark("poses stop");
          station_.sends_poses = false;
          wait_for_disarming(30.0);
          break;
        case Drill::kPosesJump:
          jump();
          break;
        default:
          stop_in_motion();
      }
    }
    station_.recording = nullptr;
    return recording_;
  }

 private:
  void mark(const std::string& what) { recording_.note(station_.time_s(), "mark", what); }

  void tick() {
    station_.tick();
    if (is_on_path_ && station_.time_s() >= next_moment_s_) {
      next_moment_s_ = std::max(next_moment_s_ + kPathPeriodS, station_.time_s());
      const ScriptedStation::Body body = station_.body();
      recording_.path.push_back({station_.time_s(),
                                 convert_axes(body.world_from_body.translation_m),
                                 convert_axes(body.velocity_world_mps),
                                 convert_yaw(flatten(body.world_from_body).yaw_rad)});
    }
  }
  void run(double seconds) {
    run_until([] { return false; }, seconds);
  }
  bool run_until(const std::function<bool()>& done, double seconds) {
    const double end_s = station_.time_s() + seconds - 1e-6;
    while (station_.time_s() < end_s && !done()) {
      tick();
    }
    return done();
  }
  void wait_for_disarming(double seconds) {
    run_until([&] { return !station_.reports_armed(); }, seconds);
    run(1.0);
  }

  /// Sends a complete set-point (all fields), as the driver does.
  void send_setpoint(const Line& line) {
    wire::mavlink::SetPositionTargetLocalNed out =
        ScriptedStation::position(f32(base_m_ + line.x_m), 0.0F, height_m_, yaw_rad_);
    out.type_mask = wire::mavlink::mask::kNothingIgnored;
    out.vx = f32(line.v_mps);
    out.afx = f32(line.a_mps2);
    station_.target = out;
  }
  void follow(const std::function<Line(double)>& line, double seconds) {
    const double begin_s = station_.time_s();
    while (station_.time_s() - begin_s < seconds - 1e-6) {
      send_setpoint(line(station_.time_s() - begin_s));
      tick();
    }
  }
  void hold(double seconds) {
    follow([](double) { return Line{}; }, seconds);
  }

  void wake_up() {
    run_until([&] { return station_.last_heartbeat.has_value(); }, 20.0);
    for (const auto id :
         {wire::mavlink::Heartbeat::kMessage.id, wire::mavlink::EstimatorStatus::kMessage.id,
          wire::mavlink::EkfStatusReport::kMessage.id, wire::mavlink::ExtendedSysState::kMessage.id,
          wire::mavlink::LocalPositionNed::kMessage.id}) {
      station_.command(wire::mavlink::command::kSetMessageInterval, static_cast<float>(id),
                       100'000.0F);
    }
    for (const auto& [name, value] : drill_.parameters) {
      station_.set_parameter(name, value);
    }
    mark("heartbeats");
    station_.sends_heartbeats = true;
    run(1.0);
  }

  int ask_for_mode() {
    return drill_.dialect == AutopilotDialect::kPx4
               ? station_.command(wire::mavlink::command::kSetMode, 1, 6)
               : station_.command(wire::mavlink::command::kSetMode, 1, 4);
  }
  void see_poses() {
    mark("poses");
    station_.sends_poses = true;
  }
  void stand_still() {
    height_m_ = drill_.drill == Drill::kArming ? 0.5F : 0.1F;  // m, z down: below the ground
    send_setpoint({});
  }
  /// Requests arming once per second until the vehicle arms or `seconds` have passed. @return true
  /// if it armed
  bool arm(double seconds) {
    const double end_s = station_.time_s() + seconds;
    while (station_.time_s() < end_s && !station_.reports_armed()) {
      if (drill_.dialect == AutopilotDialect::kArdupilot && !has_origin_) {
        mark("origin");
        wire::mavlink::SetGpsGlobalOrigin origin;
        origin.latitude = 399'522'000;
        origin.longitude = -751'932'000;
        origin.altitude = 10'000;
        origin.target_system = 1;
        station_.send(origin);
        has_origin_ = true;
      }
      ask_for_mode();
      station_.command(wire::mavlink::command::kArmDisarm, 1);
      run_until([&] { return station_.reports_armed(); }, 1.0);
    }
    return station_.reports_armed();
  }

  void arming() {
    const bool is_px4 = drill_.dialect == AutopilotDialect::kPx4;
    for (int i = 0; i < 3; ++i) {
      mark("arm without poses");
      if (!is_px4) {
        ask_for_mode();
      }
      station_.command(wire::mavlink::command::kArmDisarm, 1);
      run(1.0);
    }
    see_poses();
    run(4.0);
    if (is_px4) {
      mark("set-points");
      stand_still();
      run(1.5);
    } else {
      ask_without_targets();
    }
    mark("arm");
    if (arm(60.0)) {
      mark("idle");
      wait_for_disarming(30.0);
    }
    // Must be the last part: in Offboard without set-points, PX4 does not wait for its simulator.
    if (is_px4) {
      station_.target.reset();
      run(2.0);
      ask_without_targets();
    }
  }
  void ask_without_targets() {
    mark("no set-points");
    ask_for_mode();
    station_.command(wire::mavlink::command::kArmDisarm, 1);
    run(1.0);
  }

  bool is_flying() {
    see_poses();
    run(4.0);
    if (drill_.dialect == AutopilotDialect::kPx4) {
      stand_still();
      run(1.5);
    }
    if (!arm(60.0)) {
      return false;
    }
    if (drill_.dialect == AutopilotDialect::kArdupilot) {
      mark("take off");
      station_.command(wire::mavlink::command::kTakeOff, 0, 0, 0, kHeightM);
      run(8.0);
      height_m_ = -kHeightM;
    } else {
      run(1.0);
      mark("take off");
      for (height_m_ = 0.0F; height_m_ > -kHeightM; height_m_ -= 0.01F) {
        send_setpoint({});
        tick();
      }
      height_m_ = -kHeightM;
      hold(3.0);
    }
    return convert_axes(station_.body().world_from_body.translation_m).z() <
           -0.5 * static_cast<double>(kHeightM);
  }

  void go_back(double distance_m) {
    mark("back");
    follow(
        [distance_m](double t_s) {
          const double share = std::min(1.0, t_s / 5.0);
          const double smooth = share * share * (3.0 - 2.0 * share);
          const double rate = share < 1.0 ? 6.0 * share * (1.0 - share) / 5.0 : 0.0;
          return Line{distance_m * (1.0 - smooth), -distance_m * rate, 0.0};
        },
        8.0);
  }

  void go_there_and_back(const char* name, double there_m) {
    mark(name);
    station_.target = ScriptedStation::position(f32(there_m), 0.0F, height_m_, 0.0F);
    run(5.0);
    go_back(there_m);
  }

  void motion() {
    mark("move");
    follow(moving, kMoveS);
    base_m_ += kMovedM;
    mark("brake");
    follow(braking, 4.0);
    base_m_ -= kMovedM;
    go_back(kMovedM + kStopM);

    mark("move again");
    follow(moving, kMoveS);
    go_there_and_back("place alone", kMovedM + kStopM);

    mark("velocity");
    station_.target = ScriptedStation::velocity(f32(kSpeedMps), 0.0F, 0.0F, 0.0F);
    run(3.0);
    go_there_and_back("place after velocity",
                      station_.body().world_from_body.translation_m.x() + kStopM);

    // The kind of set-point changes while the vehicle brakes. Its tilt is then caused by braking,
    // not by wind.
    mark("move once more");
    follow(moving, kMoveS);
    base_m_ += kMovedM;
    follow(braking, kBrakedS);
    base_m_ -= kMovedM;
    go_there_and_back("place while braking", kMovedM + kStopM);

    mark("velocity once more");
    station_.target = ScriptedStation::velocity(f32(kSpeedMps), 0.0F, 0.0F, 0.0F);
    run(3.0);
    const double braked_m = station_.body().world_from_body.translation_m.x() + kStopM;
    const double begin_s = station_.time_s();
    while (station_.time_s() - begin_s < kBrakedS) {
      station_.target = ScriptedStation::velocity(f32(braking(station_.time_s() - begin_s).v_mps),
                                                  0.0F, 0.0F, 0.0F);
      tick();
    }
    go_there_and_back("place after braking velocity", braked_m);

    mark("turn");
    yaw_rad_ = f32(M_PI / 2.0);
    hold(4.0);
    land();
  }

  void land() {
    mark("land");
    station_.target.reset();
    if (drill_.dialect == AutopilotDialect::kPx4) {
      station_.command(wire::mavlink::command::kLand, 0);
    } else {
      station_.command(wire::mavlink::command::kSetMode, 1, 9);
    }
    wait_for_disarming(20.0);
  }

  void jump() {
    mark("small jump");
    station_.pose_offset_m.x() = 0.3;
    hold(5.0);
    mark("small jump back");
    station_.pose_offset_m.x() = 0.0;
    hold(5.0);
    mark("great jump");
    station_.pose_offset_m.x() = 1.5;
    hold(8.0);
    land();
  }

  void stop_in_motion() {
    mark("move");
    follow(moving, kMoveS);
    base_m_ += kMovedM;
    const auto go_on = [](double t_s) { return Line{kSpeedMps * t_s, kSpeedMps, 0.0}; };
    if (drill_.drill == Drill::kSetpointsStop) {
      mark("set-points stop");
      station_.target.reset();
      wait_for_disarming(12.0);
    } else if (drill_.drill == Drill::kEverythingStops) {
      mark("everything stops");
      station_.target.reset();
      station_.sends_heartbeats = false;
      station_.sends_poses = false;
      wait_for_disarming(30.0);
    } else {
      mark("heartbeats stop");
      station_.sends_heartbeats = false;
      follow(go_on, 2.0);
      base_m_ += 2.0 * kSpeedMps;
      follow(braking, kRampS);
      base_m_ += kStopM;
      send_setpoint({});
      wait_for_disarming(10.0);
    }
    if (station_.reports_armed()) {
      land();
    }
  }

  const DrillCase& drill_;
  ScriptedStation& station_;
  Recording recording_;
  bool is_on_path_ = false;
  bool has_origin_ = false;
  double next_moment_s_ = 0.0;
  double base_m_ = 0.0;
  float height_m_ = 0.0F;
  float yaw_rad_ = 0.0F;
};

}  // namespace

const std::vector<DrillCase>& drill_cases() {
  constexpr auto kArdupilot = AutopilotDialect::kArdupilot;
  constexpr auto kPx4 = AutopilotDialect::kPx4;
  static const std::vector<DrillCase> kCases{
      {"ardupilot_arming", kArdupilot, Drill::kArming, {}},
      {"ardupilot_motion", kArdupilot, Drill::kMotion, {}},
      {"ardupilot_setpoints_stop", kArdupilot, Drill::kSetpointsStop, {}},
      {"ardupilot_setpoints_stop_slow", kArdupilot, Drill::kSetpointsStop, {{"GUID_TIMEOUT", 1.5}}},
      {"ardupilot_heartbeats_stop", kArdupilot, Drill::kHeartbeatsStop, {}},
      {"ardupilot_heartbeats_stop_slow",
       kArdupilot,
       Drill::kHeartbeatsStop,
       {{"FS_GCS_TIMEOUT", 3.0}}},
      {"ardupilot_everything_stops", kArdupilot, Drill::kEverythingStops, {}},
      {"ardupilot_poses_stop", kArdupilot, Drill::kPosesStop, {}},
      {"ardupilot_poses_jump", kArdupilot, Drill::kPosesJump, {}},
      {"px4_poses_jump", kPx4, Drill::kPosesJump, {}},
      {"px4_arming", kPx4, Drill::kArming, {}},
      {"px4_motion", kPx4, Drill::kMotion, {}},
      {"px4_setpoints_stop", kPx4, Drill::kSetpointsStop, {}},
      {"px4_setpoints_stop_slow", kPx4, Drill::kSetpointsStop, {{"COM_OF_LOSS_T", 1.0}}},
      {"px4_heartbeats_stop", kPx4, Drill::kHeartbeatsStop, {}},
      {"px4_everything_stops", kPx4, Drill::kEverythingStops, {}},
      {"px4_poses_stop", kPx4, Drill::kPosesStop, {}}};
  return kCases;
}

const DrillCase& drill_case(const std::string& name) {
  const auto& all = drill_cases();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const DrillCase& drill) { return drill.name == name; });
  if (found == all.end()) {
    throw std::runtime_error("no drill " + name);
  }
  return *found;
}

Recording play(const DrillCase& drill, ScriptedStation& station) {
  return Player(drill, station).play();
}

}  // namespace vantage::test
