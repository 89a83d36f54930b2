// SPDX-License-Identifier: MIT OR Apache-2.0
//
// Runs the binary of the sketch on a simulated Arduino Nano with four multiplexers, 32 sensors and a BNO055:
//
//     board SKETCH.elf MILLISECONDS [OPTION]...
//
// What the sketch sends goes to the standard output. A line `CHANNEL MILLIVOLTS` on the standard input sets the voltage of a sensor;
// `CHANNEL -1` leaves an input open, which keeps the voltage that the converter had. At the end a JSON object with what the simulator has measured goes to the standard error.
//
//     reset=MS        resets the board at this time, as an adapter does when its port is opened
//     sensor=absent   no BNO055 is wired
//     sensor=stuck    a BNO055 holds SDA low until it got nine pulses on SCL: it was in the middle of a byte when the board was reset
//     power=MS        the BNO055 loses its power for 100 ms each time that this time has passed
//     pace            as fast as a real board
//
// Built with libsimavr 1.6.

#include <poll.h>
#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_twi.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_time.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { MUXES = 4, CHANNELS = 32, VCC_MV = 5000 };
enum { SELECT_PIN = 2, LED_PIN = 5, SDA_PIN = 4, SCL_PIN = 5 };
enum { RAM_START = 0x100, RAM_END = 0x8ff, PAINT = 0xa5, TWCR = 0xbc };

static avr_t* avr;

// What the simulator reports is not what the sketch sends.
static void ignore(avr_t* chip, const int level, const char* format, va_list arguments) {
  (void)chip, (void)level, (void)format, (void)arguments;
}

static void fail(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vfprintf(stderr, format, arguments);
  fputc('\n', stderr);
  exit(1);
}

static double now_us(void) { return avr->cycle * 1e6 / avr->frequency; }

// The serial line.

static long sent = 0;
static double last_sent_us = -1e6, shortest_byte_us = 1e9;

static void on_byte(struct avr_irq_t* irq, uint32_t value, void* parameter) {
  (void)irq, (void)parameter;
  double now = now_us();
  if (now - last_sent_us < shortest_byte_us) shortest_byte_us = now - last_sent_us;
  last_sent_us = now;
  sent++;
  uint8_t byte = value;
  if (write(1, &byte, 1) != 1) exit(0);
}

// The multiplexers. A sensor of 25 kilohms charges a wire of 50 picofarads, and the converter keeps a part of the input before.

static const double SETTLE_TAU_US = 1.25;
static const double KEPT = 1.0 / 16.0;

static double sensors_mv[CHANNELS];
static int selected = 0;
static double select_changed_us = -1e6, shortest_settle_us = 1e9;
static double wires_mv[MUXES];
static double converter_mv = 0;
static int converted_pin = -1;
static long conversions = 0;
static avr_irq_t* adc;

// The voltage of a wire between a multiplexer and the board.
static double wire_mv(int mux) {
  double target = sensors_mv[selected * MUXES + mux];
  if (target < 0) return wires_mv[mux];
  return target + (wires_mv[mux] - target) * exp(-(now_us() - select_changed_us) / SETTLE_TAU_US);
}

static void on_select(struct avr_irq_t* irq, uint32_t value, void* parameter) {
  (void)irq;
  int bit = *(int*)parameter;
  for (int mux = 0; mux < MUXES; mux++) wires_mv[mux] = wire_mv(mux);
  selected = (selected & ~(1 << bit)) | (value & 1) << bit;
  select_changed_us = now_us();
}

static void on_conversion(struct avr_irq_t* irq, uint32_t value, void* parameter) {
  (void)irq, (void)parameter;
  union {
    uint32_t value;
    avr_adc_mux_t mux;
  } conversion = {.value = value};
  int pin = conversion.mux.src;
  if (conversion.mux.kind != ADC_MUX_SINGLE || pin >= MUXES) fail("input %d has no multiplexer", pin);
  double settled_us = now_us() - select_changed_us;
  if (settled_us < shortest_settle_us) shortest_settle_us = settled_us;
  double input = sensors_mv[selected * MUXES + pin] < 0 ? converter_mv : wire_mv(pin);
  converter_mv = pin == converted_pin ? input : input + KEPT * (converter_mv - input);
  converted_pin = pin;
  conversions++;
  avr_raise_irq(adc + ADC_IRQ_ADC0 + pin, (uint32_t)(converter_mv + 0.5));
}

// The LED.

static long led_changes = 0;

