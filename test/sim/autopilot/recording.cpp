#include "test/sim/autopilot/recording.hpp"

#include <algorithm>
#include <iomanip>
#include <istream>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include "core/angle.hpp"

namespace vantage::test {
namespace {

constexpr const char* kPlace = "at";

}  // namespace

void Recording::note(double time_s, const std::string& kind, const std::string& what) {
  events.push_back({time_s, kind, what});
}

double Recording::mark(std::string_view what) const {
  const auto found = first("mark", what);
  if (!found) {
    throw std::runtime_error("no mark " + std::string(what));
  }
  return found->time_s;
}

std::optional<Recording::Event> Recording::first(std::string_view kind, std::string_view what,
                                                 double after_s) const {
  const auto found = std::find_if(events.begin(), events.end(), [&](const Event& event) {
    return event.time_s >= after_s && event.kind == kind && event.what.starts_with(what);
  });
  return found == events.end() ? std::nullopt : std::optional(*found);
}

std::vector<std::string> Recording::order(std::string_view kind, double after_s,
                                          double before_s) const {
  std::vector<std::string> out;
  for (const Event& event : events) {
    if (event.kind == kind && event.time_s >= after_s && event.time_s < before_s &&
        (out.empty() || out.back() != event.what)) {
      out.push_back(event.what);
    }
  }
  return out;
}

std::vector<Recording::Moment> Recording::between(double after_s, double before_s) const {
  std::vector<Moment> out;
  std::copy_if(path.begin(), path.end(), std::back_inserter(out), [&](const Moment& moment) {
    return moment.time_s >= after_s && moment.time_s < before_s;
  });
  return out;
}

Recording::Moment Recording::at(double time_s) const {
  if (path.empty()) {
    throw std::runtime_error("a recording without a path");
  }
  const auto later =
      std::lower_bound(path.begin(), path.end(), time_s,
                       [](const Moment& moment, double time) { return moment.time_s < time; });
  if (later == path.begin() || later == path.end()) {
    return later == path.begin() ? path.front() : path.back();
  }
  const Moment& a = *(later - 1);
  const Moment& b = *later;
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  return {time_s, a.position_m + share * (b.position_m - a.position_m),
          a.velocity_mps + share * (b.velocity_mps - a.velocity_mps),
          wrap_to_pi(a.yaw_rad + share * wrap_to_pi(b.yaw_rad - a.yaw_rad))};
}

std::ostream& operator<<(std::ostream& out, const Recording& recording) {
  for (const std::string& line : recording.provenance) {
    out << "# " << line << '\n';
  }
  out << "# at: x y z [m], vx vy vz [m/s], yaw [rad] of the body's truth; z down\n" << std::fixed;
  auto event = recording.events.begin();
  const auto write_until = [&](double time_s) {
    for (; event != recording.events.end() && event->time_s <= time_s; ++event) {
      out << std::setprecision(2) << event->time_s << ',' << event->kind << ',' << event->what
          << '\n';
    }
  };
  for (const Recording::Moment& moment : recording.path) {
    write_until(moment.time_s);
    out << std::setprecision(2) << moment.time_s << ',' << kPlace << std::setprecision(3);
    for (const double x : moment.position_m) {
      out << ',' << x;
    }
    out << std::setprecision(2);
    for (const double v : moment.velocity_mps) {
      out << ',' << v;
    }
    out << ',' << moment.yaw_rad << '\n';
  }
  write_until(1e9);
  return out;
}

Recording read_recording(std::istream& in) {
  Recording out;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("# ")) {
      out.provenance.push_back(line.substr(2));
      continue;
    }
    std::istringstream words(line);
    Recording::Event event;
    char comma = 0;
    if (!(words >> event.time_s >> comma) || !std::getline(words, event.kind, ',')) {
      throw std::runtime_error("not of a recording: " + line);
    }
    if (event.kind != kPlace) {
      std::getline(words, event.what);
      out.events.push_back(event);
      continue;
    }
    Recording::Moment& moment = out.path.emplace_back();
    moment.time_s = event.time_s;
    for (double* const number :
         {&moment.position_m.x(), &moment.position_m.y(), &moment.position_m.z(),
          &moment.velocity_mps.x(), &moment.velocity_mps.y(), &moment.velocity_mps.z(),
          &moment.yaw_rad}) {
      if (!(words >> *number)) {
        throw std::runtime_error("not of a recording: " + line);
      }
      words >> comma;
    }
  }
  return out;
}

}  // namespace vantage::test
