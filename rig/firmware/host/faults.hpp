// A bad line: bytes corrupted, dropped or doubled at given rates. Seeded, so that a run can be repeated.
#pragma once
#include <cstdint>
#include <random>

class ByteFaults {
 public:
  explicit ByteFaults(std::uint64_t seed) : random_(seed) {}
  double corrupt = 0, drop = 0, twice = 0;

  // Writes what arrives for `byte` into `out` (0, 1 or 2 bytes) and returns how many.
  int pass(std::uint8_t byte, std::uint8_t out[2]) {
    if (corrupt == 0 && drop == 0 && twice == 0) return out[0] = byte, 1;
    const double roll = std::uniform_real_distribution<double>(0, 1)(random_);
    if (roll < drop) return 0;
    if (roll < drop + twice) return out[0] = out[1] = byte, 2;
    if (roll < drop + twice + corrupt) byte ^= static_cast<std::uint8_t>(1 + random_() % 255);
    return out[0] = byte, 1;
  }

 private:
  std::mt19937_64 random_;
};
