#pragma once

#include <string>
#include <vector>

#include "sim/vicon/peer.hpp"
#include "wire/vicon/datastream_blocks.hpp"

namespace vantage::sim::vicon {

/// Server side of one client's connection to the emulated DataStream.
///
/// It announces the available contents and answers pings immediately. It sends the requested
/// contents, either streamed or one frame per request. Static content (subjects, rate, axis,
/// quality) is sent once after each change of the request or of the subjects; later Contents blocks
/// mark it as unchanged.
class DataStreamPeer : public Peer {
 public:
  explicit DataStreamPeer(const ServerSettings& settings);

  [[nodiscard]] bool receive(wire::vicon::Bytes bytes) override;
  void on_frame(const EmulatedFrame& frame) override;

 private:
  void on_block(const wire::vicon::Block& block);
  [[nodiscard]] bool is_requested(std::uint32_t type) const;
  [[nodiscard]] bool has_new_subjects(const EmulatedFrame& frame);
  void append_contents(wire::vicon::PacketWriter& packet, const EmulatedFrame& frame,
                       bool has_static) const;
  void append_static(wire::vicon::PacketWriter& packet) const;
  void append_dynamic(wire::vicon::PacketWriter& packet, const EmulatedFrame& frame) const;
  void append_poses(wire::vicon::PacketWriter& packet, const EmulatedFrame& frame) const;

  ServerSettings settings_;
  wire::vicon::StreamBuffer stream_;
  wire::vicon::ObjectEnums requested_;
  std::vector<std::string> subjects_;
  bool is_static_due_ = true;
  bool is_streaming_ = false;
  std::uint32_t frames_wanted_ = 0;  ///< number of single requested frames not yet sent
};

}  // namespace vantage::sim::vicon
