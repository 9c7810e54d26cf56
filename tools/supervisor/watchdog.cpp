#include "tools/supervisor/watchdog.hpp"

namespace vantage::tools {

void Watchdog::on_sign(const std::string& process, Time now) {
  const auto found = watched_.find(process);
  if (found != watched_.end()) {
    found->second.sign = now;
  }
}

void Watchdog::on_start(const std::string& process) {
  const auto found = watched_.find(process);
  if (found != watched_.end()) {
    found->second.sign.reset();
  }
}

std::vector<std::string> Watchdog::overdue(Time now) {
  std::vector<std::string> out;
  for (auto& [process, watched] : watched_) {
    if (watched.sign && to_seconds(now - *watched.sign) > watched.patience_s) {
      watched.sign.reset();
      out.push_back(process);
    }
  }
  return out;
}

}  // namespace vantage::tools
