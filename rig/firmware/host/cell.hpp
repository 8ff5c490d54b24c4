// An HX711 as its pins show it: conversions at its real rate, bits under the clock's control, power-down, a cut cable.
#pragma once
#include <cmath>
#include <cstdint>
#include <random>

struct CellSettings {
  double period_us = 10700;  // the fast rate; the slow one is 85600
  double offset = 52000;     // counts at no force
  double counts_per_newton = 180000;
  double noise_counts = 60;  // standard deviation
};

class CellChip {
 public:
  CellChip(const CellSettings& settings, std::uint64_t seed) : settings_(settings), random_(seed) {}
  bool stuck = false;  // the cable is off: DOUT floats high

  // A conversion ends when its time has come, and replaces one that nobody read.
  void advance(double now_us, double force_n) {
    if (clock_high_ && now_us - rise_us_ > kPowerDownUs) {
      ready_ = false;
      return;
    }
    if (now_us < next_us_) return;
    next_us_ += settings_.period_us;
    if (now_us > next_us_) next_us_ = now_us + settings_.period_us;
    const double noise = std::normal_distribution<double>(0, settings_.noise_counts)(random_);
    const double counts = std::round(settings_.offset + settings_.counts_per_newton * force_n + noise);
    value_ = static_cast<std::int32_t>(std::fmax(-8388608.0, std::fmin(8388607.0, counts)));
    shifted_ = 0;
    ready_ = true;
    ++conversions_;
  }

  void clock(bool high, double now_us) {
    if (high && !clock_high_) {
      rise_us_ = now_us;
      if (ready_ && shifted_ < 25) ++shifted_;
    }
    if (!high && clock_high_) {
      if (now_us - rise_us_ > kPowerDownUs) {  // it was down, and wakes: four conversions to settle (data sheet)
        ready_ = false;
        next_us_ = now_us + 4 * settings_.period_us;
      } else if (shifted_ == 25) {
        ready_ = false;
      }
    }
    clock_high_ = high;
  }

  bool data() const {
    if (stuck || !ready_) return true;
    if (shifted_ == 0) return false;
    return shifted_ > 24 || ((static_cast<std::uint32_t>(value_) >> (24 - shifted_)) & 1u) != 0;
  }

  std::uint64_t conversions() const { return conversions_; }

 private:
  static constexpr double kPowerDownUs = 60;
  CellSettings settings_;
  std::mt19937_64 random_;
  double next_us_ = 0, rise_us_ = 0;
  std::int32_t value_ = 0;
  int shifted_ = 0;
  bool ready_ = false, clock_high_ = false;
  std::uint64_t conversions_ = 0;
};
