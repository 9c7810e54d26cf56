#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/crazyflie/table_fetch.hpp"

namespace vantage::drivers {

/// Tables of contents as text files in one folder. A file that cannot be read or written is treated
/// as absent: the table is then downloaded again.
class TableFiles : public TableCache {
 public:
  explicit TableFiles(std::string folder) : folder_(std::move(folder)) {}
  /// Returns the user's folder: $XDG_CACHE_HOME/vantage/crazyflie, or ~/.cache/vantage/crazyflie.
  static std::string default_folder();

  std::optional<std::vector<wire::crtp::TocItem>> find(wire::crtp::Port port,
                                                       const wire::crtp::TocInfo& info) override;
  void store(wire::crtp::Port port, const wire::crtp::TocInfo& info,
             const std::vector<wire::crtp::TocItem>& items) override;

 private:
  [[nodiscard]] std::string path(wire::crtp::Port port, const wire::crtp::TocInfo& info) const;

  std::string folder_;
};

}  // namespace vantage::drivers
