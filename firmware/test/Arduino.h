// SPDX-License-Identifier: MIT OR Apache-2.0
//
// The part of the Arduino library that the sketch uses, for a PC. What the sketch sends goes to the standard output; sensors and
// time are simulated by fake.cpp.

#pragma once

#include <stddef.h>
#include <stdint.h>

enum { LOW = 0, HIGH = 1 };
enum { INPUT = 0, OUTPUT = 1 };
enum { A0 = 14, A1, A2, A3, A4, A5, A6, A7 };
const uint8_t LED_BUILTIN = 13, SDA = 18, SCL = 19;

void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t value);
int analogRead(uint8_t pin);
unsigned long millis();
unsigned long micros();
void delay(unsigned long ms);
void delayMicroseconds(unsigned int us);

struct SerialPort {
  void begin(unsigned long baud);
  size_t write(const uint8_t* bytes, size_t count);
  size_t print(char character);
  size_t print(const char* text);
  size_t print(unsigned int number);
  size_t print(double number, int digits);
};
extern SerialPort Serial;
