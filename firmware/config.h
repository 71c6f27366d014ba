/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * What this build of the firmware is: the axes fitted and the names it gives itself.
 * Every value can be overridden on the compiler's command line (-DAXIS_COUNT=3).
 */
#ifndef CONFIG_H
#define CONFIG_H

/** Axes fitted, 1 to 4: the first so many of AXIS_LETTERS. Axis n is hardware channel n. */
#ifndef AXIS_COUNT
#define AXIS_COUNT 4
#endif

/** Letters of the hardware channels, in hardware order. */
#define AXIS_LETTERS "XYZF"

#if AXIS_COUNT < 1 || AXIS_COUNT > 4
#error "AXIS_COUNT must be 1 to 4"
#endif

/** Printed by BUILD X: revision of the board. */
#ifndef HARDWARE_REVISION
#define HARDWARE_REVISION "A"
#endif

/** Our own version, from the repository (`git describe`), as text. */
#ifndef ABBE_VERSION
#define ABBE_VERSION "0.0.0"
#endif

/** Level of the original's command language that is implemented, as `V T` prints it. */
#define LANGUAGE_LEVEL "9.55"

/** Date of the build as CDATE prints it, "Mmm DD YYYY:HH:MM:SS"; the build passes the commit's date. */
#ifndef ABBE_DATE
#define ABBE_DATE "Jan 01 2026:00:00:00"
#endif

#endif
