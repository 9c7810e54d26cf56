#pragma once

namespace vantage::sim::vicon {

/// The whole of vantage-vicon-emulator: parses its flags (see --help), serves until it is asked to
/// end or its recording is over; the exit code.
/// @throws StartupError for a port or a file that cannot be used.
int run_emulator(int argc, char** argv);

}  // namespace vantage::sim::vicon
