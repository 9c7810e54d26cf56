#pragma once

#include <string>
#include <vector>

#include "models/wire/vicon/datastream_blocks.hpp"
#include "sim/vicon/peer.hpp"

namespace vantage::sim::vicon {

/// One client of the emulated DataStream.
///
/// It says what it has; it answers pings at once, sends what was asked for so far, pushed or one
/// frame a request, and static content (subjects, rate, axis, quality) once after each change of
/// what is asked for or of the subjects; after that its Contents call it unchanged.
class DataStreamPeer : public Peer {
 public:
  explicit DataStreamPeer(const ServerSettings& settings);

  [[nodiscard]] bool receive(models::vicon::Bytes bytes) override;
  void on_frame(const EmulatedFrame& frame) override;

 private:
  void on_block(const models::vicon::Block& block);
  [[nodiscard]] bool is_asked(std::uint32_t type) const;
  [[nodiscard]] bool has_new_subjects(const EmulatedFrame& frame);
  void append_contents(models::vicon::PacketWriter& packet, const EmulatedFrame& frame,
                       bool has_static) const;
  void append_static(models::vicon::PacketWriter& packet) const;
  void append_dynamic(models::vicon::PacketWriter& packet, const EmulatedFrame& frame) const;
  void append_poses(models::vicon::PacketWriter& packet, const EmulatedFrame& frame) const;

  ServerSettings settings_;
  models::vicon::StreamBuffer stream_;
  models::vicon::ObjectEnums asked_;
  std::vector<std::string> subjects_;
  bool is_static_due_ = true;
  bool is_streaming_ = false;
  std::uint32_t frames_wanted_ = 0;  ///< one by one
};

}  // namespace vantage::sim::vicon
