#include "tools/view/connection_table.hpp"

#include <algorithm>

namespace vantage::tools {

void ConnectionTable::end_oldest_of(const std::string& address, std::size_t count,
                                    std::vector<Peer>& ended) {
  for (; count > 0; --count) {
    auto oldest = all_.end();
    for (auto each = all_.begin(); each != all_.end(); ++each) {
      const bool is_of_it = each->second.counts && each->first.address == address;
      if (is_of_it && (oldest == all_.end() || each->second.since < oldest->second.since)) {
        oldest = each;
      }
    }
    oldest->second.counts = false;
    ended.push_back(oldest->first);
  }
}

std::vector<ConnectionTable::Peer> ConnectionTable::update(const std::set<Peer>& open, Time now) {
  std::vector<Peer> ended;
  std::erase_if(all_, [&](const auto& each) { return !open.contains(each.first); });
  for (const Peer& peer : open) {
    Connection& connection = entry(peer, now);
    if (connection.counts && !connection.has_request && now - connection.since > kHeaderPatience) {
      connection.counts = false;
      ended.push_back(peer);
    }
  }
  std::map<std::string, std::size_t> counts;
  std::size_t sum = 0;
  for (const auto& [peer, connection] : all_) {
    counts[peer.address] += connection.counts ? 1 : 0;
  }
  for (auto& [address, count] : counts) {
    const std::size_t kept = std::min(count, kOfOneAddressMax);
    end_oldest_of(address, count - kept, ended);
    sum += count = kept;
  }
  for (; sum > kOfAllMax; --sum) {
    const auto most =
        std::max_element(counts.begin(), counts.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    end_oldest_of(most->first, 1, ended);
    --most->second;
  }
  return ended;
}

}  // namespace vantage::tools
