/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/classifier.h"

#include "regs.h"

_Static_assert(CLASSIFIER_FILTER_MAX_FAST ==
                   REG_CLASSIFIER_CONFIG_FILTER_MASK >> REG_CLASSIFIER_CONFIG_FILTER_SHIFT,
               "width of the filter's setting");

static bool started;

void classifier_configure(const struct classifier_settings *settings)
{
    classifier_threshold_write(settings->threshold_fast);
    classifier_config_write(
        (started ? REG_CLASSIFIER_CONFIG_ENABLE_MASK : 0u) |
        (settings->at_threshold ? REG_CLASSIFIER_CONFIG_AT_THRESHOLD_MASK : 0u) |
        settings->filter_fast << REG_CLASSIFIER_CONFIG_FILTER_SHIFT);
}

void classifier_start(const struct classifier_settings *settings)
{
    classifier_control_write(REG_CLASSIFIER_CONTROL_CLEAR_MASK);
    started = true;
    classifier_configure(settings);
}

void classifier_stop(void)
{
    started = false;
    classifier_config_write(classifier_config_read() & ~REG_CLASSIFIER_CONFIG_ENABLE_MASK);
}

uint32_t classifier_waiting(void)
{
    return classifier_status_read();
}

uint32_t classifier_lost(void)
{
    return classifier_lost_read();
}

uint32_t classifier_take(void)
{
    return classifier_decisions_read();
}
