#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include <unistd.h>

#include "core/write_file.hpp"

namespace vantage::tools {

/// A scenario file that lives as long as the processes that read it.
class TemporaryScenario {
 public:
  explicit TemporaryScenario(const std::string& yaml) {
    const auto name = "vantage-" + std::to_string(::getpid()) + ".yaml";
    path_ = std::filesystem::temp_directory_path() / name;
    write_file(path_.string(), yaml);
  }
  ~TemporaryScenario() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryScenario(const TemporaryScenario&) = delete;
  TemporaryScenario& operator=(const TemporaryScenario&) = delete;
  TemporaryScenario(TemporaryScenario&&) = delete;
  TemporaryScenario& operator=(TemporaryScenario&&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace vantage::tools
