// Arduino Due: the pins of the board's core. All that decides is in ../../core; copy that folder to src/core here
// (the Arduino builder compiles src/ only).
//
//   part                      wire                Due
//   servo signal              yellow / white      D9        (servo power from its own 6 V supply, grounds joined)
//   servo position, optional  potentiometer tap   A0        (0 to 3.3 V only; see kFeedback)
//   servo current, optional   INA169 output       A1        (1 V per A; see kCurrent)
//   HX711 DOUT                                    D3
//   HX711 PD_SCK                                  D2
//   HX711 VCC                                     3.3 V     (the Due's pins do not stand 5 V)
//   HX711 RATE                to VCC              80 Hz nominal, 93.5 Hz measured
//   sync LED + 330 ohm                            D13       (in the camera's picture)
//   computer                  USB                 programming port (the native port loses bytes)

#include <Servo.h>

#include "src/core/board.hpp"

namespace {

constexpr int kServoPin = 9, kClockPin = 2, kDataPin = 3, kLedPin = 13, kAnglePin = A0, kCurrentPin = A1;
constexpr bool kFeedback = false;  // true where a potentiometer tap is wired to A0
constexpr bool kCurrent = false;   // true where a current sensor is wired to A1
constexpr float kUradPerCount = 767.0f, kCentreCount = 2048.0f;  // 12-bit; calibrate for the servo at hand
constexpr float kMilliampPerCount = 0.806f;

class Due final : public rig::Hardware {
 public:
  void begin() {
    Serial.begin(115200);
    analogReadResolution(12);
    pinMode(kClockPin, OUTPUT);
    digitalWrite(kClockPin, LOW);
    pinMode(kDataPin, INPUT);
    pinMode(kLedPin, OUTPUT);
    pmc_enable_periph_clk(ID_TRNG);
    trng_enable(TRNG);
    delay(1);
    boot_ = trng_read_output_data(TRNG);
  }

  uint32_t micros() override { return ::micros(); }
  uint32_t boot_id() override { return boot_; }
  int read_byte() override { return Serial.read(); }
  size_t write_bytes(const uint8_t* data, size_t size) override {
    const int room = Serial.availableForWrite();
    const size_t taken = room < 0 ? 0 : (size < static_cast<size_t>(room) ? size : static_cast<size_t>(room));
    return Serial.write(data, taken);
  }

  void servo_pulse(uint16_t microseconds) override {
    if (!attached_) {  // the first pulse is already the right one
      servo_.writeMicroseconds(microseconds);
      servo_.attach(kServoPin, rig::kHardPulseMin, rig::kHardPulseMax);
      attached_ = true;
    }
    servo_.writeMicroseconds(microseconds);
  }
  void servo_off() override {
    if (attached_) servo_.detach();
    attached_ = false;
  }
  bool servo_angle(int32_t& microradians) override {
    if (!kFeedback) return false;
    microradians = static_cast<int32_t>((analogRead(kAnglePin) - kCentreCount) * kUradPerCount);
    return true;
  }
  uint16_t servo_current_ma() override {
    return kCurrent ? static_cast<uint16_t>(analogRead(kCurrentPin) * kMilliampPerCount) : 0;
  }

  bool cell_data() override { return digitalRead(kDataPin) == HIGH; }
  void cell_clock(bool high) override {
    digitalWrite(kClockPin, high ? HIGH : LOW);  // about 1 us on a Due: longer than the 0.2 us that the HX711 wants
  }
  void interrupts(bool enabled) override {
    if (enabled)
      __enable_irq();
    else
      __disable_irq();
  }
  void led(bool on) override { digitalWrite(kLedPin, on ? HIGH : LOW); }

 private:
  Servo servo_;
  bool attached_ = false;
  uint32_t boot_ = 0;
};

Due due;
rig::Board board(due);

}  // namespace

void setup() { due.begin(); }

void loop() { board.step(); }
