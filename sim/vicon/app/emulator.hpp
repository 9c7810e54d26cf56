#pragma once

namespace vantage::sim::vicon {

/// Runs vantage-vicon-emulator: parses its flags (see --help) and serves until it is stopped or its
/// recording ends. Returns the exit code.
/// @throws StartupError for a port or a file that cannot be used.
int run_emulator(int argc, char** argv);

}  // namespace vantage::sim::vicon
