#include <algorithm>

#include <libusb.h>

#include "drivers/crazyflie/crazyradio.hpp"

namespace vantage::drivers {
namespace {

constexpr std::uint16_t kVendor = 0x1915;
constexpr std::uint16_t kProduct = 0x7777;
constexpr unsigned kControlTimeoutMs = 100;
constexpr unsigned kWriteTimeoutMs = 20;
constexpr unsigned kReadTimeoutMs = 10;  // longer than all retries of the dongle
constexpr unsigned char kOut = 0x01;
constexpr unsigned char kIn = 0x81;

class LibusbRadio : public UsbRadio {
 public:
  explicit LibusbRadio(int index) : index_(index) {
    if (libusb_init(&context_) != 0) {
      context_ = nullptr;
    }
  }
  ~LibusbRadio() override {
    close_handle();
    if (context_ != nullptr) {
      libusb_exit(context_);
    }
  }
  LibusbRadio(const LibusbRadio&) = delete;
  LibusbRadio& operator=(const LibusbRadio&) = delete;
  LibusbRadio(LibusbRadio&&) = delete;
  LibusbRadio& operator=(LibusbRadio&&) = delete;

  bool open() override {
    close_handle();
    if (context_ == nullptr) {
      return false;
    }
    libusb_device** devices = nullptr;
    const auto count = libusb_get_device_list(context_, &devices);
    int seen = 0;
    for (ssize_t i = 0; i < count && handle_ == nullptr; ++i) {
      libusb_device_descriptor descriptor{};
      const bool is_radio = libusb_get_device_descriptor(devices[i], &descriptor) == 0 &&
                            descriptor.idVendor == kVendor && descriptor.idProduct == kProduct;
      if (is_radio && seen++ == index_ && libusb_open(devices[i], &handle_) != 0) {
        handle_ = nullptr;
        break;
      }
    }
    if (count >= 0) {
      libusb_free_device_list(devices, 1);
    }
    if (handle_ != nullptr && libusb_claim_interface(handle_, 0) != 0) {
      libusb_close(handle_);
      handle_ = nullptr;
    }
    return handle_ != nullptr;
  }
  void close() override { close_handle(); }
  [[nodiscard]] bool is_open() const override { return handle_ != nullptr; }

  bool control(std::uint8_t request, std::uint16_t value,
               std::span<const std::uint8_t> data) override {
    std::array<unsigned char, 8> copy{};
    if (handle_ == nullptr || data.size() > copy.size()) {
      return false;
    }
    std::copy(data.begin(), data.end(), copy.begin());
    constexpr auto kType = static_cast<std::uint8_t>(LIBUSB_REQUEST_TYPE_VENDOR);
    return libusb_control_transfer(handle_, kType, request, value, 0, copy.data(),
                                   static_cast<std::uint16_t>(data.size()), kControlTimeoutMs) >= 0;
  }

  bool write(std::span<const std::uint8_t> packet) override {
    std::array<unsigned char, 64> copy{};
    if (handle_ == nullptr || packet.size() > copy.size()) {
      return false;
    }
    std::copy(packet.begin(), packet.end(), copy.begin());
    int sent = 0;
    const int size = static_cast<int>(packet.size());
    return libusb_bulk_transfer(handle_, kOut, copy.data(), size, &sent, kWriteTimeoutMs) == 0 &&
           sent == size;
  }

  std::optional<std::size_t> read(std::span<std::uint8_t> buffer) override {
    if (handle_ == nullptr) {
      return std::nullopt;
    }
    int got = 0;
    const int error = libusb_bulk_transfer(handle_, kIn, buffer.data(),
                                           static_cast<int>(buffer.size()), &got, kReadTimeoutMs);
    if (error == LIBUSB_ERROR_TIMEOUT) {
      return 0;
    }
    return error == 0 ? std::optional(static_cast<std::size_t>(got)) : std::nullopt;
  }

 private:
  void close_handle() {
    if (handle_ != nullptr) {
      libusb_release_interface(handle_, 0);
      libusb_close(handle_);
      handle_ = nullptr;
    }
  }

  int index_;
  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
};

}  // namespace

std::unique_ptr<UsbRadio> make_usb_radio(int index) { return std::make_unique<LibusbRadio>(index); }

}  // namespace vantage::drivers
