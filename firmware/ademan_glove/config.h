// SPDX-License-Identifier: MIT OR Apache-2.0
//
// The settings of the sketch. docs/firmware.md has the wiring.

#pragma once

// What is sent. HC11: packets of 64 counts after two bytes 06, for gloves with a calibrated glove file. LUCIDGLOVES: lines with
// the curls of five fingers. IMU: lines with the quaternion of a BNO055.
#define FORMAT_HC11 1
#define FORMAT_LUCIDGLOVES 2
#define FORMAT_IMU 3
#ifndef FORMAT
#define FORMAT FORMAT_HC11
#endif

const unsigned long BAUD = 115200;

#if defined(ESP32)
// Inputs of the first converter: the second one does not work beside Wi-Fi. An S2, S3 or C3 has them at other pins.
const uint8_t ANALOG_PINS[] = {32, 33, 34, 35, 36, 39};
const uint8_t SELECT_PINS[] = {25, 26, 27};
const uint8_t LED_PIN = 2;
const uint8_t ADC_BITS = 12;
#else
const uint8_t ANALOG_PINS[] = {A0, A1, A2, A3};
const uint8_t SELECT_PINS[] = {2, 3, 4};
const uint8_t LED_PIN = LED_BUILTIN;
const uint8_t ADC_BITS = 10;
#endif

// Inputs of each multiplexer: 8 of a 74HC4051, 16 of a CD74HC4067 with a fourth select pin, or 1 for sensors on the pins themselves.
#ifndef MUX_INPUTS
#define MUX_INPUTS 8
#endif

// Time for the voltage to settle after a change of the multiplexers, in microseconds.
const unsigned int SETTLE_US = 10;

// The channels of thumb, index, middle, ring and little finger for LUCIDGLOVES.
constexpr uint8_t CURL_CHANNELS[5] = {0, 1, 2, 3, 4};

// Address of the BNO055: 0x28, or 0x29 with its pin ADR at 3.3 V.
const uint8_t IMU_ADDRESS = 0x28;

// Lines per second of LUCIDGLOVES and IMU.
const unsigned long LINE_RATE_HZ = 100;
