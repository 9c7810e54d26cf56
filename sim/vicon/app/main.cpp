// vantage-vicon-emulator: a Vicon or VRPN server that is none, of bodies on circles, of recorded
// flights or of a scenario's world.

#include "core/process.hpp"
#include "sim/vicon/app/emulator.hpp"

int main(int argc, char** argv) {
  return vantage::run_process("vantage-vicon-emulator",
                              [&] { return vantage::sim::vicon::run_emulator(argc, argv); });
}
