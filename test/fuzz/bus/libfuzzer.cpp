// Entry point of libFuzzer.

#include "test/fuzz/bus/packet_path.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  vantage::test::fuzz_packet_path({bytes, size});
  return 0;
}
