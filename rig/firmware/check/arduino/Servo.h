// What the Due sketch asks of Arduino's own headers, declared and no more: so a compiler can check the sketch without them.
#pragma once
#include <cstddef>
#include <cstdint>

using std::size_t;
using std::uint16_t;
using std::uint32_t;
using std::uint8_t;

constexpr uint8_t A0 = 54, A1 = 55;
constexpr uint32_t LOW = 0, HIGH = 1, INPUT = 0, OUTPUT = 1;

void pinMode(uint32_t pin, uint32_t mode);
void digitalWrite(uint32_t pin, uint32_t value);
int digitalRead(uint32_t pin);
uint32_t analogRead(uint32_t pin);
void analogReadResolution(int bits);
void delay(uint32_t milliseconds);
uint32_t micros();

struct SerialPort {
  void begin(uint32_t baud);
  int read();
  int availableForWrite();
  size_t write(const uint8_t* data, size_t size);
};
extern SerialPort Serial;

class Servo {
 public:
  uint8_t attach(int pin, int shortest_us, int longest_us);
  void writeMicroseconds(int microseconds);
};

struct Trng;
extern Trng* const TRNG;
constexpr uint32_t ID_TRNG = 41;
uint32_t pmc_enable_periph_clk(uint32_t peripheral);
void trng_enable(Trng* generator);
uint32_t trng_read_output_data(Trng* generator);

void __enable_irq();
void __disable_irq();
