/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/modules.h"

#include <stddef.h>

#include "modules/application.h"
#include "modules/approach.h"
#include "modules/buttons.h"
#include "modules/coordinates.h"
#include "modules/display.h"
#include "modules/dump.h"
#include "modules/encoders.h"
#include "modules/home.h"
#include "modules/identity.h"
#include "modules/info.h"
#include "modules/inputs.h"
#include "modules/interlock.h"
#include "modules/joystick.h"
#include "modules/led_dimmer.h"
#include "modules/letters.h"
#include "modules/limits.h"
#include "modules/low_level.h"
#include "modules/motion.h"
#include "modules/move.h"
#include "modules/ring_buffer.h"
#include "modules/save_positions.h"
#include "modules/scan.h"
#include "modules/screw.h"
#include "modules/servo_lock.h"
#include "modules/settings.h"
#include "modules/spin.h"
#include "modules/status.h"
#include "modules/ttl_in.h"
#include "modules/ttl_out.h"
#include "modules/ttl_report.h"
#include "modules/tuner.h"
#include "modules/tuning.h"
#include "modules/update.h"
#include "modules/vector.h"
#include "modules/verbose.h"
#include "modules/z_stack.h"

/* Start-up runs `init` in this order, and each turn of the main loop `poll`. */
const struct module *const firmware_modules[] = {
    &inputs_module, /* before what converts coordinates */
    &screw_module,
    &coordinates_module,
    &limits_module,
    &tuning_module,
    &motion_module,
    &encoders_module,
    &interlock_module,
    &approach_module,
    &move_module,
    &home_module,
    &vector_module,
    &spin_module,
    &tuner_module,
    &status_module,
    &ttl_in_module,
    &ttl_out_module,
    &ttl_report_module,
    &servo_lock_module,
    &led_dimmer_module,
    &ring_buffer_module,
    &update_module,
    &z_stack_module,
    &joystick_module,
    &buttons_module,
    &scan_module,
    &letters_module,
    &low_level_module,
    &info_module,
    &identity_module,
    &settings_module,
    &verbose_module,
    &dump_module,
    &display_module,
    &save_positions_module,
    &application_module,
    NULL,
};

/* First come, first asked. */
const struct claim firmware_claims[] = {
    {ACTION_LOCK, servo_lock_toggle}, /* behind CRISP's, when there is one */
    {ACTION_RING_NEXT, ttl_in_trigger},
    {ACTION_AT_SHORT, scan_stop},
    {ACTION_AT_SHORT, ring_buffer_button_next},
    {ACTION_AT_LONG, scan_start},
    {ACTION_JOYSTICK_LONG, ring_buffer_button_store},
    {ACTION_HOME_LONG, ring_buffer_button_clear},
    {ACTION_HOME_SHORT, buttons_home},
    {ACTION_ZERO_SHORT, buttons_zero},
    {ACTION_JOYSTICK_SHORT, joystick_toggle_speed},
    {0},
};
