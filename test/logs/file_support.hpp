#pragma once

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "logs/file/log_event.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::logs::test {

using Bytes = std::vector<std::uint8_t>;

using vantage::test::TemporaryFolder;

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
