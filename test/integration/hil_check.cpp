// hil_check LOG [ROBOT…]
//
// Reads the log of a trial with devices on the wire: did every vehicle take off, follow plans of
// the team and land; did anything touch; is VICON without a gap. The robots named need not leave
// their heights (ground robots, `direct` ones): they must follow plans and get about. Prints what
// it saw, and how late poses and set-points came to the autopilots. Exit code 0 when all is well.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <string>

#include <lcm/lcm-cpp.hpp>

#include "bus/convert.hpp"
#include "test/support/flight_record.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): a test's main alone
using models::FlightState;

struct Flight {
  std::set<std::int64_t> rounds;  // followed
  double highest_m = 0.0;
  double last_m = 0.0;
  std::optional<Eigen::Vector2d> first_m;
  double farthest_m = 0.0;  // from there
  FlightState state = FlightState::kIdle;
};

struct Seen {
  std::map<std::string, Flight> flights;
  std::int64_t frames = 0;
  std::int64_t frame_gaps = 0;
  std::int64_t frames_lost_on_lcm = 0;
  std::optional<models::MocapFrame> last_frame;
  std::int64_t collisions = 0;
  std::map<std::string, std::int64_t> counters;  // newest of each process
};

template <class Message, class Wire>
std::optional<Message> decode(const lcm::LogEvent& event) {
  Wire wire;
  if (wire.decode(event.data, 0, event.datalen) != event.datalen) {
    return std::nullopt;
  }
  return bus::from_wire(wire);
}

void on_frame(const models::MocapFrame& frame, Seen& seen) {
  ++seen.frames;
  if (seen.last_frame) {
    seen.frame_gaps += frame.frame_number == seen.last_frame->frame_number + 1 ? 0 : 1;
    seen.frames_lost_on_lcm += frame.stamp.sequence == seen.last_frame->stamp.sequence + 1 ? 0 : 1;
  }
  seen.last_frame = frame;
}

void take(const lcm::LogEvent& event, Seen& seen) {
  if (event.channel == "VICON") {
    if (const auto frame = decode<models::MocapFrame, vantage_lcm::vicon_frame_t>(event)) {
      on_frame(*frame, seen);
    }
  } else if (event.channel == "COLLISION") {
    if (const auto contact = decode<models::ContactReport, vantage_lcm::collision_t>(event)) {
      seen.collisions += contact->kind == models::ContactKind::kCollision ? 1 : 0;
    }
  } else if (event.channel == "TRUTH") {
    if (const auto truth = decode<models::TruthFrame, vantage_lcm::truth_t>(event)) {
      for (const models::TruthBody& body : truth->bodies) {
        if (body.target_id < 0) {
          Flight& flight = seen.flights[body.name];
          flight.last_m = body.world_from_body.translation_m.z();
          flight.highest_m = std::max(flight.highest_m, flight.last_m);
          const Eigen::Vector2d at_m = body.world_from_body.translation_m.head<2>();
          flight.first_m = flight.first_m.value_or(at_m);
          flight.farthest_m = std::max(flight.farthest_m, (at_m - *flight.first_m).norm());
        }
      }
    }
  } else if (event.channel.starts_with("QUADROTOR_")) {
    if (const auto status = decode<models::VehicleStatus, vantage_lcm::quadrotor_t>(event)) {
      Flight& flight = seen.flights[status->robot];
      flight.state = status->state;
      if (status->state == FlightState::kFollow && status->plan_round >= 0) {
        flight.rounds.insert(status->plan_round);
      }
    }
  } else if (event.channel.starts_with("HEALTH_")) {
    if (const auto health = decode<models::ProcessHealth, vantage_lcm::health_t>(event)) {
      for (const models::NamedCount& counter : health->counters) {
        seen.counters[health->process + " " + counter.name] = counter.count;
      }
    }
  }
}

bool judge(const Seen& seen, const std::set<std::string>& level) {
  bool is_good = seen.collisions == 0 && seen.frames > 0 && seen.frame_gaps == 0 &&
                 seen.frames_lost_on_lcm == 0 && !seen.flights.empty();
  std::printf("%lld collisions; VICON: %lld frames, %lld gaps, %lld lost on LCM\n",
              static_cast<long long>(seen.collisions), static_cast<long long>(seen.frames),
              static_cast<long long>(seen.frame_gaps),
              static_cast<long long>(seen.frames_lost_on_lcm));
  for (const auto& [robot, flight] : seen.flights) {
    const bool has_landed = flight.state == FlightState::kIdle && flight.last_m < 0.1;
    std::printf("%s: up to %.2f m, %zu rounds followed, %.2f m away, %s at %.2f m\n", robot.c_str(),
                flight.highest_m, flight.rounds.size(), flight.farthest_m,
                models::name_of(flight.state), flight.last_m);
    const bool has_flown = flight.highest_m > 0.8 && has_landed;
    is_good = is_good && !flight.rounds.empty() && flight.farthest_m > 0.5 &&
              (has_flown || level.count(robot) > 0);
  }
  for (const auto& [name, count] : seen.counters) {
    if (name.ends_with("_us")) {
      std::printf("%s %lld\n", name.c_str(), static_cast<long long>(count));
    }
  }
  return is_good;
}

void print_stops(const test::FlightRecord& record) {
  for (const auto& [robot, stops] : record.stops()) {
    double farthest_m = 0.0;
    double longest_s = 0.0;
    double fastest_mps = 0.0;
    for (const test::Stop& stop : stops) {
      if (stop.distance_m > farthest_m) {
        farthest_m = stop.distance_m;
        fastest_mps = stop.speed_mps;
      }
      longest_s = std::max(longest_s, stop.still_after_s);
    }
    std::printf("%s: %zu stops, the longest %.2f m from %.2f m/s, still after %.2f s\n",
                robot.c_str(), stops.size(), farthest_m, fastest_mps, longest_s);
  }
}

bool judge_course(const test::FlightRecord& record) {
  bool is_good = true;
  for (const auto& [robot, kept] : record.summaries()) {
    std::printf("%s\n", test::to_text(robot, kept).c_str());
    is_good = is_good && kept.follow_share >= 0.98 && kept.setpoint_error_rms_m <= 0.10 &&
              kept.speed_max_share <= 1.15 && kept.reasons.count("fence") == 0;
  }
  return is_good;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::printf("usage: hil_check LOG [ROBOT...]\n");
    return 2;
  }
  lcm::LogFile log(argv[1], "r");
  if (!log.good()) {
    std::printf("cannot read %s\n", argv[1]);
    return 2;
  }
  Seen seen;
  test::FlightRecord record;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    take(*event, seen);
    record.take(*event);
  }
  const bool is_strict = std::getenv("HIL_STRICT") != nullptr;
  const bool keeps_course = judge_course(record);
  print_stops(record);
  const bool is_good = judge(seen, std::set<std::string>(argv + 2, argv + argc));
  return is_good && (keeps_course || !is_strict) ? 0 : 1;
}
