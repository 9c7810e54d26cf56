// Writes a fuzzer's initial inputs, one file each, into the folder named by the argument.

#include <fstream>
#include <string>

#include "test/fuzz/bus/packet_path.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    return 2;
  }
  int number = 0;
  for (const auto& sample : vantage::test::packet_path_samples()) {
    std::ofstream file(std::string(argv[1]) + "/sample_" + std::to_string(number++),
                       std::ios::binary);
    file.write(reinterpret_cast<const char*>(sample.data()),
               static_cast<std::streamsize>(sample.size()));
    if (!file.flush()) {
      return 1;
    }
  }
  return 0;
}
