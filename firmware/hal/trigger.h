/* SPDX-License-Identifier: BSD-2-Clause */
/** Records of the trigger: where all axes were as a pulse began. docs/blocks/trigger.md. */
#ifndef HAL_TRIGGER_H
#define HAL_TRIGGER_H

#include <stdbool.h>
#include <stdint.h>

enum { TRIGGER_AXES = 4, TRIGGER_QUEUE = 1024 };

enum trigger_source { TRIGGER_IN0, TRIGGER_OUT0 };

struct trigger_record {
    uint64_t time_fast; /* clocks of 5 ns since reset */
    int32_t position_counts[TRIGGER_AXES];
};

/** From now on, within 0.3 us, pulses of at least `minimum_fast` clocks (18 to 255) make records. */
void trigger_enable(enum trigger_source source, bool falling, unsigned minimum_fast);

/** No more records: returns when the last pulse that had begun has made its own. Takes 2 us. */
void trigger_disable(void);

/** Take the oldest record. False: none waits. */
bool trigger_take(struct trigger_record *record);

/** Forget what waits. */
void trigger_clear(void);

/** Records lost since reset because TRIGGER_QUEUE waited. Stays at UINT32_MAX. */
uint32_t trigger_missed(void);

/** Interrupt while a record waits. */
void trigger_interrupt(bool enable);

#endif
