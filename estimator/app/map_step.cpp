#include "estimator/app/map_step.hpp"

#include <algorithm>
#include <memory>

#include "bus/convert/channels.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::estimator {
namespace {

constexpr std::size_t kScansWaiting = 64;
constexpr std::size_t kMapsKeptPerRobot = 16;

template <class Content>
const Content* content_of(const std::optional<NamedMessage<Content>>& message) {
  return message ? message->content.get() : nullptr;
}

}  // namespace

MapPublisher::MapPublisher(bus::Bus& bus, const scenario::Scenario& scenario,
                           const std::string& robot)
    : bus_(bus), robot_(robot), map_(scenario, robot) {
  bus_.subscribe<models::RangeScan>(bus::scan_channel(robot), [this](const auto& scan) {
    if (scan.robot != robot_) {
      ++misaddressed_;
      return;
    }
    if (scans_.size() == kScansWaiting) {
      scans_.pop_front();
      ++scans_overflowed_;
    }
    scans_.push_back({name_of(bus::scan_channel(robot_).name, scan.stamp),
                      std::make_shared<const models::RangeScan>(scan)});
  });
  for (const scenario::RobotSpec& teammate : scenario.robots) {
    if (teammate.name != robot) {
      bus_.subscribe<models::RobotMap>(
          bus::map_channel(teammate.name), [this, sender = teammate.name](const auto& map) {
            if (map.robot != sender) {
              ++misaddressed_;
              return;
            }
            if (!map_.is_of_this_grid(map)) {
              return;
            }
            newest_[sender] = {name_of(bus::map_channel(sender).name, map.stamp),
                               std::make_shared<const models::RobotMap>(map)};
          });
    }
  }
}

void MapPublisher::update_in_range(const models::RobotBelief& belief) {
  for (const auto& [teammate, message] : newest_) {
    if (!map_.accepts(belief, *message.content)) {
      continue;
    }
    in_range_[{teammate, message.ref.run_id}] = message;
    const auto is_of_mate = [&mate = teammate](const auto& each) {
      return each.first.first == mate;
    };
    if (std::count_if(in_range_.begin(), in_range_.end(), is_of_mate) > kRunsKept) {
      in_range_.erase(
          std::min_element(in_range_.begin(), in_range_.end(), [&](const auto& a, const auto& b) {
            const bool is_a_of_mate = is_of_mate(a);
            return is_a_of_mate != is_of_mate(b)
                       ? is_a_of_mate
                       : a.second.content->stamp.time < b.second.content->stamp.time;
          }));
      ++runs_forgotten_;
    }
  }
}

void MapPublisher::step(const models::RobotBelief& belief) {
  update_in_range(belief);
  std::vector<models::InputRef> names{bus_.ref_to(bus::belief_channel(robot_), belief)};
  MapInput input;
  input.belief = &belief;
  input.before = content_of(own_);
  if (own_) {
    names.push_back(own_->ref);
  }
  const auto later = std::stable_partition(scans_.begin(), scans_.end(), [&](const auto& scan) {
    return scan.content->stamp.time <= belief.stamp.time;
  });
  std::vector<const models::RangeScan*> scans;
  for (auto scan = scans_.begin(); scan != later; ++scan) {
    scans.push_back(scan->content.get());
    names.push_back(scan->ref);
  }
  std::vector<const models::RobotMap*> teammates;
  for (const auto& [run, message] : in_range_) {
    teammates.push_back(message.content.get());
    names.push_back(message.ref);
  }
  input.scans = scans;
  input.teammates = teammates;
  models::RobotMap made = map_.step(input);
  made.inputs = std::move(names);
  scans_.erase(scans_.begin(), later);
  const auto channel = bus::map_channel(robot_);
  made = bus_.publish(channel, std::move(made));
  own_ = {bus_.ref_to(channel, made), std::make_shared<const models::RobotMap>(std::move(made))};
}

std::vector<models::NamedCount> MapPublisher::counters() const {
  std::vector<models::NamedCount> all = map_.counters().named();
  models::append_nonzero(all, {{"map.misaddressed", misaddressed_},
                               {"map.runs_forgotten", runs_forgotten_},
                               {"map.scans_overflowed", scans_overflowed_}});
  return all;
}

MapReplayer::MapReplayer(bus::Bus& bus, const scenario::Scenario& scenario,
                         const std::string& robot)
    : bus_(bus), robot_(robot), map_(scenario, robot), maps_(kMapsKeptPerRobot) {
  bus_.subscribe_named<models::RangeScan>(bus::scan_channel(robot),
                                          [this](const std::string& channel, const auto& scan) {
                                            scans_.add(channel, scan);
                                            work();
                                          });
  bus_.subscribe_named<models::RobotBelief>(bus::belief_channel(robot),
                                            [this](const std::string& channel, const auto& belief) {
                                              beliefs_.add(channel, belief);
                                              work();
                                            });
  for (const scenario::RobotSpec& each : scenario.robots) {
    bus_.subscribe_named<models::RobotMap>(
        bus::map_channel(each.name),
        [this, is_own = each.name == robot](const std::string& channel, const auto& map) {
          maps_.add(channel, map);
          if (is_own) {
            logged_.add(map);
          }
          work();
        });
  }
}

bool MapReplayer::recompute(const models::RobotMap& logged) {
  MapInput input;
  std::vector<const models::RangeScan*> scans;
  std::vector<const models::RobotMap*> teammates;
  std::vector<std::pair<models::InputRef, models::RobotMap>> used_maps;
  for (const models::InputRef& name : logged.inputs) {
    const auto previous = std::find_if(previous_maps_.begin(), previous_maps_.end(),
                                       [&](const auto& each) { return each.first == name; });
    const models::RobotMap* map =
        previous != previous_maps_.end() ? &previous->second : maps_.find(name);
    if (const auto* scan = scans_.find(name)) {
      scans.push_back(scan);
    } else if (const auto* belief = beliefs_.find(name)) {
      input.belief = belief;
    } else if (map != nullptr && map->robot == robot_) {
      input.before = map;
    } else if (map != nullptr) {
      teammates.push_back(map);
      used_maps.emplace_back(name, *map);
    } else {
      return false;
    }
  }
  if (input.belief == nullptr) {
    return false;
  }
  input.scans = scans;
  input.teammates = teammates;
  models::RobotMap made = map_.step(input);
  made.inputs = logged.inputs;
  bus_.publish(bus::map_channel(robot_), made);
  previous_maps_ = std::move(used_maps);
  return true;
}

void MapReplayer::work() {
  logged_.work([this](const models::RobotMap& logged, bool is_last_chance) {
    const bool is_done = recompute(logged);
    incomplete_ += !is_done && is_last_chance ? 1 : 0;
    return is_done;
  });
}

void MapReplayer::tick() {
  logged_.tick();
  work();
}

std::vector<models::NamedCount> MapReplayer::counters() const {
  std::vector<models::NamedCount> all = map_.counters().named();
  if (incomplete_ != 0) {
    all.push_back({"map.replay_inputs_missing", incomplete_});
  }
  return all;
}

}  // namespace vantage::estimator
