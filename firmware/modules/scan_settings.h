/* SPDX-License-Identifier: BSD-2-Clause */
/** What a scan is made of, as the user sets it: the parameters of SCAN, SCANR and SCANV. */
#ifndef MODULES_SCAN_SETTINGS_H
#define MODULES_SCAN_SETTINGS_H

#include "core/command.h"
#include "modules/scan_run.h"

extern const struct parameter scan_settings_rows[];

/** Numbers of the fast and the slow axis as SCAN R and T have them, 9 for none; and give others. */
int scan_settings_fast(void);
int scan_settings_slow(void);
void scan_settings_set_axes(int fast, int slow);

/** SCAN M: Y and Z without X are roles. */
bool scan_settings_roles_only(void);

/**
 * All settings for a scan with these axes.
 *
 * @return  STATUS_RANGE: not within the original's limits, which are on (SCAN C).
 */
enum status scan_settings_setup(int fast, int slow, struct scan_setup *setup);

#endif
