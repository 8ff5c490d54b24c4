// What the core asks of a board. The Due sketch and the host program each implement it; the core knows neither.
#pragma once
#include <cstddef>
#include <cstdint>

namespace rig {

class Hardware {
 public:
  virtual std::uint32_t micros() = 0;   // wraps after 71.6 minutes; Clock extends it
  virtual std::uint32_t boot_id() = 0;  // differs from boot to boot (the Due has a random generator)

  virtual int read_byte() = 0;  // -1 when none waits
  // Takes up to `size` bytes without blocking; returns how many it took.
  virtual std::size_t write_bytes(const std::uint8_t* data, std::size_t size) = 0;

  virtual void servo_pulse(std::uint16_t microseconds) = 0;
  virtual void servo_off() = 0;  // no pulse any more: the servo is limp
  virtual bool servo_angle(std::int32_t& microradians) = 0;  // false where the servo has no position feedback
  virtual std::uint16_t servo_current_ma() = 0;              // 0 where not measured

  virtual bool cell_data() = 0;            // HX711 DOUT; low: a conversion waits
  virtual void cell_clock(bool high) = 0;  // HX711 PD_SCK, then at least 0.2 us
  virtual void interrupts(bool enabled) = 0;

  virtual void led(bool on) = 0;

 protected:
  ~Hardware() = default;
};

// 64-bit microseconds from a 32-bit counter; call at least once in 71 minutes.
class Clock {
 public:
  std::uint64_t now(Hardware& hardware) {
    const std::uint32_t low = hardware.micros();
    if (low < last_) high_ += std::uint64_t{1} << 32;
    last_ = low;
    return high_ | low;
  }

 private:
  std::uint32_t last_ = 0;
  std::uint64_t high_ = 0;
};

}  // namespace rig
