// SPDX-License-Identifier: MIT OR Apache-2.0
//
// The I2C bus with a BNO055, for a PC.

#pragma once

#include <stddef.h>
#include <stdint.h>

struct TwoWire {
  void begin();
  void end();
  void beginTransmission(uint8_t address);
  size_t write(uint8_t value);
  uint8_t endTransmission();
  uint8_t requestFrom(uint8_t address, uint8_t count);
  int read();
};
extern TwoWire Wire;
