// Fuzz: what comes over the line may be anything at all.
#pragma once
#include <memory>
#include <random>

#include "bench.hpp"

// Random bytes, and valid frames with bytes changed, lost and doubled. The bench's servo pin does the checking.
inline void fuzz(long frames, bool mutated, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Bench bench;
  auto board = std::make_unique<rig::Board>(bench);
  bench.run(*board, 0.001);
  const auto below = [&](std::uint64_t bound) { return random() % bound; };
  const auto point_index = [&] {
    const std::uint64_t dice = below(8);
    return static_cast<std::uint32_t>(dice == 0 ? random() : dice < 4 ? below(2100) : below(4) * 24);
  };
  for (long i = 0; i < frames; ++i) {
    if (!mutated) {
      if (i % 256 == 0) {  // noise must find an armed board in a run, too
        bench.send(Type::kLimits, static_cast<std::uint8_t>(i / 256), limits());
        bench.send(Type::kClear, static_cast<std::uint8_t>(i / 256), {});
        for (std::uint32_t k = 0; k < 96; k += 24) bench.send(Type::kPoints, 0, points(k, 24, k % 48 == 0 ? 700000 : -700000));
        bench.send(Type::kStart, static_cast<std::uint8_t>(i / 256), body<std::uint64_t, std::uint32_t, std::uint32_t>(bench.now_us + 50000, 20000, 96));
      }
      if (i % 16 == 0) bench.send(Type::kPing, 0, body<std::uint32_t>(7));
      const std::size_t size = 1 + below(140);
      for (std::size_t k = 0; k < size; ++k) bench.in.push_back(static_cast<std::uint8_t>(random()));
      bench.in.push_back(0);
    } else {
      static constexpr Type kTypes[] = {Type::kHello, Type::kPing,    Type::kLimits, Type::kStream, Type::kPoints, Type::kStart,
                                        Type::kNeutral, Type::kFlash, Type::kResend, Type::kClear,  Type::kPoints, Type::kPing};
      const Type type = kTypes[below(12)];
      std::vector<std::uint8_t> contents;
      if (type == Type::kLimits)
        contents = limits(static_cast<std::int32_t>(random()) % 1700000, static_cast<std::uint32_t>(below(25000000)));
      else if (type == Type::kPoints)
        contents = points(point_index(), static_cast<std::uint8_t>(below(27)), static_cast<std::int32_t>(random()) % 900000);
      else if (type == Type::kStart)
        contents = body<std::uint64_t, std::uint32_t, std::uint32_t>(bench.now_us + below(100000), static_cast<std::uint32_t>(below(40000)), static_cast<std::uint32_t>(below(200)));
      else
        for (std::size_t k = below(8); k > 0; --k) contents.push_back(static_cast<std::uint8_t>(random()));
      // Half stay whole at the level of bytes (their contents are odd enough), half are damaged on the way.
      const std::size_t before = bench.in.size();
      bench.send(type, static_cast<std::uint8_t>(random()), contents);
      if (below(2) == 0) {
        const std::size_t at = before + below(bench.in.size() - before);
        const auto place = bench.in.begin() + static_cast<std::ptrdiff_t>(at);
        switch (below(3)) {
          case 0: *place = static_cast<std::uint8_t>(random()); break;
          case 1: bench.in.erase(place); break;
          default: bench.in.insert(place, *place); break;
        }
      }
    }
    if (below(3) == 0) bench.convert(static_cast<std::uint32_t>(random()));
    bench.run(*board, 0.004, 2000);
    if (bench.out.size() > 4096) bench.out.clear();
  }
  CHECK(frames < 1000 || bench.moves > 0);  // a board that never moved would prove nothing
  std::printf("%ld %s frames: %ld pulses, %ld of them moved the servo, none beyond a limit\n", frames, mutated ? "mutated" : "random", bench.pulses, bench.moves);
}
