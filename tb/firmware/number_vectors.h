/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Deterministic numbers to convert, the same on the host and on the target, and a digest over what
 * our conversions make of them: equal digests, equal bytes. Integer arithmetic only.
 */
#ifndef TB_FIRMWARE_NUMBER_VECTORS_H
#define TB_FIRMWARE_NUMBER_VECTORS_H

#include <stddef.h>
#include <stdint.h>

#define NUMBER_SEED UINT64_C(0x41626265)

/** Vectors run on the target, in simulation. */
enum { NUMBER_TARGET_COUNT = 150 };

/** Next value: a mix of all magnitudes, of settings-like ones and of exact decimal ties. */
double number_vector(uint64_t *state, unsigned *decimals);

/** Next random numeral, at most 80 characters and a zero byte. */
void number_vector_text(uint64_t *state, char *text);

/** For `count` vectors: a formatted value, `length` characters, and what a numeral is read as. */
void number_each(uint32_t count, void (*take)(const char *text, size_t length, double read));

/** 32-bit FNV-1a over `count` formatted values and as many parsed numerals. */
uint32_t number_digest(uint32_t count);

#endif
