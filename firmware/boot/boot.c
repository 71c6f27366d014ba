/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The boot program: starts the application if there is one and the gateware is the one it knows.
 *
 * It lives in a memory of its own that the application cannot write, uses nothing of the
 * application's, and keeps no data.
 */
#include <stdint.h>

#include "regs.h"

/** First instruction of the application, at the start of RAM. */
extern void application_start(void);

void boot_main(void);

static void say(const char *text)
{
    while (*text != '\0') {
        if (serial_status_tx_ready_get() != 0)
            serial_data_write((uint8_t)*text++);
    }
}

void boot_main(void)
{
    if (identity_magic_read() != REG_MAGIC || identity_map_version_read() != REG_MAP_VERSION)
        say("Abbe boot: unknown gateware\r\n");
    else if (*(volatile const uint32_t *)(uintptr_t)application_start == 0)
        say("Abbe boot: no application\r\n");
    else
        application_start();
    for (;;)
        __asm__ volatile("wfi");
}
