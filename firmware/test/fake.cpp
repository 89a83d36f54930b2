// SPDX-License-Identifier: MIT OR Apache-2.0
//
// Runs the sketch on a PC: `fake PASSES` calls loop() that often. A call takes 100 us of simulated time, and the line its 10 bits per
// byte. Each sensor has a voltage of its own.

#include "../ademan_glove/ademan_glove.ino"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static uint64_t now_us = 0;
static uint8_t levels[64];
static uint8_t modes[64];
static unsigned long baud = 0;

[[noreturn]] static void fail(const char* reason) {
  fprintf(stderr, "%s\n", reason);
  exit(1);
}

void pinMode(uint8_t pin, uint8_t mode) { modes[pin] = mode; }

void digitalWrite(uint8_t pin, uint8_t value) {
  if (modes[pin] != OUTPUT) fail("a pin is written that is no output");
  levels[pin] = value;
}

// Channel 8 k + p of 8 pins has the count 4 (8 k + p) + 3 of 10 bits. After a change of the multiplexers the first conversion is wrong.
int analogRead(uint8_t pin) {
  static int previous = -1;
  int input = 0;
  for (uint8_t bit = 0; bit < SELECT_COUNT; bit++) input |= levels[SELECT_PINS[bit]] << bit;
  int index = 0;
  while (index < PIN_COUNT && ANALOG_PINS[index] != pin) index++;
  if (index == PIN_COUNT) fail("a pin is read that has no sensor");
  now_us += 100;
  int channel = input * PIN_COUNT + index;
  int count = ((channel * 4 + 3) << ADC_BITS) >> 10;
  bool is_settled = previous == channel;
  previous = channel;
  return is_settled ? count : 0;
}

unsigned long millis() { return now_us / 1000; }
unsigned long micros() { return (uint32_t)now_us; }
void delay(unsigned long ms) { now_us += 1000 * ms; }
void delayMicroseconds(unsigned int us) { now_us += us; }

void SerialPort::begin(unsigned long rate) { baud = rate; }

size_t SerialPort::write(const uint8_t* bytes, size_t count) {
  if (baud != 115200) fail("the port has another rate");
  now_us += count * 10 * 1000000 / baud;
  for (size_t sent = 0; sent < count;) {
    ssize_t part = ::write(1, bytes + sent, count - sent);
    if (part <= 0) exit(0);
    sent += part;
  }
  return count;
}

size_t SerialPort::print(char character) { return write((const uint8_t*)&character, 1); }

size_t SerialPort::print(const char* text) { return write((const uint8_t*)text, strlen(text)); }

size_t SerialPort::print(unsigned int number) {
  char text[16];
  return write((const uint8_t*)text, snprintf(text, sizeof(text), "%u", number));
}

size_t SerialPort::print(double number, int digits) {
  char text[32];
  return write((const uint8_t*)text, snprintf(text, sizeof(text), "%.*f", digits, number));
}

SerialPort Serial;

#if FORMAT == FORMAT_IMU

static uint8_t registers[128] = {0xa0};
static uint8_t position = 0;
static uint8_t written = 0;
static int requests = 0;

void TwoWire::begin() {}
void TwoWire::end() {}

void TwoWire::beginTransmission(uint8_t address) {
  if (address != 0x28) fail("no device has this address");
  written = 0;
}

size_t TwoWire::write(uint8_t value) {
  if (written++ == 0) {
    position = value;
  } else {
    registers[position++] = value;
  }
  return 1;
}

uint8_t TwoWire::endTransmission() { return 0; }

// The sensor turns by a degree about Z per request, and every tenth request fails.
uint8_t TwoWire::requestFrom(uint8_t, uint8_t count) {
  if (count != 8) return count;
  if (registers[0x3d] != 0x08) fail("the sensor is not in the mode IMU");
  if (requests++ % 10 == 9) return 0;
  double half = requests * 3.14159265358979 / 360.0;
  double numbers[4] = {__builtin_cos(half), 0.0, 0.0, __builtin_sin(half)};
  for (int index = 0; index < 4; index++) {
    int16_t number = (int16_t)__builtin_lround(numbers[index] * 16384.0);
    registers[0x20 + 2 * index] = number & 0xff;
    registers[0x21 + 2 * index] = (number >> 8) & 0xff;
  }
  return count;
}

int TwoWire::read() { return registers[position++]; }

TwoWire Wire;

#endif

int main(int argc, char** argv) {
  long passes = argc > 1 ? atol(argv[1]) : 100;
  setup();
  for (long pass = 0; pass < passes; pass++) {
    loop();
    now_us += 100;
  }
}
