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
const uint8_t PACKET_CHANNELS = 64;
static_assert(PIN_COUNT * MUX_INPUTS <= PACKET_CHANNELS, "a packet has 64 channels");
static_assert(MUX_INPUTS <= 1 << SELECT_COUNT, "the multiplexers have more inputs than the select pins can name");

// The LED blinks twice a second while the sketch sends, and is dark otherwise.
const unsigned long BLINK_MS = 250;

static void blink() {
  digitalWrite(LED_PIN, (millis() / BLINK_MS) % 2 ? HIGH : LOW);
}

#if FORMAT != FORMAT_IMU

// Connects an input of every multiplexer to its pin.
static void selectInput(uint8_t input) {
  for (uint8_t bit = 0; bit < SELECT_COUNT; bit++) {
    digitalWrite(SELECT_PINS[bit], (input >> bit) & 1 ? HIGH : LOW);
  }
  delayMicroseconds(SETTLE_US);
}

static uint16_t readPin(uint8_t pin) {
  // The first conversion after a change of the input still has part of the voltage before it.
  (void)analogRead(ANALOG_PINS[pin]);
  return (uint16_t)analogRead(ANALOG_PINS[pin]);
}

#endif

#if FORMAT == FORMAT_HC11

// Sends all channels in wire order: input 0 of every multiplexer, then input 1 of every multiplexer, and so on.
static bool sendReading() {
  uint8_t packet[2 + PACKET_CHANNELS] = {6, 6};
  for (uint8_t input = 0; input < MUX_INPUTS; input++) {
    selectInput(input);
    for (uint8_t pin = 0; pin < PIN_COUNT; pin++) {
      packet[2 + input * PIN_COUNT + pin] = (uint8_t)(readPin(pin) >> (ADC_BITS - 8));
    }
  }
  // Waits while the line is busy, so that packets follow each other at its rate.
  Serial.write(packet, sizeof(packet));
  return true;
}

#elif FORMAT == FORMAT_LUCIDGLOVES

constexpr bool isChannel(uint8_t channel) { return channel < PIN_COUNT * MUX_INPUTS; }
static_assert(isChannel(CURL_CHANNELS[0]) && isChannel(CURL_CHANNELS[1]) && isChannel(CURL_CHANNELS[2]) &&
                  isChannel(CURL_CHANNELS[3]) && isChannel(CURL_CHANNELS[4]),
              "CURL_CHANNELS names a channel that no pin measures: add pins to ANALOG_PINS, or inputs with MUX_INPUTS");

static bool sendReading() {
  for (uint8_t finger = 0; finger < 5; finger++) {
    selectInput(CURL_CHANNELS[finger] / PIN_COUNT);
    Serial.print((char)('A' + finger));
    Serial.print((unsigned int)readPin(CURL_CHANNELS[finger] % PIN_COUNT));
  }
  Serial.print('\n');
  return true;
}

#elif FORMAT == FORMAT_IMU

// Registers of the BNO055: its identity, its mode and the quaternion, and the mode that fuses gyroscope and accelerometer without the
// compass, which motors and steel disturb.
const uint8_t CHIP_ID = 0x00, CHIP_ID_VALUE = 0xa0;
const uint8_t OPERATION_MODE = 0x3d, MODE_MASK = 0x0f, IMU_MODE = 0x08;
const uint8_t QUATERNION = 0x20;
const float QUATERNION_SCALE = 1.0f / 16384.0f;
const unsigned long RETRY_MS = 50;

static bool readRegisters(uint8_t first, uint8_t* values, uint8_t count) {
  Wire.beginTransmission(IMU_ADDRESS);
  Wire.write(first);
  if (Wire.endTransmission() != 0 || Wire.requestFrom(IMU_ADDRESS, count) != count) {
    return false;
  }
  for (uint8_t index = 0; index < count; index++) {
    values[index] = (uint8_t)Wire.read();
  }
  return true;
}

// Starts the bus. A sensor that lost its clock within a byte, as by a reset of the board, holds SDA low until it gets the pulses
// that are missing.
static void startBus() {
  Wire.end();
  for (uint8_t pulse = 0; pulse < 9; pulse++) {
    pinMode(SCL, OUTPUT);
    digitalWrite(SCL, LOW);
    delayMicroseconds(5);
    pinMode(SCL, INPUT);
    delayMicroseconds(5);
  }
  Wire.begin();
#if defined(ARDUINO_ARCH_AVR)
  // By default it waits for a disturbed bus without end. The library of the ESP32 has a limit of its own.
  Wire.setWireTimeout(25000, true);
#endif
}

// Returns `true` if the sensor is in its mode. It needs 0.65 s after power-up.
static bool startImu() {
  uint8_t id = 0, mode = 0;
  if (!readRegisters(CHIP_ID, &id, 1) || id != CHIP_ID_VALUE || !readRegisters(OPERATION_MODE, &mode, 1)) {
    return false;
  }
  if ((mode & MODE_MASK) == IMU_MODE) {
    return true;
  }
  Wire.beginTransmission(IMU_ADDRESS);
  Wire.write(OPERATION_MODE);
  Wire.write(IMU_MODE);
  if (Wire.endTransmission() != 0) {
    return false;
  }
  delay(20);
  // The receiver takes a new neutral pose: the sensor has another north now.
  Serial.print("BNO055 started\n");
  return true;
}

// Sends w, x, y, z. A reading that fails is left out: the receiver notices silence, not a wrong pose.
static bool sendReading() {
  static bool isStarted = false;
  uint8_t bytes[8];
  if (!isStarted) {
    isStarted = startImu();
  }
  if (!isStarted) {
    delay(RETRY_MS);
    startBus();
    return false;
  }
  if (!readRegisters(QUATERNION, bytes, sizeof(bytes))) {
    isStarted = false;
    return false;
  }
  int16_t numbers[4];
  bool isZero = true;
  for (uint8_t index = 0; index < 4; index++) {
    numbers[index] = (int16_t)(bytes[2 * index] | (uint16_t)bytes[2 * index + 1] << 8);
    isZero = isZero && numbers[index] == 0;
  }
  if (isZero) {
    // It has lost its power and its mode, or has no result yet.
    isStarted = false;
    return false;
  }
  for (uint8_t index = 0; index < 4; index++) {
    if (index > 0) {
      Serial.print(',');
    }
    Serial.print(numbers[index] * QUATERNION_SCALE, 5);
  }
  Serial.print('\n');
  return true;
}

#else
#error "FORMAT is FORMAT_HC11, FORMAT_LUCIDGLOVES or FORMAT_IMU"
#endif

void setup() {
  Serial.begin(BAUD);
  pinMode(LED_PIN, OUTPUT);
#if FORMAT == FORMAT_IMU
  startBus();
#else
  for (uint8_t bit = 0; bit < SELECT_COUNT; bit++) {
    pinMode(SELECT_PINS[bit], OUTPUT);
  }
#endif
#if FORMAT == FORMAT_HC11 && defined(ADCSRA)
  // An AVR converts four times as fast, at 500 kHz, where it is exact to 8 bits: all channels are read while a packet is sent.
  ADCSRA &= (uint8_t)~_BV(ADPS1);
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
  if (sendReading()) {
    blink();
  } else {
    digitalWrite(LED_PIN, LOW);
  }
}
