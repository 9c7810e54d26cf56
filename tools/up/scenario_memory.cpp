#include "tools/up/scenario_memory.hpp"

#include <cerrno>
#include <cstddef>
#include <cstring>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "core/check.hpp"

namespace vantage::tools {

ScenarioMemory::ScenarioMemory(const std::string& yaml)
    : descriptor_(::memfd_create("vantage-scenario.yaml", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
  std::size_t done = 0;
  while (descriptor_ >= 0 && done < yaml.size()) {
    const ssize_t count = ::write(descriptor_, yaml.data() + done, yaml.size() - done);
    if (count < 0 && errno != EINTR) {
      break;
    }
    done += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  if (descriptor_ < 0 || done < yaml.size()) {
    const std::string why = std::strerror(errno);
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
    throw StartupError("cannot store the scenario in memory for the processes: " + why);
  }
  ::fcntl(descriptor_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL);
}

ScenarioMemory::~ScenarioMemory() { ::close(descriptor_); }

std::string ScenarioMemory::path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

}  // namespace vantage::tools
