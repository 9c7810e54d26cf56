#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace vantage::drivers {

/// USB connection with a Crazyradio dongle, as libusb offers it: vendor requests and bulk
/// transfers. Calls block for at most a few milliseconds. A failure means that the dongle was
/// removed or does not answer; the connection is then opened again.
class UsbRadio {
 public:
  UsbRadio() = default;
  virtual ~UsbRadio() = default;
  UsbRadio(const UsbRadio&) = delete;
  UsbRadio& operator=(const UsbRadio&) = delete;
  UsbRadio(UsbRadio&&) = delete;
  UsbRadio& operator=(UsbRadio&&) = delete;

  /// Opens the dongle. Returns false if it is not connected or another program uses it.
  virtual bool open() = 0;
  virtual void close() = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  /// Sends a vendor request. Returns false after a failure.
  virtual bool control(std::uint8_t request, std::uint16_t value,
                       std::span<const std::uint8_t> data) = 0;
  /// Sends one packet. Returns false after a failure.
  virtual bool write(std::span<const std::uint8_t> packet) = 0;
  /// Reads the answer to the last packet: a status byte and the payload of the acknowledgement.
  /// Returns the number of bytes; 0 if there is no answer in time; nullopt after a failure.
  virtual std::optional<std::size_t> read(std::span<std::uint8_t> buffer) = 0;
};

/// Vendor requests of a Crazyradio.
namespace radio_request {
inline constexpr std::uint8_t kChannel = 0x01;
inline constexpr std::uint8_t kAddress = 0x02;
inline constexpr std::uint8_t kDataRate = 0x03;
inline constexpr std::uint8_t kPower = 0x04;
inline constexpr std::uint8_t kRetryDelay = 0x05;
inline constexpr std::uint8_t kRetries = 0x06;
inline constexpr std::uint8_t kAcknowledge = 0x10;
inline constexpr std::uint8_t kCarrier = 0x20;
}  // namespace radio_request

/// Returns the connected dongle number `index`, opened by libusb.
std::unique_ptr<UsbRadio> make_usb_radio(int index);

}  // namespace vantage::drivers