static void on_led(struct avr_irq_t* irq, uint32_t value, void* parameter) {
  (void)parameter;
  led_changes += (irq->value & 1) != (value & 1);
}

// The BNO055. It turns by a degree about Z per reading.

enum { BNO055 = 0x28, MODE = 0x3d, QUATERNION = 0x20 };
static bool is_wired = true, is_stuck = false;
static double power_period_us = 1e18, off_us = 1e18;
static const double OFF_US = 100e3;
static uint8_t registers[128];
static uint8_t position = 0;
static int written = 0;
static bool is_addressed = false;
static long readings = 0, starts = 0, scl_pulses = 0;
static avr_irq_t* twi;
static avr_io_write_t write_twcr;
static void* twcr_parameter;

static void power_up(void) {
  memset(registers, 0, sizeof(registers));
  registers[0] = 0xa0;
}

// Has another north afterwards, and no mode.
static void power_up_again(void) {
  power_up();
  readings += 200;
}

static void turn(void) {
  // Without a mode that fuses its sensors it has no quaternion.
  if (registers[MODE] != 0x08) {
    memset(registers + QUATERNION, 0, 8);
    return;
  }
  double half = readings++ * M_PI / 360.0;
  double numbers[4] = {cos(half), 0.0, 0.0, sin(half)};
  for (int index = 0; index < 4; index++) {
    int16_t number = (int16_t)lround(numbers[index] * 16384.0);
    registers[QUATERNION + 2 * index] = number & 0xff;
    registers[QUATERNION + 2 * index + 1] = (number >> 8) & 0xff;
  }
}

static void answer(uint8_t message, uint8_t data) {
  avr_raise_irq(twi + TWI_IRQ_INPUT, avr_twi_irq_msg(message, BNO055 << 1, data));
}

static void on_twi(struct avr_irq_t* irq, uint32_t value, void* parameter) {
  (void)irq, (void)parameter;
  avr_twi_msg_irq_t message = {.u.v = value};
  uint8_t kind = message.u.twi.msg;
  bool has_power = now_us() < off_us;
  if (kind & TWI_COND_STOP) is_addressed = false;
  if (kind & TWI_COND_START) {
    starts++;
    written = 0;
    is_addressed = is_wired && has_power && message.u.twi.addr >> 1 == BNO055;
    if (is_addressed) {
      if (message.u.twi.addr & 1 && position == QUATERNION) turn();
      answer(TWI_COND_ACK, 1);
    }
  }
  if (!is_addressed) return;
  if (kind & TWI_COND_WRITE) {
    answer(TWI_COND_ACK, 1);
    if (written++ == 0) {
      position = message.u.twi.data % sizeof(registers);
    } else {
      registers[position++ % sizeof(registers)] = message.u.twi.data;
    }
  }
  if (kind & TWI_COND_READ) answer(TWI_COND_READ, registers[position++ % sizeof(registers)]);
}

// While SDA is low the converter of the bus never gets the bus: it sets no flag.
static void on_twcr(struct avr_t* chip, avr_io_addr_t address, uint8_t value, void* parameter) {
  (void)parameter;
  if (is_stuck) {
    chip->data[address] = value & 0x7f;
  } else {
    write_twcr(chip, address, value, twcr_parameter);
  }
}

// The line SCL, driven as a pin: low as an output, high as an input.
static void on_scl(struct avr_irq_t* irq, uint32_t value, void* parameter) {
  (void)parameter;
  if (!is_stuck || !(irq->value >> SCL_PIN & 1) || value >> SCL_PIN & 1) return;
  if (++scl_pulses == 9) is_stuck = false;
}

// The board.

static double reset_us = -1;
static long sent_before_reset = 0;

static void load(const char* path, long* free_from) {
  static elf_firmware_t firmware;
  avr_global_logger_set(ignore);
  if (elf_read_firmware(path, &firmware) != 0) fail("cannot read %s", path);
  strcpy(firmware.mmcu, "atmega328p");
  firmware.frequency = 16000000;
  firmware.vcc = firmware.avcc = firmware.aref = VCC_MV;
  avr = avr_make_mcu_by_name(firmware.mmcu);
  if (avr == NULL) fail("no such chip: %s", firmware.mmcu);
  avr_init(avr);
  avr_load_firmware(avr, &firmware);
  *free_from = RAM_START + firmware.datasize + firmware.bsssize;
  memset(avr->data + RAM_START, PAINT, RAM_END + 1 - RAM_START);
}

