#include "drivers/crazyflie/table_fetch.hpp"

#include <algorithm>

namespace vantage::drivers {
namespace {

namespace crtp = wire::crtp;

constexpr std::size_t kUnderWayMax = 4;
constexpr Duration kRequestRepeat = std::chrono::milliseconds(100);

}  // namespace

void TableFetch::receive(const crtp::Packet& packet, TableCache& cache) {
  if (const auto info = crtp::decode_toc_info(port_, packet); info && !info_) {
    info_ = info;
    if (const auto known = cache.find(port_, *info); known && known->size() == info->items) {
      for (const crtp::TocItem& item : *known) {
        items_[item.id] = item;
      }
    }
    return;
  }
  const auto item = crtp::decode_toc_item(port_, packet);
  if (!item || !info_ || item->id >= info_->items) {
    return;
  }
  requested_.erase(item->id);
  const bool was_complete = is_complete();
  items_[item->id] = *item;
  if (is_complete() && !was_complete) {
    std::vector<crtp::TocItem> all;
    std::ranges::transform(items_, std::back_inserter(all), [](const auto& e) { return e.second; });
    cache.store(port_, *info_, all);
  }
}

void TableFetch::tick(Time now, std::vector<crtp::Packet>& out) {
  if (!info_) {
    if (now >= next_info_) {
      next_info_ = now + kRequestRepeat;
      out.push_back(crtp::toc_info_request(port_));
    }
    return;
  }
  for (auto& [id, at] : requested_) {
    if (now - at >= kRequestRepeat) {
      at = now;
      out.push_back(crtp::toc_item_request(port_, id));
    }
  }
  while (!is_complete() && requested_.size() < kUnderWayMax && next_item_ < info_->items) {
    if (!items_.contains(next_item_)) {
      requested_[next_item_] = now;
      out.push_back(crtp::toc_item_request(port_, next_item_));
    }
    ++next_item_;
  }
}

const crtp::TocItem* TableFetch::find(const std::string& full_name) const {
  const auto found = std::ranges::find_if(
      items_, [&](const auto& each) { return each.second.full_name() == full_name; });
  return found == items_.end() ? nullptr : &found->second;
}

}  // namespace vantage::drivers
