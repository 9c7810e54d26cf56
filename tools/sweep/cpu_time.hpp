#pragma once

namespace vantage::tools {

/// CPU seconds that the calling thread has used.
double thread_cpu_s();

}  // namespace vantage::tools
