#include "logs/foxglove/session_watch.hpp"

#include <algorithm>

namespace vantage::logs::foxglove {

bool SessionWatch::on(const models::ScenarioNotice& notice, Time received_at) {
  const std::int64_t run = notice.stamp.run_id;
  if (yaml_ == notice.yaml && known_.contains(run)) {
    known_[run] = received_at;
    known_.merge(candidates_);
    candidates_.clear();
    return false;
  }
  const bool is_active = std::any_of(known_.begin(), known_.end(), [&](const auto& each) {
    return received_at - each.second <= kOverdue;
  });
  if (yaml_ == notice.yaml && is_active) {
    if (known_.size() + candidates_.size() < kPublishersMax) {
      candidates_[run] = received_at;
    }
    return false;
  }
  yaml_ = notice.yaml;
  known_ = {{run, received_at}};
  candidates_.clear();
  return true;
}

}  // namespace vantage::logs::foxglove
