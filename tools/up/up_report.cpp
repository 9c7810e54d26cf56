#include "tools/up/up_report.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "bus/auth/authenticator.hpp"
#include "bus/convert/channels.hpp"

namespace vantage::tools {
namespace {

using Json = nlohmann::ordered_json;
using models::SupervisedPhase;

bool is_given_up(const SupervisedStatus& process) {
  return process.phase == SupervisedPhase::kGivenUp;
}

bool has_fallen(const SupervisedStatus& process) {
  return process.restarts > 0 || process.down_s > 0.0 || is_given_up(process);
}

Json to_json(const SupervisedStatus& process) {
  return {{"name", process.name},
          {"restarts", process.restarts},
          {"down_s", process.down_s},
          {"given_up", is_given_up(process)},
          {"essential", process.is_essential},
          {"last_end", process.last_end}};
}

}  // namespace

std::int64_t contacts_unverified(const std::vector<models::NamedCount>& counters) {
  std::int64_t out = 0;
  for (const models::NamedCount& counter : counters) {
    const auto refusal = bus::auth::parse_refusal(counter.name);
    out += refusal && refusal->channel == bus::kCollision.name ? counter.count : 0;
  }
  return out;
}

bool is_good(const UpResult& result) {
  return std::none_of(result.processes.begin(), result.processes.end(), is_given_up) &&
         result.killed.empty() && result.cut_short.empty() && result.ended_badly.empty() &&
         result.never_flown.empty() && result.left_flying.empty() && result.world_restarts == 0 &&
         !result.has_other_scenario && result.broken.empty() && !result.log_was_unwritten &&
         result.log.is_to_the_end && result.log.is_good && result.summary.collisions == 0;
}

std::vector<std::string> remarks(const UpResult& result) {
  std::vector<std::string> out;
  for (const SupervisedStatus& process : result.processes) {
    if (has_fallen(process)) {
      out.push_back(fmt::format(
          "{}: {} restarts, {:.1f} s down, {}", process.name, process.restarts, process.down_s,
          is_given_up(process) ? "given up (" + process.last_end + ")"
                               : std::string(name_of(process.phase)) + " at the end"));
    }
  }
  if (result.world_restarts > 0) {
    out.push_back(fmt::format(
        "results mix several simulations: the simulator was restarted {} times, and robots and "
        "targets returned to their starts",
        result.world_restarts));
  }
  if (result.log.restarts > 0) {
    out.push_back(
        fmt::format("log: {:.2f} s not recorded, {} bytes of an incomplete event removed; "
                    "event numbers start again",
                    result.log.unrecorded_s, result.log.bytes_dropped));
  }
  if (result.log_was_unwritten) {
    out.push_back("log: could not be written for some time");
  }
  if (!result.log.is_good && !result.log_was_unwritten && result.killed.empty()) {
    out.push_back("log: some received messages are missing or not safely on the disk");
  }
  if (!result.log.is_to_the_end) {
    out.push_back("log: incomplete: the last messages are missing");
  }
  if (result.contacts_unverified > 0) {
    out.push_back(fmt::format(
        "{} messages on COLLISION had no valid signature; not counted with `mode: require`",
        result.contacts_unverified));
  }
  if (result.has_other_scenario) {
    out.push_back("another host used another scenario file");
  }
  if (!result.broken.empty()) {
    out.push_back("the trial ended because of an internal error: " + result.broken);
  }
  for (const std::string& name : result.killed) {
    out.push_back(name + " did not end when requested and was killed");
  }
  for (const std::string& name : result.cut_short) {
    out.push_back(name + " was killed at once because of another Ctrl-C");
  }
  for (const std::string& name : result.ended_badly) {
    out.push_back(name + " ended with an error");
  }
  for (const std::string& name : result.never_flown) {
    out.push_back(name + " never followed a plan");
  }
  for (const std::string& name : result.left_flying) {
    out.push_back(name + " had not landed when its driver was ended");
  }
  return out;
}

Json to_json(const UpResult& result) {
  Json out = logs::to_json(result.summary);
  Json processes = Json::array();
  Json given_up = Json::array();
  int restarts = 0;
  for (const SupervisedStatus& process : result.processes) {
    restarts += process.restarts;
    if (has_fallen(process)) {
      processes.push_back(to_json(process));
    }
    if (is_given_up(process)) {
      given_up.push_back(process.name);
    }
  }
  out["restarts"] = restarts;
  out["given_up"] = std::move(given_up);
  out["processes"] = std::move(processes);
  out["world_restarts"] = result.world_restarts;
  out["log"] = {{"path", result.log.path},
                {"restarts", result.log.restarts},
                {"unrecorded_s", result.log.unrecorded_s},
                {"bytes_dropped", result.log.bytes_dropped},
                {"was_unwritten", result.log_was_unwritten},
                {"is_to_the_end", result.log.is_to_the_end},
                {"is_good", result.log.is_good}};
  out["killed"] = result.killed;
  out["cut_short"] = result.cut_short;
  out["ended_badly"] = result.ended_badly;
  out["never_flown"] = result.never_flown;
  out["left_flying"] = result.left_flying;
  out["contacts_unverified"] = result.contacts_unverified;
  out["other_scenario"] = result.has_other_scenario;
  out["broken"] = result.broken;
  out["stop_s"] = result.stop_s;
  return out;
}

}  // namespace vantage::tools
