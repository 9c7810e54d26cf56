#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "wire/crtp/tables.hpp"

namespace vantage::drivers {

/// Tables of contents of Crazyflies, by port and checksum. A table does not change while its
/// checksum is the same, so that it is downloaded once per firmware.
class TableCache {
 public:
  TableCache() = default;
  virtual ~TableCache() = default;
  TableCache(const TableCache&) = delete;
  TableCache& operator=(const TableCache&) = delete;
  TableCache(TableCache&&) = delete;
  TableCache& operator=(TableCache&&) = delete;

  /// Returns the table; nullopt if it is not stored or is damaged.
  virtual std::optional<std::vector<wire::crtp::TocItem>> find(wire::crtp::Port port,
                                                               const wire::crtp::TocInfo& info) = 0;
  virtual void store(wire::crtp::Port port, const wire::crtp::TocInfo& info,
                     const std::vector<wire::crtp::TocItem>& items) = 0;
};

/// Download of one table of contents. A few requests are under way at a time, because the vehicle's
/// queue is short.
class TableFetch {
 public:
  explicit TableFetch(wire::crtp::Port port) : port_(port) {}

  /// Starts again; a table in the cache is not downloaded again.
  void restart() { *this = TableFetch(port_); }
  void receive(const wire::crtp::Packet& packet, TableCache& cache);
  /// Appends the requests that are due.
  void tick(Time now, std::vector<wire::crtp::Packet>& out);

  [[nodiscard]] bool is_complete() const { return info_ && items_.size() == info_->items; }
  /// Returns the variable with this full name; null if the table has none.
  [[nodiscard]] const wire::crtp::TocItem* find(const std::string& full_name) const;
  [[nodiscard]] std::size_t received() const { return items_.size(); }
  [[nodiscard]] std::size_t size() const { return info_ ? info_->items : 0; }

 private:
  wire::crtp::Port port_;
  std::optional<wire::crtp::TocInfo> info_;
  std::map<std::uint16_t, wire::crtp::TocItem> items_;
  std::map<std::uint16_t, Time> requested_;  ///< time of each request without an answer
  Time next_info_{};
  std::uint16_t next_item_ = 0;
};

}  // namespace vantage::drivers
