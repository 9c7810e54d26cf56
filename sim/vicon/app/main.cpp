// vantage-vicon-emulator: an emulated Vicon or VRPN server that sends bodies on circles, recorded
// flights or a scenario's world.

#include "core/process.hpp"
#include "sim/vicon/app/emulator.hpp"

int main(int argc, char** argv) {
  return vantage::run_process("vantage-vicon-emulator",
                              [&] { return vantage::sim::vicon::run_emulator(argc, argv); });
}
