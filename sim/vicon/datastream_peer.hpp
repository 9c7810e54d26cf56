#pragma once

#include <string>
#include <vector>

#include "sim/vicon/peer.hpp"
#include "wire/vicon/datastream_blocks.hpp"

namespace vantage::sim::vicon {

/// One client of the emulated DataStream.
///
/// It says what it has; it answers pings at once, sends what was asked for so far, pushed or one
/// frame a request, and static content (subjects, rate, axis, quality) once after each change of
/// what is asked for or of the subjects; after that its Contents call it unchanged.
class DataStreamPeer : public Peer {
 public:
  explicit DataStreamPeer(const ServerSettings& settings);

  [[nodiscard]] bool receive(wire::vicon::Bytes bytes) override;
  void on_frame(const EmulatedFrame& frame) override;

 private:
  void on_block(const wire::vicon::Block& block);
  [[nodiscard]] bool is_asked(std::uint32_t type) const;
  [[nodiscard]] bool has_new_subjects(const EmulatedFrame& frame);
  void append_contents(wire::vicon::PacketWriter& packet, const EmulatedFrame& frame,
                       bool has_static) const;
  void append_static(wire::vicon::PacketWriter& packet) const;
  void append_dynamic(wire::vicon::PacketWriter& packet, const EmulatedFrame& frame) const;
  void append_poses(wire::vicon::PacketWriter& packet, const EmulatedFrame& frame) const;

  ServerSettings settings_;
  wire::vicon::StreamBuffer stream_;
  wire::vicon::ObjectEnums asked_;
  std::vector<std::string> subjects_;
  bool is_static_due_ = true;
  bool is_streaming_ = false;
  std::uint32_t frames_wanted_ = 0;  ///< one by one
};

}  // namespace vantage::sim::vicon
