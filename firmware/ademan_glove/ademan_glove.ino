// SPDX-License-Identifier: MIT OR Apache-2.0
//
// Reads analogue sensors through multiplexers, or an inertial sensor, and sends them over the serial port.

#include <Arduino.h>
#include <stdint.h>

#include "config.h"

#if FORMAT == FORMAT_IMU
#include <Wire.h>
#endif

const uint8_t PIN_COUNT = sizeof(ANALOG_PINS) / sizeof(ANALOG_PINS[0]);
const uint8_t SELECT_COUNT = sizeof(SELECT_PINS) / sizeof(SELECT_PINS[0]);
const uint8_t CHANNEL_COUNT = PIN_COUNT * MUX_INPUTS;
const uint8_t PACKET_CHANNELS = 64;
static_assert(PIN_COUNT * MUX_INPUTS <= PACKET_CHANNELS, "a packet has 64 channels");
static_assert(MUX_INPUTS <= 1 << SELECT_COUNT, "the multiplexers have more inputs than the select pins can name");

// The LED blinks about twice a second while the sketch sends.
const unsigned long BLINK_MS = 250;

static void blink() {
  digitalWrite(LED_PIN, (millis() / BLINK_MS) % 2 ? HIGH : LOW);
}

#if FORMAT != FORMAT_IMU

static uint16_t counts[PACKET_CHANNELS];

// Reads all channels in wire order: input 0 of every multiplexer, then input 1 of every multiplexer, and so on.
static void readChannels() {
  for (uint8_t input = 0; input < MUX_INPUTS; input++) {
    for (uint8_t bit = 0; bit < SELECT_COUNT; bit++) {
      digitalWrite(SELECT_PINS[bit], (input >> bit) & 1 ? HIGH : LOW);
    }
    delayMicroseconds(SETTLE_US);
    for (uint8_t pin = 0; pin < PIN_COUNT; pin++) {
      // The first conversion after a change of the input still has part of the voltage before it.
      (void)analogRead(ANALOG_PINS[pin]);
      counts[input * PIN_COUNT + pin] = analogRead(ANALOG_PINS[pin]);
    }
  }
}

#endif

#if FORMAT == FORMAT_HC11

static void sendReading() {
  readChannels();
  uint8_t packet[2 + PACKET_CHANNELS] = {6, 6};
  for (uint8_t channel = 0; channel < CHANNEL_COUNT; channel++) {
    packet[2 + channel] = (uint8_t)(counts[channel] >> (ADC_BITS - 8));
  }
  // Waits while the line is busy, so that packets follow each other at its rate.
  Serial.write(packet, sizeof(packet));
}

#elif FORMAT == FORMAT_LUCIDGLOVES

constexpr bool isChannel(uint8_t channel) { return channel < PIN_COUNT * MUX_INPUTS; }
static_assert(isChannel(CURL_CHANNELS[0]) && isChannel(CURL_CHANNELS[1]) && isChannel(CURL_CHANNELS[2]) &&
                  isChannel(CURL_CHANNELS[3]) && isChannel(CURL_CHANNELS[4]),
              "CURL_CHANNELS names a channel that no pin measures: add pins to ANALOG_PINS, or inputs with MUX_INPUTS");

static void sendReading() {
  readChannels();
  for (uint8_t finger = 0; finger < 5; finger++) {
    Serial.print((char)('A' + finger));
    Serial.print((unsigned int)counts[CURL_CHANNELS[finger]]);
  }
  Serial.print('\n');
}

#elif FORMAT == FORMAT_IMU

// The BNO055 at its first address: registers of the identity, the mode and the quaternion, and the mode that fuses gyroscope and
// accelerometer without the compass, which motors and steel disturb.
const uint8_t BNO055 = 0x28;
const uint8_t CHIP_ID = 0x00, CHIP_ID_VALUE = 0xa0;
const uint8_t OPERATION_MODE = 0x3d, IMU_MODE = 0x08;
const uint8_t QUATERNION = 0x20;
const float QUATERNION_SCALE = 1.0f / 16384.0f;

static bool readRegisters(uint8_t first, uint8_t* values, uint8_t count) {
  Wire.beginTransmission(BNO055);
  Wire.write(first);
  if (Wire.endTransmission() != 0 || Wire.requestFrom(BNO055, count) != count) {
    return false;
  }
  for (uint8_t index = 0; index < count; index++) {
    values[index] = (uint8_t)Wire.read();
  }
  return true;
}

static void startImu() {
  Wire.begin();
  uint8_t id = 0;
  // It needs 0.65 s after power-up.
  while (!readRegisters(CHIP_ID, &id, 1) || id != CHIP_ID_VALUE) {
    delay(50);
  }
  Wire.beginTransmission(BNO055);
  Wire.write(OPERATION_MODE);
  Wire.write(IMU_MODE);
  Wire.endTransmission();
  delay(20);
}

// Sends w, x, y, z. A reading that fails is left out: the receiver notices silence, not a wrong pose.
static void sendReading() {
  uint8_t bytes[8];
  if (!readRegisters(QUATERNION, bytes, sizeof(bytes))) {
    return;
  }
  for (uint8_t index = 0; index < 4; index++) {
    int16_t number = (int16_t)(bytes[2 * index] | (uint16_t)bytes[2 * index + 1] << 8);
    if (index > 0) {
      Serial.print(',');
    }
    Serial.print(number * QUATERNION_SCALE, 5);
  }
  Serial.print('\n');
}

#else
#error "FORMAT is FORMAT_HC11, FORMAT_LUCIDGLOVES or FORMAT_IMU"
#endif

void setup() {
  Serial.begin(BAUD);
  pinMode(LED_PIN, OUTPUT);
#if FORMAT == FORMAT_IMU
  startImu();
#else
  for (uint8_t bit = 0; bit < SELECT_COUNT; bit++) {
    pinMode(SELECT_PINS[bit], OUTPUT);
  }
#endif
}

void loop() {
#if FORMAT != FORMAT_HC11
  static unsigned long next = 0;
  const unsigned long period = 1000000UL / LINE_RATE_HZ;
  // The difference stays right when the clock starts again after 71 minutes.
  if ((long)(micros() - next) < 0) {
    return;
  }
  next = micros() + period;
#endif
  sendReading();
  blink();
}
