#include "drivers/safety/authority.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::drivers {

bool PlannerLease::admit(std::int64_t run_id, Time now, double lease_s) {
  if (!received_at_ || run_id == holder_ || to_seconds(now - *received_at_) > lease_s) {
    takeovers_ += received_at_ && run_id != holder_ ? 1 : 0;
    holder_ = run_id;
    received_at_ = now;
    return true;
  }
  other_received_at_ = now;
  return false;
}

OperatorAuthority::Station* OperatorAuthority::find(std::int64_t run_id) {
  const auto end = stations_.begin() + static_cast<std::ptrdiff_t>(station_count_);
  const auto found = std::find_if(stations_.begin(), end, [run_id](const Station& station) {
    return station.run_id == run_id;
  });
  return found == end ? nullptr : &*found;
}

OperatorAuthority::Station& OperatorAuthority::new_station() {
  if (station_count_ < kStationsMax) {
    return stations_[station_count_++];
  }
  const auto last = [this](const Station& station) {
    return received_at_ && station.run_id == in_charge_ ? Time::max() : station.received_at;
  };
  return *std::min_element(stations_.begin(), stations_.end(),
                           [&](const auto& a, const auto& b) { return last(a) < last(b); });
}

bool OperatorAuthority::is_current(Time stamp, Duration ahead, Time now) {
  return std::abs(to_seconds(now + ahead - stamp)) <= kFreshS;
}

OperatorAuthority::Station* OperatorAuthority::learn(const models::OperatorCommand& command,
                                                     Time now) {
  const models::Stamp& stamp = command.stamp;
  Station* const station = find(stamp.run_id);
  if (command.action != models::OperatorAction::kHeartbeat) {
    return station;
  }
  if (is_current(stamp.time, {}, now)) {
    if (station == nullptr) {
      Station& added = new_station();
      added = {stamp.run_id, stamp.sequence - 1, stamp.time, now, {}};
      return &added;
    }
    clocks_set_ += station->ahead != Duration{} ? 1 : 0;
    station->ahead = {};
    return station;
  }
  const bool is_continuation = station != nullptr && stamp.sequence > station->sequence &&
                               stamp.sequence - station->sequence <= kLostMax;
  if (is_continuation && !is_current(stamp.time, station->ahead, now)) {
    ++clocks_set_;
    station->ahead = stamp.time - now;
  }
  return station;
}

bool OperatorAuthority::admit(const models::OperatorCommand& command, Time now, double silent_s) {
  const models::OperatorAction action = command.action;
  const models::Stamp& stamp = command.stamp;
  Station* const station = learn(command, now);
  const bool is_newer =
      station != nullptr && (stamp.sequence > station->sequence || stamp.time > station->stamp);
  const bool is_now = is_current(stamp.time, {}, now) ||
                      (station != nullptr && is_current(stamp.time, station->ahead, now));
  const bool is_late = station != nullptr && stamp.sequence > station->sequence;
  if (!is_now && !(models::makes_safer(action) && is_late)) {
    ++not_current_;
    return false;
  }
  const bool takes_over = action == models::OperatorAction::kHeartbeat && station != nullptr &&
                          is_newer &&
                          (!received_at_ || (stamp.run_id != in_charge_ && age_s(now) > silent_s));
  if (takes_over) {
    handovers_ += received_at_ ? 1 : 0;
    in_charge_ = stamp.run_id;
    received_at_ = now;
  }
  const bool counts = received_at_ && stamp.run_id == in_charge_ && is_newer && is_now;
  if (counts) {
    received_at_ = now;
  }
  if (is_newer && is_now) {
    station->sequence = stamp.sequence;
    station->stamp = stamp.time;
    station->received_at = now;
  } else if (is_late) {
    station->sequence = stamp.sequence;  // accept a late command only once
  }
  return counts || models::makes_safer(action);
}

void OperatorAuthority::count(std::vector<models::NamedCount>& out) const {
  out.push_back({"operator.handovers", handovers_});
  out.push_back({"operator.other_time", not_current_});
  out.push_back({"operator.clock_set", clocks_set_});
}

}  // namespace vantage::drivers
