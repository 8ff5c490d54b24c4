// The core's hardware, simulated: pins, line and time. Board time runs `rate` times as fast as the host's.
#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "../core/hardware.hpp"
#include "cell.hpp"
#include "faults.hpp"
#include "plant.hpp"
#include "port.hpp"
#include "trace.hpp"

class Simulated : public rig::Hardware {
 public:
  Simulated(Port& port, Plant& plant, const CellSettings& cell, std::uint64_t seed)
      : port_(port), plant_(plant), chip(cell, seed + 1), from_host(seed + 2), to_host(seed + 3) {}

  std::uint32_t micros() override { return static_cast<std::uint32_t>(static_cast<std::uint64_t>(now_us)); }
  std::uint32_t boot_id() override { return boot; }

  int read_byte() override {
    if (incoming_.empty()) return -1;
    const int byte = incoming_.front();
    incoming_.pop_front();
    return byte;
  }
  std::size_t write_bytes(const std::uint8_t* data, std::size_t size) override {
    if (now_us < mute_until_us) return size;
    std::uint8_t bad[2];
    for (std::size_t i = 0; i < size; ++i) outgoing_.insert(outgoing_.end(), bad, bad + to_host.pass(data[i], bad));
    return size;
  }

  void servo_pulse(std::uint16_t microseconds) override {
    if (microseconds != pulse_us) pulse_since_us = now_us;
    pulse_us = microseconds;
  }
  void servo_off() override { servo_pulse(0); }
  bool servo_angle(std::int32_t& microradians) override {
    microradians = static_cast<std::int32_t>(plant_.state().angle_rad * 1e6);
    return true;
  }
  std::uint16_t servo_current_ma() override {
    const double current = jammed ? 5000.0 : plant_.state().current_ma;
    return static_cast<std::uint16_t>(current > 65535.0 ? 65535.0 : current);
  }

  bool cell_data() override { return chip.data(); }
  void cell_clock(bool high) override {
    chip.clock(high, now_us);
    now_us += 0.4;  // a clock edge takes time on a real board too
    if (high && stretch > 0 && --stretch == 0) now_us += 80;  // an interrupt came in the middle of a read
  }
  void interrupts(bool) override {}
  void led(bool on) override {
    led_on = on;
    (on ? led_on_us : led_off_us) = now_us;
  }

  // Takes what has come over the pty, through the bad line.
  void receive() {
    std::uint8_t buffer[512], bad[2];
    long got;
    while ((got = port_.receive(buffer, sizeof buffer)) > 0)
      for (long i = 0; i < got; ++i) incoming_.insert(incoming_.end(), bad, bad + from_host.pass(buffer[i], bad));
  }
  void transmit() {
    if (outgoing_.empty()) return;
    port_.transmit(outgoing_.data(), outgoing_.size());
    outgoing_.clear();
  }
  void reset() {
    incoming_.clear();
    outgoing_.clear();
    pulse_us = 0;
    ++boots;
    boot = boot * 1664525u + 1013904223u;
  }

 private:
  Port& port_;
  Plant& plant_;
  std::deque<std::uint8_t> incoming_;
  std::vector<std::uint8_t> outgoing_;

 public:
  CellChip chip;
  ByteFaults from_host, to_host;
  double now_us = 0, mute_until_us = 0;
  double led_on_us = -1, led_off_us = -1, pulse_since_us = 0;
  std::uint16_t pulse_us = 0;
  std::uint32_t boot = 1;
  int boots = 1, stretch = 0;
  bool led_on = false, jammed = false;
};