static void wire(void) {
  static int bits[3] = {0, 1, 2};
  for (int bit = 0; bit < 3; bit++) {
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), SELECT_PIN + bit), on_select, &bits[bit]);
  }
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('B'), LED_PIN), on_led, NULL);
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_byte, NULL);
  uint32_t flags = 0;
  avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  adc = avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, 0);
  avr_irq_register_notify(adc + ADC_IRQ_OUT_TRIGGER, on_conversion, NULL);
  twi = avr_io_getirq(avr, AVR_IOCTL_TWI_GETIRQ(0), 0);
  avr_irq_register_notify(twi + TWI_IRQ_OUTPUT, on_twi, NULL);
  avr_irq_t* direction = avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('C'), IOPORT_IRQ_DIRECTION_ALL);
  avr_irq_register_notify(direction, on_scl, NULL);
  avr_io_addr_t control = AVR_DATA_TO_IO(TWCR);
  write_twcr = avr->io[control].w.c;
  twcr_parameter = avr->io[control].w.param;
  avr->io[control].w.c = on_twcr;
}

static void read_voltages(void) {
  static char text[4096];
  static size_t length = 0;
  static bool is_open = true;
  struct pollfd input = {.fd = 0, .events = POLLIN};
  while (is_open && poll(&input, 1, 0) > 0) {
    ssize_t count = read(0, text + length, sizeof(text) - 1 - length);
    is_open = count > 0;
    length += is_open ? count : 0;
    char* line = text;
    for (char* end; (end = memchr(line, '\n', text + length - line)) != NULL; line = end + 1) {
      *end = 0;
      int channel;
      double millivolts;
      if (sscanf(line, "%d %lf", &channel, &millivolts) != 2 || channel < 0 || channel >= CHANNELS) fail("no voltage: %s", line);
      sensors_mv[channel] = millivolts;
    }
    length -= line - text;
    memmove(text, line, length);
  }
}

static double wall_us(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * 1e6 + time.tv_nsec / 1e3;
}

static void run(double end_us, bool is_paced) {
  double start = wall_us(), slice_us = 0;
  while (now_us() < end_us) {
    int state = avr_run(avr);
    if (state == cpu_Done || state == cpu_Crashed) fail("the program has ended at %.0f us", now_us());
    if (reset_us >= 0 && now_us() >= reset_us) {
      reset_us = -1;
      sent_before_reset = sent;
      avr_reset(avr);
    }
    if (now_us() >= off_us + OFF_US) {
      off_us += power_period_us;
      power_up_again();
    }
    if (now_us() < slice_us) continue;
    slice_us = now_us() + 1000;
    read_voltages();
    double ahead = now_us() - (wall_us() - start);
    if (is_paced && ahead > 0) usleep((useconds_t)ahead);
  }
}

int main(int count, char** arguments) {
  if (count < 3) fail("board SKETCH.elf MILLISECONDS [OPTION]...");
  bool is_paced = false;
  for (int index = 3; index < count; index++) {
    const char* option = arguments[index];
    if (strncmp(option, "reset=", 6) == 0) {
      reset_us = 1000 * atof(option + 6);
    } else if (strncmp(option, "power=", 6) == 0) {
      power_period_us = off_us = 1000 * atof(option + 6);
    } else if (strcmp(option, "sensor=absent") == 0) {
      is_wired = false;
    } else if (strcmp(option, "sensor=stuck") == 0) {
      is_stuck = true;
    } else if (strcmp(option, "pace") == 0) {
      is_paced = true;
    } else {
      fail("no such option: %s", option);
    }
  }
  // Channel c has the count 4 c + 3 of 10 bits.
  for (int channel = 0; channel < CHANNELS; channel++) sensors_mv[channel] = ceil((4 * channel + 3) * VCC_MV / 1023.0);
  power_up();
  long free_from;
  load(arguments[1], &free_from);
  wire();
  run(1000 * atof(arguments[2]), is_paced);
  long unused = free_from;
  while (unused <= RAM_END && avr->data[unused] == PAINT) unused++;
  fprintf(stderr,
          "{\"sent\":%ld,\"sent_before_reset\":%ld,\"shortest_byte_us\":%.2f,\"shortest_settle_us\":%.2f,\"conversions\":%ld,"
          "\"led_changes\":%ld,\"free_bytes\":%ld,\"bus_starts\":%ld}\n",
          sent, sent_before_reset, shortest_byte_us, shortest_settle_us, conversions, led_changes, unused - free_from, starts);
}
