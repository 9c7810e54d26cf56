#pragma once

#include <string_view>

namespace vantage::bus {

/// True for counters of inputs that a process rejects by its rules while everything works:
/// detections outside a gate, detections from which nothing can be discovered, and scans of jammed
/// sensors.
bool is_rejection(std::string_view counter);

/// True for counters that change in normal operation and do not make a process "degraded": traffic,
/// durations, kinds of rounds, and rejections.
bool is_normal_counter(std::string_view counter);

}  // namespace vantage::bus
