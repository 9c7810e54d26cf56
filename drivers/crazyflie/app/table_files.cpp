#include "drivers/crazyflie/app/table_files.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <unistd.h>

namespace vantage::drivers {

namespace crtp = wire::crtp;

std::string TableFiles::default_folder() {
  const char* const cache = std::getenv("XDG_CACHE_HOME");
  const char* const home = std::getenv("HOME");
  const std::string base = cache != nullptr && *cache != '\0' ? std::string(cache)
                           : home != nullptr                  ? std::string(home) + "/.cache"
                                                              : "/tmp";
  return base + "/vantage/crazyflie";
}

std::string TableFiles::path(crtp::Port port, const crtp::TocInfo& info) const {
  return fmt::format("{}/{}-{:08x}-{}.txt", folder_,
                     port == crtp::Port::kLog ? "log" : "parameters", info.crc, info.items);
}

// One line per item: id, type, read-only, group, name. The last line is "end".
std::optional<std::vector<crtp::TocItem>> TableFiles::find(crtp::Port port,
                                                           const crtp::TocInfo& info) {
  std::ifstream file(path(port, info));
  std::vector<crtp::TocItem> out;
  for (std::string line; std::getline(file, line);) {
    if (line == "end") {
      return out.size() == info.items ? std::optional(out) : std::nullopt;
    }
    std::istringstream words(line);
    crtp::TocItem item;
    int type = 0;
    if (!(words >> item.id >> type >> item.is_read_only >> item.group >> item.name) || type < 0 ||
        type > static_cast<int>(crtp::ValueType::kF16) || item.id != out.size()) {
      return std::nullopt;
    }
    item.type = static_cast<crtp::ValueType>(type);
    out.push_back(item);
  }
  return std::nullopt;
}

void TableFiles::store(crtp::Port port, const crtp::TocInfo& info,
                       const std::vector<crtp::TocItem>& items) {
  std::error_code failed;
  std::filesystem::create_directories(folder_, failed);
  const std::string wanted = path(port, info);
  // Drivers of several vehicles may write the same table at the same time.
  const std::string own = wanted + "." + std::to_string(::getpid());
  {
    std::ofstream file(own);
    for (const crtp::TocItem& item : items) {
      file << item.id << ' ' << static_cast<int>(item.type) << ' ' << item.is_read_only << ' '
           << item.group << ' ' << item.name << '\n';
    }
    file << "end\n";
    if (!file) {
      return;
    }
  }
  std::filesystem::rename(own, wanted, failed);
}

}  // namespace vantage::drivers
