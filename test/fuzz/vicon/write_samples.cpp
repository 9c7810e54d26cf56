// Writes a fuzzer's initial inputs, the bytes of correct servers and clients, one file each, into
// the folder named by the argument.

#include <fstream>
#include <string>

#include "test/fuzz/vicon/harness.hpp"

int main(int argc, char** argv) {
  using vantage::scenario::MocapProtocol;
  if (argc != 2) {
    return 2;
  }
  int number = 0;
  for (const auto protocol :
       {MocapProtocol::kDataStream, MocapProtocol::kObjectStream, MocapProtocol::kVrpn}) {
    auto samples = vantage::test::server_samples(protocol);
    if (protocol != MocapProtocol::kObjectStream) {
      for (auto& sample : vantage::test::client_samples(protocol)) {
        samples.push_back(sample);
      }
    }
    for (const auto& sample : samples) {
      std::ofstream file(std::string(argv[1]) + "/sample_" + std::to_string(number++),
                         std::ios::binary);
      file.write(reinterpret_cast<const char*>(sample.data()),
                 static_cast<std::streamsize>(sample.size()));
    }
  }
  return 0;
}
