#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <unistd.h>

#include "logs/file/log_event.hpp"

namespace vantage::logs::test {

using Bytes = std::vector<std::uint8_t>;

/// A folder of this test's own, gone with it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "vantage_logs_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  TemporaryFolder(TemporaryFolder&&) = delete;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

inline void write_file(const std::string& path, const Bytes& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
}

inline Bytes read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

template <class Wire>
Bytes encoded(const Wire& wire) {
  Bytes out(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(out.data(), 0, static_cast<int>(out.size()));
  return out;
}

template <class Wire>
void append_message(const Wire& wire, std::int64_t number, std::int64_t utime,
                    const std::string& channel, Bytes& log) {
  const Bytes data = encoded(wire);
  append_event({number, from_utime(utime), channel, data}, log);
}

}  // namespace vantage::logs::test
